/* cv_ellipse: OpenCV's ellipse fits and detectors, as baselines for benchmarks. Pixel centres at (0.5, 0.5). */
#ifndef BRIDGE_CV_ELLIPSE_H
#define BRIDGE_CV_ELLIPSE_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdbool.h>
#include <stdint.h>

#include "math/ellipse_type.h"

enum cv_ellipse_method { CV_ELLIPSE_LS, CV_ELLIPSE_AMS, CV_ELLIPSE_DIRECT };

/* xy: n points, x then y. False: no ellipse, or OpenCV refuses. */
bool cv_ellipse_fit(struct ellipse *e, int n, const double *xy, enum cv_ellipse_method method);

/* Largest dark blob after Otsu's threshold, its outline fitted. grey: [height][width]. */
bool cv_otsu_ellipse(struct ellipse *e, const uint8_t *grey, int width, int height);

/* The strongest circle of the Hough transform between two radii. */
bool cv_hough_circle(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max);

#ifdef __cplusplus
}
#endif
#endif
