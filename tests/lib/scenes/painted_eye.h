/* painted_eye: a film of one eye, drawn from closed forms apart from the programs: a sphere that turns about its centre, an
 * iris painted on it, two lids that are parabolas on the screen. No code of lib/ but random numbers.
 * Head frame: x to the person's left, y up, z out of the face, mm; the camera looks along -z from PAINTED_FAR.
 */
#ifndef TESTS_PAINTED_EYE_H
#define TESTS_PAINTED_EYE_H
#include <stdbool.h>
#include <stdint.h>

enum { PAINTED_W = 320, PAINTED_H = 200 };
extern const double PAINTED_FAR, PAINTED_FOCAL, PAINTED_R, PAINTED_LIMBUS;  // mm, px, mm, mm

struct painted_eye {
	double center[3];          // head frame
	double gaze[3];            // Fick, radians
	double canthus[2][2];      // px: inner, outer
	double rise[2];            // px: the upper lid's middle above, the lower's below the line between the corners
	double skin[3], iris[3];   // 0..255
	double noise;              // sigma, grey levels
	uint64_t seed;
};

/* rgb[PAINTED_H][PAINTED_W][3], luma[PAINTED_H][PAINTED_W]. */
void painted_eye_draw(uint8_t *rgb, uint8_t *luma, const struct painted_eye *eye);

/* Head to camera of the film, row-major 4 x 4. */
void painted_eye_camera(double cam_from_head[4][4]);

/* Row of a margin (0 upper, 1 lower) at x px; NAN beyond the corners. */
double painted_eye_lid(const struct painted_eye *eye, int lower, double x);

/* What the ray through x, y px meets where no lid is before it: the globe, or the pink of the corners. */
void painted_eye_globe(double out[3], const struct painted_eye *eye, double x, double y);

#endif
