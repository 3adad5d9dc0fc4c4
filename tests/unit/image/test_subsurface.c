/* subsurface: energy, the profile itself from a point of light, gaps in depth, threads. */
#include "tests/lib/unit.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/subsurface/subsurface.h"
#include "math/rng.h"
#include "tests/peers/subsurface_separable.h"

enum { W = 203, H = 157, N = W * H };

static struct picture {
	float rgb[3][N], depth[N];
} *fresh(double light)
{
	struct picture *p = mem_new(1, sizeof *p);
	for (int i = 0; i < N; i++) {
		p->depth[i] = 900;
		for (int c = 0; c < 3; c++)
			p->rgb[c][i] = (float)light;
	}
	return p;
}

static void spread(struct picture *p, double px_per_mm, int taps)
{
	struct subsurface_profile skin = subsurface_skin(1.67);
	struct subsurface_room room = { 0 };
	struct subsurface_picture of = { W, H, { p->rgb[0], p->rgb[1], p->rgb[2] }, p->depth, px_per_mm };
	taps ? subsurface_separable(&of, &skin, taps, &room) : subsurface_spread(&of, &skin, &room);
	subsurface_room_free(&room);
}

static void even_light_stays_even(void **state)
{
	(void)state;
	const double scale[] = { 0.3, 1, 4, 9, 20 };
	for (int k = 0; k < COUNT(scale); k++)
		for (int taps = 0; taps <= 17; taps += 17) {
			struct picture *p = fresh(0.7);
			struct rng rng = { 5 };
			for (int i = 0; i < N; i++)  // on any surface, with holes
				p->depth[i] = rng_uniform(&rng) < 0.1 ? 0 : (float)(900 + 0.02 * (i % W) + 5 * rng_uniform(&rng));
			spread(p, scale[k], taps);
			for (int i = 0; i < N; i++)
				for (int c = 0; c < 3; c++)
					if (p->depth[i] > 0 && !(fabsf(p->rgb[c][i] - 0.7f) < 2e-4f))
						fail_msg("%g px/mm, %d taps: pixel %d has %g", scale[k], taps, i, (double)p->rgb[c][i]);
			free(p);
		}
}

/* A straight edge of light: what comes out is the profile integrated to the edge, a sum of error functions. */
static void an_edge_is_the_profiles_integral(void **state)
{
	(void)state;
	const double px_per_mm = 6;
	struct subsurface_profile skin = subsurface_skin(1.67);
	for (int upright = 0; upright < 2; upright++) {
		struct picture *p = fresh(0);
		for (int i = 0; i < N; i++)
			for (int c = 0; c < 3; c++)
				p->rgb[c][i] = (upright ? i % W >= W / 2 : i / W >= H / 2) ? 1 : 0;
		spread(p, px_per_mm, 0);
		for (int k = 40; k < (upright ? W : H) - 40; k++) {
			int i = upright ? H / 2 * W + k : k * W + W / 2;
			double mm = (k + 0.5 - (upright ? W / 2 : H / 2)) / px_per_mm;
			for (int c = 0; c < 3; c++) {
				double truth = 0;
				for (int j = 0; j < skin.n; j++)
					truth += skin.weight[j][c] * 0.5 * (1 + erf(mm / sqrt(2 * skin.variance[j])));
				// The narrowest Gaussian is below a pixel; taps end at three sigma; levels are interpolated.
				double wide = fabs(mm) < 0.4 ? 0.07 : 0.015;
				if (!(fabs((double)p->rgb[c][i] - truth) < wide))
					fail_msg("%g mm from the edge, channel %d: %g, not %g", mm, c, (double)p->rgb[c][i], truth);
			}
		}
		free(p);
	}
}

