/* gaze_seek: roughly where an eye looks, without an edge being measured: the direction under which the limbus has the most
 * dark inside it and bright outside.
 */
#ifndef SKIN_GAZE_SEEK_H
#define SKIN_GAZE_SEEK_H
#include "skin/gaze_edge.h"

/* fick: where to start; replaced by the best of the grid `reach` round it (radians), then refined by halving the step to
 * `fine`. contrast: grey levels of a full step. Returns the mean share of a full step, -1..1: about 0 by chance, NAN when
 * the eye is out of the picture. */
double gaze_seek(double fick[2], const struct luma *luma, const struct gaze_globe *globe, const struct gaze_view *view,
                 double reach, double step, double fine, double contrast);

/* The score of one direction. */
double gaze_seek_score(const struct luma *luma, const struct gaze_globe *globe, const struct gaze_view *view,
                       const double fick[2], double contrast);

#endif
