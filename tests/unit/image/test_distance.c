/* distance: against brute force over every pair of texels, against lids whose distance is known in closed form, and
 * the paper's samplers against what they can and cannot do. */
#include "tests/lib/unit.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_distance.h"
#include "image/distance/distance.h"
#include "math/rng.h"
#include "tests/lib/scenes/lid_scene.h"
#include "tests/peers/distance_samplers.h"

enum { W = 61, H = 43 };

static double brute(const uint8_t *m, int x, int y)
{
	double best = INFINITY;
	for (int i = 0; i < W * H; i++)
		if (m[i] == DISTANCE_SKIN)
			best = fmin(best, hypot(i % W - x, i / W - y));
	return best;
}

static void random_mask(uint8_t *m, struct rng *rng, double skin)
{
	for (int i = 0; i < W * H; i++)
		m[i] = rng_uniform(rng) < skin ? DISTANCE_SKIN : rng_uniform(rng) < 0.8 ? DISTANCE_GLOBE : DISTANCE_OTHER;
}

static void test_mask_exact(void **state)
{
	(void)state;
	static uint8_t m[W * H];
	static float out[W * H], near[W * H][2];
	struct rng rng = { 7 };
	static const double share[] = { 0, 0.0005, 0.003, 0.02, 0.3, 1 }, reach[] = { 0.5, 3, 8, 17.3, 200 };
	for (int i = 0; i < 60; i++) {
		random_mask(m, &rng, share[i % COUNT(share)]);
		double far = reach[i % COUNT(reach)];
		distance_band(out, near, &(struct distance_scene){ .width = W, .height = H, .material = m }, far, 0);
		for (int p = 0; p < W * H; p++) {
			if (m[p] != DISTANCE_GLOBE)
				continue;
			double d = brute(m, p % W, p / W);
			if (d > far) {
				assert_true(isinf(out[p]));
				continue;
			}
			assert_float_equal(out[p], d, 1e-4);  // a root in float
			assert_float_equal(hypotf(near[p][0], near[p][1]), d, 1e-4);
		}
	}
}

/* Blocks of skin and of globe on a screen many blocks wide, its width no multiple of theirs: against OpenCV's transform. */
static void test_wide_screen(void **state)
{
	(void)state;
	enum { WIDE = 403, HIGH = 97, ALL = WIDE * HIGH };
	static uint8_t m[ALL], elsewhere[ALL];
	static float out[ALL], exact[ALL];
	struct rng rng = { 11 };
	static const double reach[] = { 2, 8, 31, 500 };
	for (int round = 0; round < 24; round++) {
		memset(m, round % 3 ? DISTANCE_GLOBE : DISTANCE_SKIN, sizeof m);
		for (int k = 0; k < 4 + round; k++) {
			int x0 = rng_below(&rng, WIDE), y0 = rng_below(&rng, HIGH), w = 1 + rng_below(&rng, 90), h = 1 + rng_below(&rng, 40);
			for (int y = y0; y < y0 + h && y < HIGH; y++)
				memset(m + y * WIDE + x0, k % 3, (size_t)(x0 + w < WIDE ? w : WIDE - x0));
		}
		for (int i = 0; i < ALL; i++)
			elsewhere[i] = m[i] != DISTANCE_SKIN;
		assert_true(cv_distance(exact, elsewhere, WIDE, HIGH));
		double far = reach[round % COUNT(reach)];
		for (int i = 0; i < ALL; i++)
			out[i] = -1;
		distance_band(out, 0, &(struct distance_scene){ .width = WIDE, .height = HIGH, .material = m }, far, 0);
		for (int i = 0; i < ALL; i++) {
			if (m[i] != DISTANCE_GLOBE)
				assert_true(out[i] == -1);  // no other texel is written
			else if ((double)exact[i] > far + 1e-4)
				assert_true(isinf(out[i]));
			else if ((double)exact[i] < far - 1e-4)
				assert_float_equal(out[i], exact[i], 1e-4);
		}
	}
}

/* Mean and worst error against the closed form over globe texels within reach. */
static void against_truth(double *mean, double *worst, const struct lid_scene *l, const float *out, double reach)
{
	double sum = 0, n = 0;
	*worst = 0;
	for (int i = 0; i < l->scene.width * l->scene.height; i++) {
		double d = lid_scene_distance(l, i % l->scene.width + 0.5, i / l->scene.width + 0.5);
		if (l->material[i] != DISTANCE_GLOBE || d > reach - 1)
			continue;
		double e = fabs(out[i] - fmax(d, 0));
		sum += e;
		n++;
		*worst = fmax(*worst, e);
	}
	assert_true(n > 100);
	*mean = sum / n;
}