static void red_goes_as_far_as_asked(void **state)
{
	(void)state;
	for (double mm = 0.8; mm < 3; mm += 0.7) {
		struct subsurface_profile skin = subsurface_skin(mm);
		double mean[3] = { 0 }, all[3] = { 0 };
		for (int i = 0; i < skin.n; i++)
			for (int c = 0; c < 3; c++) {
				mean[c] += 2 * skin.weight[i][c] * skin.variance[i];
				all[c] += skin.weight[i][c];
			}
		NEAR(sqrt(mean[0]), mm, 1e-12);
		for (int c = 0; c < 3; c++)
			NEAR(all[c], 1, 1e-9);
		assert_true(mean[1] < 0.2 * mean[0] && mean[2] < mean[1]);
	}
}

static void light_crosses_no_gap(void **state)
{
	(void)state;
	struct picture *p = fresh(0);
	for (int i = 0; i < N; i++) {  // the right half 40 mm nearer and lit; holes carry light that counts for nothing
		bool right = i % W >= W / 2, hole = i / W > H - 30;
		p->depth[i] = hole ? 0 : right ? 860 : 900;
		for (int c = 0; c < 3; c++)
			p->rgb[c][i] = hole ? 50 : right ? 1 : 0;
	}
	spread(p, 6, 0);
	for (int i = 0; i < N; i++)
		for (int c = 0; c < 3; c++) {
			float want = p->depth[i] > 0 ? (i % W >= W / 2 ? 1 : 0) : 50;
			// A thousandth is let through where all four texels below lie elsewhere.
			if (!(fabsf(p->rgb[c][i] - want) < 2e-3f))
				fail_msg("pixel %d, %d: %g, not %g", i % W, i / W, (double)p->rgb[c][i], (double)want);
		}
	free(p);
}

/* Light and a surface with a step, holes and slopes, of any size; what n threads make of it. */
static float *spread_by(int threads, int width, int height, double px_per_mm)
{
	size_t n = (size_t)width * (size_t)height;
	float *px = mem_array(4 * n, sizeof *px);
	struct rng rng = { 9 };
	struct subsurface_profile skin = subsurface_skin(1.67);
	struct subsurface_room room = { 0 };
	for (size_t i = 0; i < n; i++) {
		int x = (int)(i % (size_t)width), y = (int)(i / (size_t)width);
		for (size_t c = 0; c < 3; c++)
			px[c * n + i] = (float)rng_uniform(&rng);
		px[3 * n + i] = rng_uniform(&rng) < 0.01 ? 0 : (float)(900 + (x > y ? 5 : 0) + 0.3 * y / px_per_mm);
	}
	omp_set_num_threads(threads);
	subsurface_spread(&(struct subsurface_picture){ width, height, { px, px + n, px + 2 * n }, px + 3 * n, px_per_mm }, &skin, &room);
	subsurface_room_free(&room);
	return px;
}

static void threads_change_nothing(void **state)
{
	(void)state;
	const int sizes[][2] = { { W, H }, { 1, 1 }, { 1, 37 }, { 41, 1 }, { 2, 3 }, { 64, 33 }, { 131, 66 } };
	const double scale[] = { 0.2, 1, 4, 7, 20 };
	int threads = omp_get_max_threads();
	for (int i = 0; i < COUNT(sizes); i++)
		for (int k = 0; k < COUNT(scale); k++) {
			int width = sizes[i][0], height = sizes[i][1];
			float *one = spread_by(1, width, height, scale[k]), *more = spread_by(5, width, height, scale[k]);
			assert_memory_equal(one, more, (size_t)(4 * width * height) * sizeof *one);
			for (int px = 0; px < 3 * width * height; px++)
				assert_true(one[px] >= 0 && one[px] <= 1);  // a mean of what there was
			free(one);
			free(more);
		}
	omp_set_num_threads(threads);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(even_light_stays_even),
		cmocka_unit_test(an_edge_is_the_profiles_integral),
		cmocka_unit_test(red_goes_as_far_as_asked),
		cmocka_unit_test(light_crosses_no_gap),
		cmocka_unit_test(threads_change_nothing),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
