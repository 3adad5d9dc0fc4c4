/* image: what the search and the measurement read of a photograph: a small pyramid of encoded brightness to search in, and linear
 * light around the eye, as the mixture of channels that best separates iris and sclera, to measure in.
 * Places are always px of the photograph; a level's pixel (i, j) is centred at ((i + 0.5), (j + 0.5)) * scale from the level's
 * origin.
 */
#ifndef LIMBUS_IMAGE_H
#define LIMBUS_IMAGE_H
#include "image/photo/photo.h"
#include "math/ellipse.h"

struct grey {
	int width, height;
	double x0, y0, scale;  // photo px of the level's corner; photo px in one of the level's
	float *px;             // [height][width]; owned
	struct grey_due *due;  // owned; null: every pixel is there, else those that grey_need was asked for
};

enum { PYRAMID_MAX = 6, PYRAMID_LONG = 640, PYRAMID_SHORT_MIN = 28 };

/* level[0] the finest, at most PYRAMID_LONG px on its longer side; each next is half of it. Encoded (sRGB) values.
 * level   whiteness 0..1: the darkest of the three channels, lowered where the colour is redder than the whitest of the light
 *         pixels. The sclera is lighter in it than irises of every colour, and than skin
 * bright  the lightest of the three channels
 * tint    0..1, the size of level[0]: 1 as white as sclera, less for skin */
struct pyramid {
	struct grey level[PYRAMID_MAX], bright[PYRAMID_MAX], tint;
	int n;
	double over, under;  // share of photo pixels with red and green above 0.99 / all below 0.01
};

struct pyramid pyramid_make(const struct photo *photo);
void pyramid_free(struct pyramid *pyramid);

/* Value at (x, y) photo px, bilinear, clamped to the border. */
static inline float grey_at(const struct grey *grey, double x, double y)
{
	double u = (x - grey->x0) / grey->scale - 0.5, v = (y - grey->y0) / grey->scale - 0.5;
	u = u < 0 ? 0 : u > grey->width - 1 ? grey->width - 1 : u;
	v = v < 0 ? 0 : v > grey->height - 1 ? grey->height - 1 : v;
	int i = (int)u, j = (int)v;
	i = i > grey->width - 2 ? grey->width - 2 : i;
	j = j > grey->height - 2 ? grey->height - 2 : j;
	float fu = (float)(u - i), fv = (float)(v - j);
	const float *p = grey->px + (long)j * grey->width + i, *q = p + grey->width;
	float top = p[0] + fu * (p[1] - p[0]), bottom = q[0] + fu * (q[1] - q[0]);
	return top + fv * (bottom - top);
}

/* Linear light around the ellipse (its box grown by `margin`), the sum of weight[c] (any sign) times channel c,
 * box-reduced so that the major semi-axis is at most max_a px. Profiles across an ellipse see a third of it: its pixels are made where grey_need asks
 * for them; `photo` is borrowed. grey_free. */
struct grey grey_linear(const struct photo *photo, const struct ellipse *e, double margin, double max_a,
                        const double weight[3]);
/* Makes the pixels that grey_at reads within n boxes (x0, y0, x1, y1, px of the photograph), where they are not there yet. One call at a time for each grey. */
void grey_need(const struct grey *grey, int n, const double box[n][4]);
void grey_free(struct grey *grey);

/* Linear colour at (x, y), nearest pixel; clamped. */
void photo_colour(double rgb[3], const struct photo *photo, double x, double y);

#endif
