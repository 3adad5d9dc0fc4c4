/* advice: what went wrong with the photographs, in words of photography.
 */
#ifndef SFM_ADVICE_H
#define SFM_ADVICE_H
#include "sfm/views.h"

/* Sets err to the reason why no two pictures could be put together, and to what to photograph instead. Always false. */
bool advice_refuse(const struct views *views, struct stage *stage, struct err *err);

/* flat: the matches of nearly all pairs are explained by a homography: pictures of a plane, or from one place. Cameras estimated
 * from those mean nothing. Returns false, err set, when the database cannot be read. */
bool advice_is_flat(bool *flat, struct stage *stage, struct err *err);

/* Records, a line each, which photographs are not registered in the model, and why. */
void advice_warn(const struct colmap_model *model, const struct views *views, struct stage *stage);

#endif
