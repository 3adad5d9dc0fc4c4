/* limbus_scale: the scale from the eye itself: the visible iris has much the same width in all adults.
 */
#ifndef SFM_HEAD_LIMBUS_SCALE_H
#define SFM_HEAD_LIMBUS_SCALE_H
#include "sfm/head/places.h"

/* The limbus's horizontal diameter; `common`: the share of the sigma all have alike, for people differ. */
bool places_limbus(struct places_lengths *out, double *common, const struct head *head, const struct views *views,
                   const struct places_face *face, struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
