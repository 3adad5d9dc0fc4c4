/* cv_marker: detection of square markers printed beside the subject (ArUco and AprilTag families) by OpenCV. */
#ifndef BRIDGE_CV_MARKER_H
#define BRIDGE_CV_MARKER_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

struct cv_marker {
	int family, id;       // the same marker has the same two numbers in every picture
	double corner[4][2];  // px, first pixel's centre at 0.5; clockwise from the marker's own top left
};

/* Finds markers[most], *n of them, in a picture grey[height][width]. Returns false, err set, where OpenCV fails. */
bool cv_markers(int *n, struct cv_marker *markers, int most, const uint8_t *grey, int width, int height, struct err *err);

/* Draws a marker as it is printed: out[size][size], 0 and 255, with a white margin. Returns false, err set, where OpenCV fails. */
bool cv_marker_draw(uint8_t *out, int size, int family, int id, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
