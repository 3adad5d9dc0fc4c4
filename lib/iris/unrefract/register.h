/* register: image registration of the photographs of one eye on the iris plane. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_REGISTER_H
#define IRIS_UNREFRACT_REGISTER_H
#include "iris/unrefract/unrefract.h"

/* out = a (x, y, 1). */
void affine_apply(double out[2], const double a[2][3], double x, double y);

/* Value of a survey's plane [size][size] at a point of its own frame (mm), bilinear, clamped. */
float survey_at(const struct unrefract_survey *survey, const float *plane, const double p[2]);

/* Allocates and fills survey->detail and survey->sharp from its rgb and weight. */
void unrefract_detail(struct unrefract_survey *survey);

/* Registers view to fixed: the torsion by correlation over all angles within conf->torsion_max_deg, then an affine map by
 * robust Gauss-Newton on the local contrast. Both surveys have detail.
 * Fills view's iris.a (map frame: that of `fixed`), rotation, correlation, and used: false where they overlap or correlate
 * too little, or the map stretches or shifts too far. */
void unrefract_register(const struct unrefract_view *fixed, struct unrefract_view *view,
                        const struct unrefract_conf *conf);

#endif
