/* What is filled into an iris that repeats itself every 30 degrees: there the truth lies under the cover. Properties: what was seen stays as
 * it is, weights stay, threads and the side of the cover do not matter. */
#include <omp.h>

#include "base/mem.h"
#include "iris/unrefract/unrefract.h"
#include "tests/lib/unit.h"

enum { SIZE = 320, COVERS = 3 };
static const double extent = 6, limbus = 5.85, pupil = 1.9;
static const struct eye anatomy = { .limbus_radius = 5.85 };

/* Fibres, a darker rim, a brighter collarette; linear. */
static void colour(float rgb[3], double x, double y)
{
	double r = hypot(x, y), phi = atan2(y, x), t = (r - pupil) / (limbus - pupil);
	double fibre = 0.25 * sin(24 * phi + 3 * t) + 0.2 * cos(12 * phi) * sin(9 * t);
	double light = 0.25 * exp(fibre - 2 * (t - 0.3) * (t - 0.3));
	rgb[0] = (float)(light * (1 + 0.3 * t));
	rgb[1] = (float)light;
	rgb[2] = (float)(light * (0.5 - 0.2 * t));
}

/* An upper lid, a lash, a reflection. side -1: on the other side of the iris. */
static bool covered(int which, double side, double x, double y)
{
	y *= side;
	switch (which) {
	case 0: return y < -2.6 + 0.05 * x * x;
	case 1: return fabs(x - 1 - 0.3 * y) < 0.07 && y < -0.5;
	default: return hypot(x + 1.5, y + 3) < 0.9;
	}
}

static struct unrefract_texture iris(int cover, double side)
{
	struct unrefract_texture texture = { .rgbw = image_new(SIZE, SIZE, 4), .extent = extent, .pupil = { 0, 0, pupil } };
	for (int row = 0; row < SIZE; row++)
		for (int col = 0; col < SIZE; col++) {
			double x = (col + 0.5) * 2 * extent / SIZE - extent, y = (row + 0.5) * 2 * extent / SIZE - extent, r = hypot(x, y);
			float *px = image_at(&texture.rgbw, col, row);
			if (r < pupil || r > limbus || covered(cover, side, x, y))
				continue;
			colour(px, x, y);
			px[3] = 1;
		}
	return texture;
}

/* Relative error among the filled texels, away from the margins of pupil and limbus, where the unrolled ring ends. */
static double worst_mean(double *mean, const struct unrefract_texture *texture, int cover, double side)
{
	double sum = 0, worst = 0;
	int n = 0;
	for (int row = 0; row < SIZE; row++)
		for (int col = 0; col < SIZE; col++) {
			double x = (col + 0.5) * 2 * extent / SIZE - extent, y = (row + 0.5) * 2 * extent / SIZE - extent, r = hypot(x, y);
			const float *px = image_at(&texture->rgbw, col, row);
			float want[3];
			colour(want, x, y);
			if (r < pupil + 0.1 || r > limbus - 0.1)
				continue;
			if (!covered(cover, side, x, y)) {
				assert_memory_equal(px, want, sizeof want);
				assert_true(px[3] == 1);
				continue;
			}
			assert_true(px[3] == 0);
			for (int c = 0; c < 3; c++) {
				double e = fabs(log(px[c] / want[c]));
				sum += e;
				worst = fmax(worst, e);
				n++;
			}
		}
	*mean = sum / n;
	return worst;
}

static void the_pattern_goes_on(void **state)
{
	(void)state;
	for (int cover = 0; cover < COVERS; cover++)
		for (double side = -1; side <= 1; side += 2) {
			double mean;
			struct unrefract_texture texture = iris(cover, side);
			unrefract_fill(&texture, &anatomy);
			double worst = worst_mean(&mean, &texture, cover, side);
			print_message("cover %d: %.3f in the mean, %.3f at worst\n", cover, mean, worst);
			// rms of the fibres is 0.2; two interpolations, and turns in whole columns of 0.35 degrees, cost a tenth of it
			assert_true(mean < 0.03);
			assert_true(worst < 0.25);
			image_free(&texture.rgbw);
		}
}

/* Fibres that nowhere repeat: a sum of waves round the iris whose numbers have no common part. */
static double fibres(double phi)
{
	double sum = 0;
	for (int k = 0; k < 24; k++)
		sum += 0.1 * sin((13 + 2 * k) * phi + 2.4 * k * k);
	return sum;
}

/* Correlation of what is filled at a radius, from one angle to the next of the same lag. */
static double alike(const struct unrefract_texture *texture, double r, double from, double to, double lag)
{
	double ab = 0, aa = 0, bb = 0;
	for (double phi = from; phi + lag < to; phi += 0.005) {
		double v[2];
		for (int k = 0; k < 2; k++) {
			const double at = phi + k * lag, mm = 2 * extent / SIZE;
			v[k] = log(image_at(&texture->rgbw, (int)((r * cos(at) + extent) / mm), (int)((r * sin(at) + extent) / mm))[1] / 0.2);
		}
		ab += v[0] * v[1];
		aa += v[0] * v[0];
		bb += v[1] * v[1];
	}
	return ab / sqrt(aa * bb);
}

