#include "draw/face/sky.h"

#include <math.h>

float portrait_sky_over(float middle[3], const struct portrait *p, const float at[3], const float normal[3])
{
	enum { RAYS = 20 };
	float across[3], up[3], sum[3] = { 0 }, len, n = 0;
	int thin = fabsf(normal[0]) < 0.6f ? 0 : 1;
	for (int c = 0; c < 3; c++)
		across[c] = (c == thin) - normal[c] * normal[thin];
	len = sqrtf(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
	for (int c = 0; c < 3; c++)
		across[c] /= len;
	up[0] = normal[1] * across[2] - normal[2] * across[1];
	up[1] = normal[2] * across[0] - normal[0] * across[2];
	up[2] = normal[0] * across[1] - normal[1] * across[0];
	for (int k = 0; k < RAYS; k++) {
		float r = sqrtf(((float)k + 0.5f) / RAYS), turn = 2.399963f * (float)k, z = sqrtf(1 - r * r), dir[3];
		for (int c = 0; c < 3; c++)
			dir[c] = r * cosf(turn) * across[c] + r * sinf(turn) * up[c] + z * normal[c];
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
