/* shade: what lids take from the iris below them, on patterns whose light is known; the light falls off by another law than the one that is fitted. */
#include "base/mem.h"
#include "iris/unrefract/shade.h"
#include "math/rng.h"
#include "math/stats.h"
#include "tests/lib/unit.h"

enum { SIZE = 256 };
static const double extent = 6, limbus = 5.85, lid_y = -2.2;  // mm; the lid covers what lies above
static const struct unrefract_conf conf = { .lid_shade = 2.6 };

struct iris { float *log[3], *truth, *t, *weight, *rgb; double lid_t[SHEET_ANGLES]; struct sheet sheet; struct unrefract_survey survey; };

/* Smooth noise of about one standard deviation: sums of waves in random directions, from 0.5 to 3 mm long. */
static double noise(const double wave[40][4], double x, double y)
{
	double sum = 0;
	for (int i = 0; i < 40; i++)
		sum += cos(wave[i][0] * x + wave[i][1] * y + wave[i][2]) * sqrt(2. / 40);
	return sum;
}

/* taken: share of the light at the lid's edge, red, green, blue; it comes back over `length` mm as an exponential does. sector: log by which a quarter of the
 * iris at the side is darker. */
static struct iris iris_new(uint64_t seed, const double taken[3], double length, double sector)
{
	struct iris s = { .sheet = { SIZE, extent, { 0, 0, 2 }, limbus, 0 } };
	struct rng rng = { seed };
	double wave[40][4];
	for (int i = 0; i < 40; i++) {
		const double k = 2 * M_PI / exp(rng_range(&rng, log(0.5), log(3))), turn = rng_range(&rng, 0, 2 * M_PI);
		wave[i][0] = k * cos(turn);
		wave[i][1] = k * sin(turn);
		wave[i][2] = rng_range(&rng, 0, 2 * M_PI);
	}
	const size_t n = SIZE * SIZE;
	for (int c = 0; c < 3; c++)
		s.log[c] = mem_array(n, sizeof(float));
	s.truth = mem_array(3 * n, sizeof(float));
	s.rgb = mem_array(3 * n, sizeof(float));
	s.t = mem_array(n, sizeof(float));
	s.weight = mem_array(n, sizeof(float));
	for (size_t i = 0; i < n; i++) {
		const double x = ((double)(i % SIZE) + 0.5) * 2 * extent / SIZE - extent, y = ((double)(i / SIZE) + 0.5) * 2 * extent / SIZE - extent, d = fmax(y - lid_y, 0);
		s.t[i] = (float)sheet_t(&s.sheet, x, y);
		s.weight[i] = s.t[i] > 0 && s.t[i] < 1 && y > lid_y;
		for (int c = 0; c < 3; c++) {
			const double value = -1.5 - 0.3 * c + 0.4 * cos(3 * (double)s.t[i]) + 0.25 * noise(wave, x, y) - (x > fabs(y) ? sector : 0);
			s.truth[3 * i + c] = (float)value;
			s.log[c][i] = (float)(value + log(1 - taken[c] * exp(-d / length)));
			s.rgb[3 * i + c] = expf(s.log[c][i]);
		}
	}
	for (int a = 0; a < SHEET_ANGLES; a++) {
		double p[2];
		s.lid_t[a] = 1;
		for (int r = 4 * SHEET_RINGS; r > 0; r--) {
			sheet_point(p, &s.sheet, r / (4. * SHEET_RINGS), 2 * M_PI * (a + 0.5) / SHEET_ANGLES);
			if (p[1] > lid_y)
				break;
			s.lid_t[a] = (r - 0.5) / (4. * SHEET_RINGS);
		}
	}
	s.survey = (struct unrefract_survey){ .size = SIZE, .extent = extent, .rgb = s.rgb, .weight = s.weight };
	unrefract_shade(&s.survey, (const float *const *)s.log, s.t, s.lid_t, s.weight, &s.sheet, &conf);
	return s;
}

static void iris_free(struct iris *s)
{
	for (int c = 0; c < 3; c++)
		free(s->log[c]);
	free(s->truth);
	free(s->rgb);
	free(s->t);
	free(s->weight);
	free(s->survey.shade);
}

/* Mean error of the logarithm of one colour, with its sign, from `near` to `far` mm below the lid. */
static double bias(const struct iris *s, int c, double near, double far)
{
	double sum = 0;
	int n = 0;
	for (int i = 0; i < SIZE * SIZE; i++) {
		const double d = (i / SIZE + 0.5) * 2 * extent / SIZE - extent - lid_y;
		if (s->t[i] > 0.12F && s->t[i] < 0.9F && d > near && d < far) {
			sum += (double)(logf(s->rgb[3 * i + c]) - s->truth[3 * i + c]);
			n++;
		}
	}
	return sum / n;
}

static void light_comes_back(void **state)
{
	(void)state;
	for (uint64_t seed = 1; seed <= 6; seed++) {
		struct iris s = iris_new(seed, (const double[3]){ 0.75, 0.7, 0.6 }, 0.9, 0);
		assert_non_null(s.survey.shade);
		for (int c = 0; c < 3; c++) {
			NEAR(bias(&s, c, 0.3, 1), 0, 0.2);   // -0.7 to -0.4 as it was
			NEAR(bias(&s, c, 1, 2), 0, 0.15);    // -0.25 to -0.15
			NEAR(bias(&s, c, 3, 6), 0, 0.02);
		}
		iris_free(&s);
	}
}

/* An iris that no lid shades stays what it is; one of which a side is darker all the way, as few are, mostly. */
static void no_light_no_return(void **state)
{
	(void)state;
	for (uint64_t seed = 11; seed <= 22; seed++) {
		struct iris s = iris_new(seed, (const double[3]){ 0 }, 1, seed % 2 ? 0 : 0.7);
		for (int c = 0; c < 3; c++)
			NEAR(bias(&s, c, 0.3, 2), 0, seed % 2 ? 1e-6 : 0.2);
		iris_free(&s);
	}
}

/* What lies in deep shade counts less, and a texel's colour is given back as its survey's is. */
static void deep_shade_counts_less(void **state)
{
	(void)state;
	struct iris s = iris_new(3, (const double[3]){ 0.85, 0.85, 0.85 }, 1.2, 0);
	assert_non_null(s.survey.shade);
	const int x = SIZE / 2, y = (int)((lid_y + 0.1 + extent) / (2 * extent) * SIZE), i = y * SIZE + x;
	const double mm = 2 * extent / SIZE;
	assert_true(s.t[i] > 0 && s.survey.weight[i] < 0.8F);
	float rgb[3] = { 1, 1, 1 };
	unrefract_unshade(rgb, &s.survey, (const double[2]){ (x + 0.5) * mm - extent, (y + 0.5) * mm - extent });
	for (int c = 0; c < 3; c++)
		NEAR(rgb[c], expf(-s.survey.shade[c * SIZE * SIZE + i]), 1e-5);
	iris_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(light_comes_back), cmocka_unit_test(no_light_no_return), cmocka_unit_test(deep_shade_counts_less) };
	return cmocka_run_group_tests(tests, 0, 0);
}
