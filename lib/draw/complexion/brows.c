/* Brows in the person's chart: how much of the skin they hide, and which way they grow. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "draw/smooth.h"
#include "math/stats.h"

static const double skin_mm = 5, detail_mm = 0.5, grain_mm = 1.0;  // skin beside a brow; hairs' own detail; over which they run alike
static const double full_share = 0.02, full_most = 0.6;            // darkest texels of a brow are hair alone; hair is that dark at least
static const double seen_share = 0.8, least_cover = 0.03, least_part = 0.15;  // of a cell; of the largest patch
static const float rough[2] = { 0.1f, 0.4f };                      // detail over that of brows from which on what is dark is hairs, not shadow
/* Where adults' brows grow, front of an eye: by so much of it the skin is seen or not. */
static const double box_x[2] = { -14, 20 }, box_y[2] = { 13, 24 };

struct cells {
	float sum[HAIR_CELLS_Y][HAIR_CELLS_X], twice[HAIR_CELLS_Y][HAIR_CELLS_X][2];
	int seen[HAIR_CELLS_Y][HAIR_CELLS_X];
};

/* Structure tensor of the detail: [texels][3] xx, xy, yy, averaged. */
static bool tensor(float (*t)[3], const float *grey, const float *weight, const struct complexion *c, struct err *err)
{
	const int side = c->side;
	const size_t n = (size_t)side * (size_t)side;
	float *low = mem_array(n + 1, sizeof *low);
	bool ok = complexion_blur(low, 0, grey, weight, 1, detail_mm, c, err);
	memset(t, 0, n * sizeof *t);
	for (int y = 1; y + 1 < side && ok; y++)
		for (int x = 1; x + 1 < side; x++) {
			const size_t i = (size_t)y * (size_t)side + (size_t)x, w = (size_t)side;
			if (!(weight[i - 1] > 0 && weight[i + 1] > 0 && weight[i - w] > 0 && weight[i + w] > 0))
				continue;
			const float gx = grey[i + 1] - low[i + 1] - grey[i - 1] + low[i - 1], gy = grey[i + w] - low[i + w] - grey[i - w] + low[i - w];
			t[i][0] = gx * gx;
			t[i][1] = gx * gy;
			t[i][2] = gy * gy;
		}
	ok = ok && complexion_blur(&t[0][0], 0, &t[0][0], weight, 3, grain_mm, c, err);
	free(low);
	return ok;
}

static void gather(struct cells *k, int side, const float *cover, const float (*t)[3], const float *weight, const struct complexion *c)
{
	const double middle = 0.5 * (c->eye[0][0] + c->eye[1][0]);
	memset(k, 0, sizeof *k);
	for (long p = 0; p < (long)c->side * c->side; p++) {
		float x[3];
		if (!(weight[p] > 0) || !complexion_place(x, c, p) || ((double)x[0] > middle) == (side == 1))
			continue;
		const int cell = hair_cell(&c->hair, side, (double[]){ (double)x[0], (double)x[1] }), i = cell % HAIR_CELLS_X, j = cell / HAIR_CELLS_X;
		if (cell < 0)
			continue;
		k->seen[j][i]++;
		if (!(cover[p] > 0))
			continue;
		k->sum[j][i] += cover[p];
		// Hairs run along the eigenvector of the least change; doubled angles have no sign. v points down, u to the person's left.
		k->twice[j][i][0] += t[p][2] - t[p][0];
		k->twice[j][i][1] += (side ? -1 : 1) * 2 * t[p][1];
	}
}

/* Clears cells that are not of the brow: patches that are small beside the largest. */
static void one_patch(float cover[HAIR_CELLS_Y][HAIR_CELLS_X])
{
	enum { N = HAIR_CELLS_X * HAIR_CELLS_Y };
	int *patch = mem_new(N, sizeof *patch), *todo = mem_new(N, sizeof *todo), patches = 0;
	double *size = mem_new(N + 1, sizeof *size), largest = 0;
	float *flat = &cover[0][0];
	for (int from = 0; from < N; from++) {
		int n = 0;
		if (!(flat[from] > 0) || patch[from])
			continue;
		patch[from] = ++patches;
		todo[n++] = from;
		while (n) {
			const int at = todo[--n], i = at % HAIR_CELLS_X, j = at / HAIR_CELLS_X;
			size[patches] += (double)flat[at];
			for (int k = 0; k < 9; k++) {
				const int u = i + k % 3 - 1, v = j + k / 3 - 1, to = v * HAIR_CELLS_X + u;
				if (u < 0 || v < 0 || u >= HAIR_CELLS_X || v >= HAIR_CELLS_Y || patch[to] || !(flat[to] > 0))
					continue;
				patch[to] = patches;
				todo[n++] = to;
			}
		}
		largest = fmax(largest, size[patches]);
	}
	for (int i = 0; i < N; i++)
		if (patch[i] && size[patch[i]] < least_part * largest)
			flat[i] = 0;
	free(patch);
	free(todo);
	free(size);
}

