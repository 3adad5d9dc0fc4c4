/* Irradiance of the iris plane: a picture without scattering multiplies the photograph's colours by it. It needs no directions, so
 * no beam's table is made; every light is stopped at the limbus by itself. */
#include "draw/eye/march/paths_flat.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/march/paths_impl.h"
#include "draw/eye/quick/map.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

struct flat_light {
	struct paths_light at;
	float rgb[3];
};

/* One ring's irradiance by all lights. */
SIMD_CLONES static void ring_sum(float (*restrict out)[4], int ring, int n, const struct flat_light *light, const struct scene *s)
{
	float sum[3][TURNS] = { 0 }, way[PLAIN_CHANNELS][TURNS], px[TURNS], py[TURNS], r = (float)(s->paths->most * ring / (PLAIN_RINGS - 1));
	float per_x = (float)(1 / s->limbus[0]), per_y = (float)(1 / s->limbus[1]), plane = (float)s->eye.iris_depth, up = plane - s->rim.depth;
	const struct rim_shadow rim = s->rim;
	for (int i = 0; i < TURNS; i++) {
		px[i] = r * cosf((float)(2 * M_PI) * (float)i / TURNS);
		py[i] = r * sinf((float)(2 * M_PI) * (float)i / TURNS);
	}
	for (int l = 0; l < n; l++) {
		float cosine = light[l].at.cosine, sine = light[l].at.sine;
		for (int c = 0; c < PLAIN_CHANNELS; c++)
			scene_paths_row(way[c], TURNS, s->paths->plain[light[l].at.angle][c] + ring * ROW, PLAIN_CHANNELS * PLAIN_FIELD, &light[l].at);
		SIMD_LOOP
		for (int i = 0; i < TURNS; i++) {
			float x = cosine * way[PLAIN_X][i] - sine * way[PLAIN_Y][i], y = sine * way[PLAIN_X][i] + cosine * way[PLAIN_Y][i];
			float e = way[PLAIN_FALL][i] > 0 ? way[PLAIN_FALL][i] : 0, u = per_x * x, v = per_y * y;
			float dx = x - px[i], dy = y - py[i], inv = 1 / sqrtf(dx * dx + dy * dy + up * up);  // the cornea is as deep there as the limbus, or the sclera is far
			e *= rim_shadow_open(&rim, rim_shadow_at(&rim, sqrtf(u * u + v * v), px[i], py[i], plane, inv * dx, inv * dy, -inv * up));
			sum[0][i] += light[l].rgb[0] * e;
			sum[1][i] += light[l].rgb[1] * e;
			sum[2][i] += light[l].rgb[2] * e;
		}
	}
	for (int i = 0; i < ROW; i++) {
		for (int c = 0; c < 3; c++)
			out[i][c] = s->flat[c] * sum[c][i % TURNS];
		out[i][3] = 0;
	}
}

SIMD_CLONES static void texels_put(float *restrict out, const float (*restrict polar)[4], const struct paths_place *place)
{
	for (int i = 0; i < SCENE_FLAT * SCENE_FLAT; i++) {
		const float *w = place[i].ring, *t = place[i].turn;
		const float(*from)[4] = polar + place[i].first;
		quick_four sum = { 0 };
		for (int k = 0; k < 4; k++) {
			const float(*row)[4] = from + k * ROW;
			sum += w[k] * (t[0] * quick_read(row[0]) + t[1] * quick_read(row[1]) + t[2] * quick_read(row[2]) + t[3] * quick_read(row[3]));
		}
		for (int c = 0; c < 3; c++)  // cubics go below where light ends
			sum[c] = sum[c] > 0 ? sum[c] : 0;
		memcpy(out + 4 * i, &sum, sizeof sum);
	}
}

float *scene_paths_flat(const struct scene *s, const struct scene_lighting *light, const double eye_from_cam[3][3])
{
	struct beam_lights *in = mem_array(1, sizeof *in);
	float(*polar)[4] = mem_array(PLAIN_FIELD, sizeof *polar), *out = mem_array(SCENE_FLAT * SCENE_FLAT, 4 * sizeof *out);
	scene_lights_turn(in, light, eye_from_cam);
	struct flat_light *of = mem_array((size_t)in->n + 1, sizeof *of);
	for (int l = 0; l < in->n; l++) {
		of[l].at = scene_paths_light(in->dir[l]);
		for (int c = 0; c < 3; c++)
			of[l].rgb[c] = in->rgb[l][c];
	}
#pragma omp parallel for schedule(static)
	for (int ring = 0; ring < PLAIN_RINGS; ring++)
		ring_sum(polar + ring * ROW, ring, in->n, of, s);
	texels_put(out, (const float(*)[4])polar, s->paths->flat);
	free(of);
	free(polar);
	free(in);
	return out;
}
