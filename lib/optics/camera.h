/* camera: a pinhole camera with OpenCV's lens distortion.
 * Camera frame  x right, y down, z forward; mm.
 * Image         px, x right, y down, centre of the first pixel at (0.5, 0.5).
 */
#ifndef OPTICS_CAMERA_H
#define OPTICS_CAMERA_H
#include <stdbool.h>

/* Where the lens is known from: nowhere, capture.conf, EXIF, work/rig.json. */
enum camera_source { CAMERA_NONE, CAMERA_CONF, CAMERA_EXIF, CAMERA_RIG };

struct camera {
	double focal_px;             // NAN: unknown, weak perspective
	double center_px[2];
	double distortion[5];        // k1 k2 p1 p2 k3, OpenCV's order
	enum camera_source source;
};

/* Pixel of a point in camera coordinates, distortion included. Returns false for a point behind the camera. */
bool camera_project(double px[2], const struct camera *camera, const double point_in_cam[3]);

/* Unit direction of the ray through a pixel; distortion is inverted by Newton's method. */
void camera_ray(double dir_in_cam[3], const struct camera *camera, const double px[2]);

/* Pixel position without distortion. */
void camera_undistort(double out_px[2], const struct camera *camera, const double px[2]);

#endif
