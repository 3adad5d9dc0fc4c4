/* limbus_scale: the scale from the eye itself: the visible iris has much the same width in all adults, 11.7 mm, 0.5 mm s.d.
 */
#ifndef SFM_HEAD_LIMBUS_SCALE_H
#define SFM_HEAD_LIMBUS_SCALE_H
#include "sfm/head/places.h"

/* Measures the limbus in each view that shows an eye and appends its semi-axis, world, beside limbus_radius_mm.
 * common  out: the relative sigma that all these lengths share, since people differ
 * Eyes that were found, not named, count only where the edge supports an ellipse, and without outliers (12 % from the median).
 * Returns false, err set, when a photograph cannot be read or a point not be triangulated. */
bool places_limbus(struct places_lengths *out, double *common, const struct head *head, const struct views *views,
                   const struct places_face *face, struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
