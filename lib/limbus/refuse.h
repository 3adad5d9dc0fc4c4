/* refuse: why a photograph's limbus is not believed, in words that say what to photograph better. Internal to limbus_find.
 */
#ifndef LIMBUS_REFUSE_H
#define LIMBUS_REFUSE_H
#include "limbus/trial.h"

/* Sets the reason; returns found->ok, false. */
__attribute__((format(printf, 2, 3)))
bool limbus_refuse(struct limbus_found *found, const char *fmt, ...);

/* Refuses an ellipse, the likeliest of the trials (found->posterior), that the frame cuts, or whose chance of being off is above conf->max_gross. */
void limbus_refuse_doubtful(struct limbus_found *found, const struct trials *trials);

#endif
