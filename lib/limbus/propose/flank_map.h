/* flank_map: a part of a photograph as logarithms of its channels. Internal to flank. */
#ifndef LIMBUS_PROPOSE_FLANK_MAP_H
#define LIMBUS_PROPOSE_FLANK_MAP_H
#include "image/photo/photo.h"

/* Photo px (x, y) lies at ((x - x0) / scale - 0.5, ...) of the map. */
struct log_map {
	int width, height;
	double x0, y0, scale;
	float (*px)[4];  // [height * width] log of encoded red, green, blue, a little above black; owned
};

/* The part in box = { x0, y0, x1, y1 } (px; clipped to the photograph), reduced by a whole factor near `scale`. free(map.px). */
struct log_map log_map_make(const struct photo *photo, const double box[4], double scale);

/* A map of half the size. free(map.px). */
struct log_map log_map_halve(const struct log_map *map);

/* The smallest of the three channels' steps from (x0, y0) inside to (x1, y1) outside, map px, nearest pixel; 0 off the map. */
static inline float log_map_step(const struct log_map *m, float x0, float y0, float x1, float y1)
{
	int i0 = (int)(x0 + 0.5f), j0 = (int)(y0 + 0.5f), i1 = (int)(x1 + 0.5f), j1 = (int)(y1 + 0.5f);
	if (i0 < 0 || j0 < 0 || i1 < 0 || j1 < 0 || i0 >= m->width || i1 >= m->width || j0 >= m->height || j1 >= m->height)
		return 0;
	const float *a = m->px[(long)j0 * m->width + i0], *b = m->px[(long)j1 * m->width + i1];
	float r = b[0] - a[0], g = b[1] - a[1], u = b[2] - a[2], least = r < g ? r : g;
	return least < u ? least : u;
}

#endif
