/* cv_ellipse: OpenCV's ellipse fits and detectors, baselines of benchmarks. Coordinates in px, pixel centres at (0.5, 0.5). */
#ifndef BRIDGE_CV_ELLIPSE_H
#define BRIDGE_CV_ELLIPSE_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdbool.h>
#include <stdint.h>

#include "math/ellipse_type.h"

enum cv_ellipse_method { CV_ELLIPSE_LS, CV_ELLIPSE_AMS, CV_ELLIPSE_DIRECT };

/* Fits an ellipse to n points xy[2 n], x then y. Returns false when there is none or OpenCV fails. */
bool cv_ellipse_fit(struct ellipse *e, int n, const double *xy, enum cv_ellipse_method method);

/* Fits an ellipse to the outline of the largest dark component after Otsu's threshold. grey: [height][width]. Returns false when
 * there is none. */
bool cv_otsu_ellipse(struct ellipse *e, const uint8_t *grey, int width, int height);

/* The strongest circle of the Hough transform with a radius in r_min..r_max, px. Returns false when there is none. */
bool cv_hough_circle(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max);

#ifdef __cplusplus
}
#endif
#endif
