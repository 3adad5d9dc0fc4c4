/* synth_eye: a renderer of eyes for tests, written apart from the programs: spheres and its own ray geometry, no code
 * of lib/ but random numbers. A limbus that is a soft ramp on a spherical cornea's rim, a textured iris behind a
 * refracting sphere, shaded sclera with veins, skin, curved lids with lashes, reflections, blur, noise.
 */
#ifndef TESTS_SYNTH_EYE_H
#define TESTS_SYNTH_EYE_H
#include <stdint.h>

#include "image/photo/photo.h"
#include "math/ellipse.h"

struct synth_eye {
	uint64_t seed;             // texture, lashes, veins, noise
	int width, height;         // px
	double limbus_px;          // semi-axis in the picture, about
	double center[2];          // px, of the limbus
	double theta, phi;         // tilt of the axis away from the camera, radians
	double distance;           // mm
	double iris[3], skin[3];   // linear colour
	double texture;            // contrast of the iris' streaks, 0..1
	double ramp;               // half-width of the limbal ramp, mm
	double pupil;              // radius over limbus radius
	double occlusion;          // share of the limbus behind the lids, 0..0.8
	double lashes;             // how many, 0..1
	double glints;             // how many reflections, 0..1
	double light;              // direction the shading falls off to, radians; strength 0..1 below
	double shading;
	double exposure;
	double blur;               // sigma, px
	double noise;              // sigma of an encoded value, 0..1
	bool lids;                 // draw lids at all; without, the eyeball stands alone
};

struct synth_truth {
	struct ellipse limbus;     // px: the middle of the ramp
	double occlusion;          // as drawn
	double focal_px;
	double axis[3];            // optical axis into the eye, camera frame
	double apex[3];            // mm, camera frame
};

/* Anatomy of every synthetic eye, mm: a sphere for the cornea, one for the sclera. */
enum { SYNTH_SAMPLES = 2 };    // rays a pixel and direction
extern const double SYNTH_CORNEA_R, SYNTH_LIMBUS_R, SYNTH_IRIS_DEPTH, SYNTH_INDEX;

/* A fresh picture (photo_free) and its truth. */
struct photo synth_eye_render(const struct synth_eye *eye, struct synth_truth *truth);

/* The case-th of the grid of 240: occlusion 0 to 0.6 in steps of 0.15 by 48 eyes of all colours, sizes, tilts, blur,
 * noise and reflections. 640 x 480. */
enum { SYNTH_GRID = 240, SYNTH_LEVELS = 5 };
struct synth_eye synth_eye_grid(int index);

#endif
