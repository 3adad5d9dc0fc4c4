#include "draw/eye/march/beside.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/march/march.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

enum { N = SCENE_BESIDE };
static const float dark = (float)LOOK_BESIDE_DARK;

/* A row of the map: irradiance hard at the limbus and as the march takes it, soft. */
struct row {
	float y, z, x[N], way[5][N], hard[3][N], soft[3][N];
};

/* A beam's channels along the row: its table's rows and planes, then linear between columns. */
SIMD_CLONES static void row_read(struct row *restrict row, const struct scene_beam *restrict beam, float extent)
{
	float line[SCENE_GRID * SCENE_WAY], per = (SCENE_GRID - 1) / (2 * extent), v = (row->y + extent) * per, top = SCENE_GRID - 1.001f;
	float q = (row->z - beam->z[0]) / (beam->z[1] - beam->z[0]);
	int iv = (int)(v > 0 ? v < top ? v : top : 0);
	v -= (float)iv;
	const float *restrict a = beam->way[0][iv][0], *restrict b = beam->way[0][iv + 1][0], *restrict c = beam->way[1][iv][0], *restrict d = beam->way[1][iv + 1][0];
	SIMD_LOOP
	for (int i = 0; i < SCENE_GRID * SCENE_WAY; i++)
		line[i] = (1 - q) * (a[i] + v * (b[i] - a[i])) + q * (c[i] + v * (d[i] - c[i]));
	for (int x = 0; x < N; x++) {
		float u = (row->x[x] + extent) * per;
		int iu = (int)(u > 0 ? u < top ? u : top : 0);
		u -= (float)iu;
		const float *left = line + SCENE_WAY * iu, *right = left + SCENE_WAY;
		for (int k = 0; k < 5; k++)
			row->way[k][x] = left[k] + u * (right[k] - left[k]);
	}
}

SIMD_CLONES static void row_add(struct row *restrict row, const float rgb[3], const struct rim_shadow *restrict at_once, const struct rim_shadow *restrict rim)
{
	const float red = rgb[0], green = rgb[1], blue = rgb[2];
	SIMD_LOOP
	for (int i = 0; i < N; i++) {
		float x = row->x[i], lx = row->way[0][i], ly = row->way[1][i], lz = row->way[2][i], power = row->way[3][i], rho = row->way[4][i];
		float e = lz < 0 && power > 0 ? -lz * power : 0;
		float h = e * rim_shadow_open(at_once, rim_shadow_at(at_once, rho, x, row->y, row->z, lx, ly, lz));
		float f = e * rim_shadow_open(rim, rim_shadow_at(rim, rho, x, row->y, row->z, lx, ly, lz));
		row->hard[0][i] += red * h;
		row->hard[1][i] += green * h;
		row->hard[2][i] += blue * h;
		row->soft[0][i] += red * f;
		row->soft[1][i] += green * f;
		row->soft[2][i] += blue * f;
	}
}

static void row_light(float (*hard)[3], float (*soft)[3], int y, const struct scene *s, const struct scene_beams *beams)
{
	const struct rim_shadow at_once = { s->rim.width, s->rim.slope, s->rim.depth, 0, 1, s->rim.edge };
	const float extent = (float)s->extent, step = 2 * extent / N;
	struct row row = { .y = ((float)y + 0.5f) * step - extent, .z = (float)s->eye.iris_depth };
	for (int x = 0; x < N; x++)
		row.x[x] = ((float)x + 0.5f) * step - extent;
	for (int l = 0; l < beams->n; l++) {
		row_read(&row, &beams->beam[l], extent);
		row_add(&row, beams->beam[l].rgb, &at_once, &s->rim);
	}
	for (int x = 0; x < N; x++)
		for (int c = 0; c < 3; c++) {
			hard[x][c] = dark + row.hard[c][x];
			soft[x][c] = dark + row.soft[c][x];
		}
}

/* The kernel along one axis: sums of both directions, each decaying by `keep` a step; the map is mirrored beyond its borders. */
static void along(float *px, int stride, float keep)
{
	enum { BEYOND = 12 };
	float ahead[N], sum = 0, gain = (1 - keep) / (1 + keep);
	for (int i = -BEYOND; i < N; i++) {
		sum = keep * sum + px[(long)(i < 0 ? -1 - i : i) * stride];
		if (i >= 0)
			ahead[i] = sum;
	}
	sum = 0;
	for (int i = N + BEYOND - 1; i >= 0; i--) {
		float own = px[(long)(i < N ? i : 2 * N - 1 - i) * stride], before = sum;
		sum = keep * sum + own;
		if (i < N)
			ahead[i] += keep * before;
	}
	for (int i = 0; i < N; i++)
		px[(long)i * stride] = gain * ahead[i];
}

/* Two-sided decay on texels of that variance (in steps^2): 2 keep / (1 - keep)^2. */
static float keep_of(float variance)
{
	float a = 1 + 1 / fmaxf(variance, 1e-6f);
	return a - sqrtf(a * a - 1);
}

float *scene_beside(const struct scene *s, const struct scene_beams *beams)
{
	if (!(s->spread[1] > 0) || !beams->n)
		return 0;
	float(*hard)[3] = mem_array(N * N, sizeof *hard), *out = mem_array(4 * N * N, sizeof *out), per = (float)(N / (2 * s->extent));
	float(*soft)[3] = mem_array(N * N, sizeof *soft);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < N; y++)
		row_light(hard + y * N, soft + y * N, y, s, beams);
	for (int c = 0; c < 3; c++) {
		float sigma = s->spread[c] * per, keep = keep_of(sigma * sigma);
		for (int i = 0; i < N; i++)
			along(&hard[i * N][c], 3, keep);
		for (int i = 0; i < N; i++)
			along(&hard[i][c], 3 * N, keep);
		for (int i = 0; i < N * N; i++)
			out[4 * i + c] = hard[i][c] / soft[i][c];
	}
	for (int i = 0; i < N * N; i++)
		out[4 * i + 3] = 0;
	free(hard);
	free(soft);
	return out;
}

SIMD_CLONES void scene_beside_put(int n, float *restrict r, float *restrict g, float *restrict b, const float *restrict x, const float *restrict y,
                                  const float *restrict beside, float extent)
{
	const float per = N / (2 * extent), top = N - 1.001f;
	if (!beside)
		return;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float u = (x[i] + extent) * per - 0.5f, v = (y[i] + extent) * per - 0.5f;
		u = u > 0 ? u < top ? u : top : 0;
		v = v > 0 ? v < top ? v : top : 0;
		int iu = (int)u, iv = (int)v;
		u -= (float)iu;
		v -= (float)iv;
		const float *p = beside + 4 * (iv * N + iu), w00 = (1 - u) * (1 - v), w10 = u * (1 - v), w01 = (1 - u) * v, w11 = u * v;
		r[i] *= w00 * p[0] + w10 * p[4] + w01 * p[4 * N] + w11 * p[4 * N + 4];
		g[i] *= w00 * p[1] + w10 * p[5] + w01 * p[4 * N + 1] + w11 * p[4 * N + 5];
		b[i] *= w00 * p[2] + w10 * p[6] + w01 * p[4 * N + 2] + w11 * p[4 * N + 6];
	}
}