/* The median detail of what hides much; 0: of too little. */
static float detail(const float *cover, const float (*t)[3], long n)
{
	double *x = mem_array((size_t)n + 1, sizeof *x), median = 0;
	int many = 0;
	for (long i = 0; i < n; i++)
		if (cover[i] > 0.4f)
			x[many++] = (double)(t[i][0] + t[i][2]);
	if (many > 100)
		median = stats_median(many, x);
	free(x);
	return (float)median;
}

/* Share of the place where adults' brows grow that is seen. */
static double seen(const struct cells *k)
{
	int all = 0, in = 0;
	for (int j = 0; j < HAIR_CELLS_Y; j++)
		for (int i = 0; i < HAIR_CELLS_X; i++) {
			const double x = HAIR_FROM_X + HAIR_CELL * i, y = HAIR_FROM_Y + HAIR_CELL * j;
			if (x > box_x[0] && x < box_x[1] && y > box_y[0] && y < box_y[1]) {
				all++;
				in += k->seen[j][i] > 0;
			}
		}
	return (double)in / all;
}

/* The direction whose double is given and that is nearer to how brows grow: up at the nose, outward and down beyond the middle. */
static double grows(double x, double c2, double s2)
{
	const double usual = hair_brow_way(x);
	const double strong = hypot(c2, s2);
	if (!(strong > 0))
		return usual;
	const double way = 0.5 * atan2(s2, c2), off = remainder(way - usual, M_PI);
	return usual + fmin(fmax(off, -1.2), 1.2);
}

bool complexion_brows(struct hair_film *film, const float (*ln)[3], const float *before, const float *after, const uint8_t *brow,
                      const struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	float *grey = mem_array((size_t)n + 1, sizeof *grey), *skin = mem_array((size_t)n + 1, sizeof *skin), *cover = mem_new((size_t)n + 1, sizeof *cover), (*t)[3] = mem_array((size_t)n + 1, sizeof *t);
	double *dark = mem_array((size_t)n + 1, sizeof *dark), sum[3] = { 0 };
	struct cells *k = mem_new(1, sizeof *k);
	int many = 0, hairs = 0;
	for (long i = 0; i < n; i++)
		grey[i] = (float)complexion_luminance(ln[i]);
	bool ok = complexion_blur(skin, 0, grey, after, 1, skin_mm, c, err) && tensor(t, grey, before, c, err);
	for (long i = 0; i < n && ok; i++)
		if (brow[i] && before[i] > 0)
			dark[many++] = (double)(grey[i] - skin[i]);
	const double full = many > 100 ? fmin(exp(stats_quantile(many, dark, full_share)), full_most) : full_most;
	for (long i = 0; i < n && ok; i++) {
		const double share = brow[i] && before[i] > 0 ? exp((double)(grey[i] - skin[i])) : 1;
		cover[i] = (float)fmin(fmax((1 - share) / (1 - full), 0), 1);
		if (cover[i] > 0.97f) {
			hairs++;
			for (int q = 0; q < 3; q++)
				sum[q] += (double)ln[i][q];
		}
	}
	const float of_hairs = detail(cover, (const float(*)[3])t, n);
	for (long i = 0; i < n && of_hairs > 0; i++)
		cover[i] *= smooth(rough[0], rough[1], (t[i][0] + t[i][2]) / of_hairs);
	for (int q = 0; q < 3; q++)
		film->rgb[q] = hairs > 20 ? exp(sum[q] / hairs) : 0;
	for (int s = 0; s < 2 && ok; s++) {
		gather(k, s, cover, (const float(*)[3])t, before, c);
		film->brow[s] = seen(k) >= seen_share;
		for (int j = 0; j < HAIR_CELLS_Y; j++)
			for (int i = 0; i < HAIR_CELLS_X; i++) {
				const float share = k->seen[j][i] ? k->sum[j][i] / (float)k->seen[j][i] : 0;
				film->cover[s][j][i] = share > (float)least_cover ? share : 0;
				film->way[s][j][i] = (float)grows(HAIR_FROM_X + HAIR_CELL * i, (double)k->twice[j][i][0], (double)k->twice[j][i][1]);
			}
		one_patch(film->cover[s]);
	}
	free(grey);
	free(skin);
	free(cover);
	free(t);
	free(dark);
	free(k);
	return ok;
}
