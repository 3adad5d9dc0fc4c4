/* pupil: where an iris ends inside: measured, or the likeliest size where its margin was not. Internal to unrefract.
 */
#ifndef IRIS_UNREFRACT_PUPIL_H
#define IRIS_UNREFRACT_PUPIL_H
#include "iris/unrefract/told.h"
#include "iris/unrefract/unrefract.h"

/* The pupil's ellipse in the photograph, projected through the cornea to the iris plane, as a circle. r = 0: the fit has none. */
struct circle pupil_measured(const struct unrefract_view *view);

/* How likely what is seen is for each size, by the evidence of the texels and the step of brightness at its margin.
 * lum, iris  [size][size]: log brightness; weight of what is iris or pupil and no lid, 0..1
 * The centre is the evidence's, near the axis. */
void pupil_curve_of(struct pupil_curve *out, const float *lum, const float *iris, const struct told *told, const struct unrefract_survey *survey,
                    double limbus, const struct unrefract_conf *conf);
/* Of a radius that is known. */
void pupil_curve_at(struct pupil_curve *out, double radius);
/* Adds what the fellow eye's tells. */
void pupil_curve_join(struct pupil_curve *curve, const struct pupil_curve *fellow, const struct unrefract_conf *conf);

/* With what pupils measure in photographs: the mean of the radius' logarithm, and its standard deviation. */
struct circle pupil_of_curve(double *log_sigma, const struct pupil_curve *curve, const struct unrefract_conf *conf);

#endif