/* Two thirds are hidden: pieces must be taken more than once, but not one and the same side by side, which shows as spokes. */
static void no_spokes(void **state)
{
	(void)state;
	const double from = -M_PI, to = M_PI / 3;
	struct unrefract_texture texture = { .rgbw = image_new(SIZE, SIZE, 4), .extent = extent, .pupil = { 0, 0, pupil } };
	for (int row = 0; row < SIZE; row++)
		for (int col = 0; col < SIZE; col++) {
			const double x = (col + 0.5) * 2 * extent / SIZE - extent, y = (row + 0.5) * 2 * extent / SIZE - extent, phi = atan2(y, x);
			float *px = image_at(&texture.rgbw, col, row);
			if (hypot(x, y) < pupil || hypot(x, y) > limbus || (phi > from && phi < to))
				continue;
			px[0] = px[1] = px[2] = (float)(0.2 * exp(fibres(phi)));
			px[3] = 1;
		}
	unrefract_fill(&texture, &anatomy);
	double worst = 0;
	for (double lag = 0.17; lag < 0.8; lag += 0.005)
		worst = fmax(worst, alike(&texture, 3.5, from, to, lag));
	print_message("correlation of neighbouring pieces at most %.2f\n", worst);
	assert_true(worst < 0.65);
	image_free(&texture.rgbw);
}

/* A reflection's red fringe, left beside the hole that it made, does not flow into it: nothing that is filled is redder than what an iris shows. */
static void fringes_stay_outside(void **state)
{
	(void)state;
	struct unrefract_texture texture = iris(2, 1);
	float most = 0, filled = 0;
	for (int row = 0; row < SIZE; row++)
		for (int col = 0; col < SIZE; col++) {
			const double x = (col + 0.5) * 2 * extent / SIZE - extent, y = (row + 0.5) * 2 * extent / SIZE - extent, from = hypot(x + 1.5, y + 3);
			float *px = image_at(&texture.rgbw, col, row);
			if (px[3] > 0)
				most = fmaxf(most, px[0]);
			if (from >= 0.9 && from < 0.97 && x > -1.5)
				px[0] *= 12;
		}
	unrefract_fill(&texture, &anatomy);
	for (int row = 0; row < SIZE; row++)
		for (int col = 0; col < SIZE; col++) {
			const double x = (col + 0.5) * 2 * extent / SIZE - extent, y = (row + 0.5) * 2 * extent / SIZE - extent;
			if (hypot(x + 1.5, y + 3) < 0.75)  // nearer to its edge texels are between both
				filled = fmaxf(filled, image_at(&texture.rgbw, col, row)[0]);
		}
	print_message("filled up to %.2f, of an iris of up to %.2f\n", (double)filled, (double)most);
	assert_true(filled < 1.4F * most);  // nine times as much without bounds
	image_free(&texture.rgbw);
}

static void nothing_seen_nothing_filled(void **state)
{
	(void)state;
	struct unrefract_texture texture = { .rgbw = image_new(64, 64, 4), .extent = extent, .pupil = { 0, 0, pupil } };
	unrefract_fill(&texture, &anatomy);
	for (int i = 0; i < 64 * 64 * 4; i++)
		assert_true(texture.rgbw.px[i] == 0);
	image_free(&texture.rgbw);
}

/* A thirtieth of the iris alone is seen: something finite is filled in, and no colour that is nowhere. */
static void little_seen(void **state)
{
	(void)state;
	struct unrefract_texture texture = iris(0, 1);
	for (int row = 0; row < SIZE; row++)
		for (int col = 0; col < SIZE; col++)
			if (row < SIZE / 2 || abs(col - SIZE / 2) > SIZE / 10)
				memset(image_at(&texture.rgbw, col, row), 0, 4 * sizeof(float));
	unrefract_fill(&texture, &anatomy);
	for (int i = 0; i < SIZE * SIZE; i++)
		for (int c = 0; c < 3; c++)
			assert_true(texture.rgbw.px[4 * i + c] >= 0 && texture.rgbw.px[4 * i + c] < 2);
	image_free(&texture.rgbw);
}

static void threads_do_not_matter(void **state)
{
	(void)state;
	int threads = omp_get_max_threads();
	struct unrefract_texture texture[2];
	for (int i = 0; i < 2; i++) {
		omp_set_num_threads(i ? 5 : 1);
		texture[i] = iris(0, 1);
		unrefract_fill(&texture[i], &anatomy);
	}
	omp_set_num_threads(threads);
	assert_memory_equal(texture[0].rgbw.px, texture[1].rgbw.px, sizeof(float) * 4 * SIZE * SIZE);
	image_free(&texture[0].rgbw);
	image_free(&texture[1].rgbw);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(the_pattern_goes_on), cmocka_unit_test(no_spokes), cmocka_unit_test(nothing_seen_nothing_filled), cmocka_unit_test(fringes_stay_outside),
		                            cmocka_unit_test(little_seen), cmocka_unit_test(threads_do_not_matter) };
	return cmocka_run_group_tests(tests, 0, 0);
}
