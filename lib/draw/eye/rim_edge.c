#include "draw/eye/rim_edge.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/colour.h"
#include "draw/eye/march/beside.h"
#include "draw/eye/march/march.h"

/* prior: rms, mm: of what the photograph's limbus is worth as the end of clear cornea, and of the depth of the iris' root.
 * patch: mm: errors of light and albedo within it belong together. */
static const double prior = 0.1, patch = 0.5, inner = 0.72, outer = 0.95, least = -0.2, step = 0.05;
enum { STEPS = 11, RINGS = 16, ACROSS = 96 };

struct place {
	float photo;  // ln luminance
	float ring;   // 0..RINGS; negative: not used
};

static float luminance(const float *rgb, int stride)
{
	return 0.2126f * rgb[0] + 0.7152f * rgb[stride] + 0.0722f * rgb[2 * stride];
}

/* The photograph at a row of the grid: ring -1 where it is not used. */
static void row_see(struct place *to, const struct scene *s, const float *texture, int n, float y, float pitch)
{
	const struct scene_level *l = &s->level[0];
	for (int i = 0; i < n; i++) {
		float x = ((float)i + 0.5f) * pitch - (float)s->extent, rgb[4], share = hypotf(x / (float)s->limbus[0], y / (float)s->limbus[1]);
		for (int c = 0; c < 4; c++)
			rgb[c] = channel_at(texture, l->n, l->per_mm, x, y, 4, c);
		float light = luminance(rgb, 1);
		bool use = share > (float)inner && share < (float)outer && rgb[3] > 0.5f && light > SCENE_DARK && hypotf(x - (float)s->pupil[0], y - (float)s->pupil[1]) > (float)s->pupil[2] + 0.15f;
		to[i] = (struct place){ use ? logf(light) : 0, use ? fminf((share - (float)inner) / (float)(outer - inner) * RINGS, RINGS - 0.001f) : -1 };
	}
}

/* Sum of squares about the profile over the radius, linear between rings: each takes the mean of what it weighs, twice. */
static double squares(float *d, const struct place *place, long n)
{
	double square = 0;
	for (int turn = 0; turn < 3; turn++) {
		double sum[RINGS + 1] = { 0 }, all[RINGS + 1] = { 0 };
		for (long i = 0; i < n; i++) {
			int k = place[i].ring < 0 ? -1 : (int)place[i].ring;
			if (k < 0)
				continue;
			double t = (double)place[i].ring - k, of = (double)d[i];
			sum[k] += (1 - t) * of;
			sum[k + 1] += t * of;
			all[k] += 1 - t;
			all[k + 1] += t;
			square += turn < 2 ? 0 : of * of;
		}
		for (long i = 0; i < n && turn < 2; i++) {
			int k = place[i].ring < 0 ? -1 : (int)place[i].ring;
			double t = k < 0 ? 0 : (double)place[i].ring - k;
			if (k >= 0)
				d[i] -= (float)((1 - t) * sum[k] / fmax(all[k], 1e-9) + t * sum[k + 1] / fmax(all[k + 1], 1e-9));
		}
	}
	return square;
}

/* ln luminance of the photograph over the model as the scene's edge lies now. */
static void compare(float *d, const struct scene *s, const struct scene_level *level, const struct place *place, const double C[3], const struct scene_beams *beams)
{
	int n = level->n;
#pragma omp parallel for schedule(dynamic, 4)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x += BATCH) {
			struct iris_batch b;
			bool any = false;
			int some = n - x < BATCH ? n - x : BATCH;
			for (int i = 0; i < some; i++)
				any = any || place[(long)y * n + x + i].ring >= 0;
			if (!any)
				continue;
			scene_model_row(&b, s, level, x, some, y, C, beams);
			for (int i = 0; i < some; i++) {
				d[(long)y * n + x + i] = place[(long)y * n + x + i].photo - logf(fmaxf(luminance(&b.rgb[0][i], BATCH), SCENE_DARK));
			}
		}
}

/* Tries a place of the edge, mm beyond the limbus. */
static void put(struct scene *s, struct scene_beams *beams, double offset)
{
	s->rim.edge = (float)(1 + offset / s->limbus[0]);
	free(beams->beside);
	beams->beside = scene_beside(s, beams);
}

/* The coarsest level that still resolves the edge. */
static const struct scene_level *coarse(const struct scene *s)
{
	int k = 0;
	while (k + 1 < s->n_levels && s->level[k + 1].n >= ACROSS)
		k++;
	return &s->level[k];
}

/* Least cost of steps on a line, and the top of the parabola through it and its neighbours. */
static double lowest(const double cost[STEPS])
{
	int at = 0;
	for (int k = 1; k < STEPS; k++)
		at = cost[k] < cost[at] ? k : at;
	double bend = at > 0 && at < STEPS - 1 ? cost[at - 1] - 2 * cost[at] + cost[at + 1] : 0;
	return least + step * (at + (bend > 0 ? 0.5 * (cost[at - 1] - cost[at + 1]) / bend : 0));
}

void scene_rim_edge_fit(struct scene *s, const float *texture, const double C[3], struct scene_beams *beams)
{
	const struct scene_level *level = coarse(s);
	const int n = level->n;
	const double pitch = 1 / (double)level->per_mm;
	struct place *place = mem_array((size_t)n * (size_t)n, sizeof *place);
	float *d = mem_array((size_t)n * (size_t)n, sizeof *d);
	double count = 0, cost[STEPS];
#pragma omp parallel for schedule(static)
	for (int y = 0; y < n; y++)
		row_see(place + (long)y * n, s, texture, n, (float)((y + 0.5) * pitch - s->extent), (float)pitch);
	for (long i = 0; i < (long)n * n; i++)
		count += place[i].ring >= 0;
	const double patches = count * pitch * pitch / (patch * patch);
	for (int k = 0; k < STEPS && patches > RINGS; k++) {
		double offset = least + step * k;
		put(s, beams, offset);
		compare(d, s, level, place, C, beams);
		cost[k] = patches / 2 * log(fmax(squares(d, place, (long)n * n), 1e-9)) + offset * offset / (2 * prior * prior);
	}
	put(s, beams, patches > RINGS ? lowest(cost) : 0);
	free(place);
	free(d);
}
