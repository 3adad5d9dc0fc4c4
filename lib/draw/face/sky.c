#include "draw/face/sky.h"

#include <math.h>

#include "math/vec.h"

struct portrait_fan portrait_fan_of(const float n[3])
{
	struct portrait_fan f = { .normal = { n[0], n[1], n[2] } };
	const int thin = fabsf(n[0]) < 0.6f ? 0 : 1;
	for (int c = 0; c < 3; c++)
		f.across[c] = (c == thin) - n[c] * n[thin];
	vecf_unit(f.across);
	vecf_cross(f.up, n, f.across);
	return f;
}

float portrait_fan_ray(float dir[3], const struct portrait_fan *f, int k, int rays)
{
	const float r = sqrtf(((float)k + 0.5f) / (float)rays), turn = 2.399963f * (float)k, z = sqrtf(1 - r * r);
	for (int c = 0; c < 3; c++)
		dir[c] = r * cosf(turn) * f->across[c] + r * sinf(turn) * f->up[c] + z * f->normal[c];
	return z;
}

float portrait_sky_over(float middle[3], const struct portrait *p, const float at[3], const float normal[3])
{
	enum { RAYS = 20 };
	const struct portrait_fan fan = portrait_fan_of(normal);
	float sum[3] = { 0 }, len, n = 0;
	for (int k = 0; k < RAYS; k++) {
		float dir[3];
		portrait_fan_ray(dir, &fan, k, RAYS);
		if (ray_blocked(p->shadow, at, dir, 0.02f, 60))
			continue;
		n++;
		for (int c = 0; c < 3; c++)
			sum[c] += dir[c];
	}
	len = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	for (int c = 0; c < 3; c++)
		middle[c] = n > 0 ? sum[c] / len : normal[c];
	return n / RAYS;
}