static void test_lids_to_a_fraction_of_a_pixel(void **state)
{
	(void)state;
	for (double lean = -0.15; lean < 0.16; lean += 0.15) {
		struct lid_scene l;
		lid_scene_make(&l, 320, 200, 260, 120, lean);
		float *out = mem_array(320 * 200, sizeof *out);
		double mean, worst;
		distance_band(out, 0, &l.scene, 20, 0);
		against_truth(&mean, &worst, &l, out, 20);
		// Coverage in steps of 1/64 is an edge to about 0.02 px; half of it at a corner is not the corner's place.
		assert_true(mean < 0.02);
		assert_true(worst < 0.4);
		free(out);
		lid_scene_free(&l);
	}
}

/* One plane of globe and skin facing the camera: a distance in mm is one in px times z / f. */
static void test_world_units(void **state)
{
	(void)state;
	static uint8_t m[W * H];
	static float flat[W * H], deep[W * H], z[W * H];
	struct rng rng = { 3 };
	random_mask(m, &rng, 0.01);
	for (int i = 0; i < W * H; i++)
		z[i] = 80;
	struct distance_scene s = { .width = W, .height = H, .material = m };
	distance_band(flat, 0, &s, 12, 0);
	s.depth = z;
	s.focal_px = 400;
	s.center_px[0] = 31;
	s.center_px[1] = 12;
	distance_band(deep, 0, &s, 12 * 80 / 400.0, 0);
	for (int i = 0; i < W * H; i++)
		if (m[i] == DISTANCE_GLOBE && flat[i] < 11.9)
			assert_float_equal(deep[i], flat[i] * 0.2, 1e-4);
}

static void test_threads_change_nothing(void **state)
{
	(void)state;
	struct lid_scene l;
	lid_scene_make(&l, 320, 200, 260, 120, 0.1);
	size_t bytes = 320 * 200 * sizeof(float);
	float *one = mem_new(1, bytes), *more = mem_new(1, bytes);
	int threads = omp_get_max_threads();
	omp_set_num_threads(1);
	distance_band(one, 0, &l.scene, 30, 0);
	omp_set_num_threads(5);
	distance_band(more, 0, &l.scene, 30, 0);
	omp_set_num_threads(threads);
	assert_memory_equal(one, more, bytes);
	free(one);
	free(more);
	lid_scene_free(&l);
}

/* Each of the paper's samplers finds skin that is there, never nearer than it is, and a straight edge to the
 * precision that its steps allow. */
static void test_samplers(void **state)
{
	(void)state;
	struct lid_scene l;
	lid_scene_make(&l, 320, 200, 260, 120, 0);
	float *exact = mem_array(320 * 200, sizeof *exact), *out = mem_array(320 * 200, sizeof *out);
	peer_exact(exact, &l.scene);
	struct distance_line line = { .first = 1, .growth = 1.5, .steps = 16, .turned = false, .seed = 1 };
	for (int method = 0; method < 3; method++) {
		struct distance_cost cost = { 0 };
		if (method == 0)
			distance_equiangular(out, &l.scene, 20, 64, 1, &cost);
		else if (method == 1)
			distance_exponential(out, &l.scene, 20, &line, &cost);
		else
			distance_backtracking(out, &l.scene, 20, 16, &line, &cost);
		double error = 0, n = 0;
		for (int i = 0; i < 320 * 200; i++) {
			if (l.material[i] != DISTANCE_GLOBE || exact[i] > 15)
				continue;
			assert_true(out[i] > exact[i] - 1.5);  // a sample anywhere in a texel finds it
			n++;
			error += isfinite(out[i]) ? fabsf(out[i] - exact[i]) : 20;
		}
		assert_true(error / n < 2.5);
		assert_true(cost.reads > cost.texels && cost.texels > 1000);
	}
	free(exact);
	free(out);
	lid_scene_free(&l);
}

static void test_peers_agree(void **state)
{
	(void)state;
	static uint8_t m[W * H];
	static float exact[W * H], jump[W * H];
	struct rng rng = { 5 };
	random_mask(m, &rng, 0.02);
	struct distance_scene s = { .width = W, .height = H, .material = m };
	peer_exact(exact, &s);
	peer_jump(jump, &s, 0);
	int wrong = 0;
	for (int i = 0; i < W * H; i++) {
		assert_float_equal(exact[i], brute(m, i % W, i / W), 1e-4);
		wrong += fabsf(jump[i] - exact[i]) > 1e-3f;
	}
	assert_true(wrong < W * H / 100);  // jump flooding is known not to be exact
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_mask_exact),
		cmocka_unit_test(test_wide_screen),
		cmocka_unit_test(test_lids_to_a_fraction_of_a_pixel),
		cmocka_unit_test(test_world_units),
		cmocka_unit_test(test_threads_change_nothing),
		cmocka_unit_test(test_samplers),
		cmocka_unit_test(test_peers_agree),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
