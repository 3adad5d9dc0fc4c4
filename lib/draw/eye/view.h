/* view: how an eye is looked at: camera, pose, and the part of the camera's picture that is drawn.
 * Image px: x right, y down, centre of the first pixel at (0.5, 0.5). Frames: eye and camera (lib/README.md), mm.
 */
#ifndef DRAW_EYE_VIEW_H
#define DRAW_EYE_VIEW_H
#include "anatomy/fit.h"
#include "draw/eye/scene.h"

struct scene_view {
	struct camera camera;
	double cam_from_eye[4][4];
	double slip[2][3];            // iris maps are looked up at (x, y) + slip (x, y, 1): what registration of several
	                              // photographs found beyond the pose; zero: nothing
	double x0, y0, scale;         // camera px of the picture's corner, and of one of its pixels
	int width, height;            // px
	int samples;                  // samples^2 rays where the picture has edges, at most
	bool textured;                // the photograph's colour alone, without scattering: the cheap alternative
	const unsigned char *visible; // [height][width] 1, or 0: something stands before the eye there, and it is not drawn; null: all
	struct scene_hits *hits;      // keeps what rays meet while only the light changes (quick/hits.h); null: nothing is kept
};

/* An eye that is turned by yaw and pitch (rad) in front of a long lens; the square picture of size px shows field mm. */
struct scene_view scene_view_turned(const struct scene *scene, double yaw, double pitch, double field, int size);

/* The view of the photograph itself: the window x0, y0, x1, y1 of it (photo px), scale photo px a pixel. */
struct scene_view scene_view_photo(const struct fit *fit, const double window[4], double scale);

#endif
