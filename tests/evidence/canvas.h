/* canvas: the linear picture that scenes are drawn into, with class and cover of hair at every pixel.
 * Face frame  mm, u to the right, v up, origin between the eyes; the picture may show it turned and mirrored.
 */
#ifndef EVIDENCE_CANVAS_H
#define EVIDENCE_CANVAS_H
#include <stdbool.h>
#include <stdint.h>

#include "math/rng.h"

struct canvas {
	int width, height;
	float *rgb;       // [height][width][3], linear
	float *hair;      // [height][width], share that hairs cover
	float *mirror, *body;  // [height][width], luminance that eyes and glasses mirror, and that of what lies below it
	uint8_t *label;   // [height][width]
	float at[2];      // face mm of px (0, 0)
	float m[2][2];    // face mm a px: u = at[0] + m[0][0] x + m[0][1] y
	float inv[2][2];  // px a mm
	float mm;         // a px
};

struct canvas canvas_new(int width, int height);
void canvas_free(struct canvas *canvas);

/* Sets the view: face point (u, v) at px (x, y), so many mm a px, turned by an angle, mirrored or not. */
void canvas_view(struct canvas *canvas, float u, float v, float x, float y, float mm, float turn, bool mirrored);

void canvas_px(float px[2], const struct canvas *canvas, float u, float v);

/* A hair: a quadratic curve through three points of the face, mm, tapering from width (mm) to a third, of one colour. */
void canvas_hair(struct canvas *canvas, const float p[3][2], float width, const float rgb[3], float opacity);

/* Turns what hairs cover by more than half into class lash. */
void canvas_label_hair(struct canvas *canvas);

static inline float smooth_step(float x, float from, float to)
{
	float t = (x - from) / (to - from);
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	return t * t * (3 - 2 * t);
}

static inline float range_of(struct rng *rng, double lo, double hi)
{
	return (float)rng_range(rng, lo, hi);
}

#endif
