#include <math.h>

#include "image/distance/impl.h"

float distance_in_world(const struct distance_scene *s, int x, int y, const float off[2], float d2)
{
	if (!s->depth)
		return sqrtf(d2);
	float length = sqrtf(d2), out = length > 0 ? 0.5f / length : 0;  // onto the skin's side of its edge
	int u = (int)floorf((float)x + 0.5f + off[0] * (1 + out)), w = (int)floorf((float)y + 0.5f + off[1] * (1 + out));
	u = u < 0 ? 0 : u >= s->width ? s->width - 1 : u;
	w = w < 0 ? 0 : w >= s->height ? s->height - 1 : w;
	double z[2] = { s->depth[(size_t)y * (size_t)s->width + (size_t)x], s->depth[(size_t)w * (size_t)s->width + (size_t)u] };
	double at[2] = { x + 0.5 - s->center_px[0], y + 0.5 - s->center_px[1] }, sum = (z[1] - z[0]) * (z[1] - z[0]);
	for (int k = 0; k < 2; k++) {
		double d = ((at[k] + (double)off[k]) * z[1] - at[k] * z[0]) / s->focal_px;
		sum += d * d;
	}
	return (float)sqrt(sum);
}
