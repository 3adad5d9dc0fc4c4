/* globe: the limbus as a circle in space on an eyeball that rotates about its centre, and its projection into a camera.
 * Head frame mm; eye axes: z out through the pupil, x and y those of the head turned by Fick's angles
 * Ry(h) Rx(-v) Rz(t). The limbus: radius `limbus` about the axis, at sqrt(radius² − limbus²) from the centre.
 */
#ifndef TRACK_GAZE_GLOBE_H
#define TRACK_GAZE_GLOBE_H
#include <stdbool.h>

#include "math/ellipse_type.h"
#include "optics/camera.h"

struct gaze_globe {
	double center[3];       // in the head frame
	double radius, limbus;  // mm
};

struct gaze_view {
	struct camera camera;   // focal_px finite
	double cam_from_head[4][4];
};

/* Rotation of Fick angles (h, v, torsion, radians). Columns: the eye's x, y and z axes in the head frame. */
void gaze_rotation(double head_from_eye[3][3], const double fick[3]);

/* Distance of the plane of the limbus from the globe's centre, mm; 0 where the circle is larger than the sphere. */
double gaze_plane(const struct gaze_globe *globe);

enum { GAZE_H, GAZE_V, GAZE_X, GAZE_Y, GAZE_Z, GAZE_RADIUS, GAZE_LIMBUS, GAZE_N };

struct gaze_arc {
	double p[2], normal[2];    // px, outward
	double row[GAZE_N];        // Jacobian: d(p·normal) by h, v (radians), centre, radius, limbus (mm); only with_row
};

/* Projects the point of the limbus at `angle` (radians from the eye's x axis towards its y axis). fick: h, v, radians;
 * head_from_eye: gaze_rotation() of them, torsion 0, made once for many points. with_row: fills row.
 * Returns false when it is behind the camera. */
bool gaze_arc(struct gaze_arc *arc, const struct gaze_globe *globe, const struct gaze_view *view, double head_from_eye[3][3],
              const double fick[2], double angle, bool with_row);

/* Pixel of a point of the eye frame (origin at the globe's centre, mm); false behind the camera. */
bool gaze_pixel(double px[2], const struct gaze_globe *globe, const struct gaze_view *view, const double fick[3],
                const double point_in_eye[3]);

/* The same of an eye whose rotation (gaze_rotation()) is known. */
bool gaze_pixel_of(double px[2], const struct gaze_globe *globe, const struct gaze_view *view, double head_from_eye[3][3],
                   const double point_in_eye[3]);

/* The ellipse that the limbus projects to, px (exact but for lens distortion); false behind the camera. */
bool gaze_ellipse(struct ellipse *e, const struct gaze_globe *globe, const struct gaze_view *view,
                  const double fick[2]);

#endif
