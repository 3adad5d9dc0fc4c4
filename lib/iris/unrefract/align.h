/* unrefract_align: how the photographs of one eye lie against one another. Internal. */
#ifndef IRIS_UNREFRACT_ALIGN_H
#define IRIS_UNREFRACT_ALIGN_H
#include "iris/unrefract/unrefract.h"

void affine_apply(double out[2], const double a[2][3], double x, double y);

/* A survey's plane at a point of its own frame, bilinear. */
float survey_at(const struct unrefract_survey *survey, const float *plane, const double p[2]);

/* Fills detail and sharp. */
void unrefract_detail(struct unrefract_survey *survey);

/* Fills view's iris.a (map frame: that of `fixed`), rotation, correlation, used. */
void unrefract_register(const struct unrefract_view *fixed, struct unrefract_view *view,
                        const struct unrefract_conf *conf);

/* Colour gains, and weights lowered where a view is brighter than others (a glint that its own mask missed) or less
 * sharp. */
void unrefract_agree(int n, struct unrefract_view views[], int fixed);

#endif
