/* Light at points of the iris: from the beams' tables (path = grid), or solved at both ends of every ray (path = ends). */
#include "draw/eye/march/march.h"

#include <math.h>

#include "optics/lightpath/lightpath.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

SIMD_CLONES
void scene_table_at(float out[SCENE_WAY], const struct scene_beam *beam, const float p[3], float extent)
{
	float per = (SCENE_GRID - 1) / (2 * extent), top = SCENE_GRID - 1.001f, u = (p[0] + extent) * per, v = (p[1] + extent) * per;
	float q = (p[2] - beam->z[0]) / (beam->z[1] - beam->z[0]), r = 1 - q;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v;
	u -= (float)iu;
	v -= (float)iv;
	const way_vector *a = (const way_vector *)beam->way[0][iv][iu], *b = (const way_vector *)beam->way[1][iv][iu];
	const way_vector *c = (const way_vector *)beam->way[0][iv + 1][iu], *d = (const way_vector *)beam->way[1][iv + 1][iu];
	float w00 = (1 - u) * (1 - v), w10 = u * (1 - v), w01 = (1 - u) * v, w11 = u * v;
	*(way_vector *)out = r * (w00 * a[0] + w10 * a[1] + w01 * c[0] + w11 * c[1]) + q * (w00 * b[0] + w10 * b[1] + w01 * d[0] + w11 * d[1]);
}

/* The sclera begins at the limbus, gradually: light that would enter further out is stopped. */
SIMD_CLONES
static void light_open(struct march_light *restrict light, int n, const float *restrict rho, const float *restrict x, const float *restrict y,
                       const float *restrict z, const struct rim_shadow *restrict rim)
{
	const float *restrict lx = light->x[0], *restrict ly = light->y[0], *restrict lz = light->z[0];
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		light->open[i] = rim_shadow_open(rim, rim_shadow_at(rim, rho[i], x[i], y[i], z[i], lx[i], ly[i], lz[i]));
}

static void table_paths(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                        const struct scene_beam *beam, float extent, const struct rim_shadow *rim)
{
	float rho[PART] = { 0 };
	for (int i = 0; i < n; i++) {
		float way[SCENE_WAY];
		scene_table_at(way, beam, (float[3]){ x[i], y[i], z[i] }, extent);
		light->x[end][i] = way[0];
		light->y[end][i] = way[1];
		light->z[end][i] = way[2];
		light->power[end][i] = way[2] < 0 ? way[3] : 0;  // an iris that juts out of its cornea is not lit from behind
		light->fall[end][i] = way[5];
		rho[i] = way[4];
	}
	if (end == 0)
		light_open(light, n, rho, x, y, z, rim);
	for (int i = 0; i < n; i++)
		light->power[end][i] = light->power[end][i] > 0 ? light->power[end][i] * light->open[i] : 0;
}

static void exact_paths(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                        const struct scene *s, const struct scene_beam *beam)
{
	float w[3][PART], k[3][PART];
	unsigned char status[PART];
	for (int i = 0; i < PART; i++)
		for (int c = 0; c < 3; c++)
			w[c][i] = beam->dir[c];
	lightpath_batch(n, x, y, z, w[0], w[1], w[2], k[0], k[1], k[2], status, &s->cornea, SCENE_PATH_STEPS);
	for (int i = 0; i < n; i++) {
		if (status[i] != LIGHTPATH_OK && status[i] != LIGHTPATH_BEYOND_RIM)
			continue;
		float d[3] = { k[0][i] - x[i], k[1][i] - y[i], k[2][i] - z[i] }, inv = 1 / sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		if (!(d[2] < 0))
			continue;
		light->x[end][i] = d[0] * inv;
		light->y[end][i] = d[1] * inv;
		light->z[end][i] = d[2] * inv;
		light->fall[end][i] = -d[2] * inv;
	}
}

void scene_light_at(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                    const struct scene *s, const struct scene_beam *beam)
{
	// The power is the table's either way: it is smooth enough.
	table_paths(light, end, n, x, y, z, beam, (float)s->extent, &s->rim);
	if (s->conf.path == SCENE_PATH_ENDS)
		exact_paths(light, end, n, x, y, z, s, beam);
}
