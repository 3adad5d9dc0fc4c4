/* Lines rendered to a map of heights and of the visible share of an even sky. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "track/wrinkle/wrinkle.h"

static const double reach = 3.5;    // of a groove, in w

/* Draws one segment; where lines overlap the deepest counts. A line fades towards its ends, which are where it was lost, not where the skin is flat: over a quarter of its length, two to
 * six mm. */
static void put(struct image *map, const struct wrinkles *w, const struct wrinkle_line *line, int i)
{
	const struct wrinkle_point *a = &line->point[i], *b = &line->point[i + 1];
	double far = reach * fmax(a->width * hypot(a->across_px[0], a->across_px[1]), b->width * hypot(b->across_px[0], b->across_px[1]));
	double d[2] = { b->px[0] - a->px[0], b->px[1] - a->px[1] }, len2 = d[0] * d[0] + d[1] * d[1];
	int x0 = (int)fmax(0, fmin(a->px[0], b->px[0]) - far - w->x0), x1 = (int)fmin(w->width - 1, fmax(a->px[0], b->px[0]) + far - w->x0);
	int y0 = (int)fmax(0, fmin(a->px[1], b->px[1]) - far - w->y0), y1 = (int)fmin(w->height - 1, fmax(a->px[1], b->px[1]) + far - w->y0);
	const double fades = fmin(fmax(0.25 * (line->n - 1), 2), 6);
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			double p[2] = { x + 0.5 + w->x0 - a->px[0], y + 0.5 + w->y0 - a->px[1] };
			double t = len2 > 0 ? fmin(1, fmax(0, (p[0] * d[0] + p[1] * d[1]) / len2)) : 0, from = i + t, end = fmin(from, line->n - 1 - from);
			double q[2] = { p[0] - t * d[0], p[1] - t * d[1] }, px_per_mm[2], width = a->width + t * (b->width - a->width);
			for (int k = 0; k < 2; k++)
				px_per_mm[k] = a->across_px[k] + t * (b->across_px[k] - a->across_px[k]);
			double s = hypot(q[0], q[1]) / fmax(hypot(px_per_mm[0], px_per_mm[1]), 1e-6) / width;
			double fade = end < fades ? 0.5 - 0.5 * cos(M_PI * end / fades) : 1, depth = fade * (a->depth + t * (b->depth - a->depth));
			float h = (float)(-depth * exp(-0.5 * s * s)), *to = image_at(map, x, y);
			if (s < reach && h < to[0]) {
				to[0] = h;
				to[1] = (float)fmin((double)to[1], wrinkle_sky(s, depth / width));
			}
		}
}

struct image wrinkle_bump(const struct wrinkles *w, const struct wrinkle_pose *pose)
{
	struct image map = image_new(w->width, w->height, 2);
	for (long i = 0; i < (long)w->width * w->height; i++)
		map.px[2 * i + 1] = 1;
	for (int i = 0; i < pose->n; i++)
		for (int k = 0; k + 1 < pose->line[i].n; k++)
			put(&map, w, &pose->line[i], k);
	return map;
}
