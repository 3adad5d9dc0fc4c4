/* The eyes that judge the search: their truth against the picture itself, by the half-height crossing of profiles; the same number gives
 * the same picture; where an ellipse lies in an altered photograph, against the picture again. What a refusal promises of them. */
#include "math/stats.h"
#include "tests/lib/unit.h"
#include "tests/lib/unseen/altered.h"
#include "tests/lib/unseen/answer.h"

#include <string.h>

enum { ANGLES = 360, SAMPLES = 49, CLEAN = SANITISED ? 1 : 3, NAMED = SANITISED ? 1 : 4 };
static const double spacing = 0.005, middle = 24;

static double luma(const struct photo *p, double x, double y)
{
	const int i = (int)floor(x), j = (int)floor(y);
	double sum = 0;
	if (i < 0 || j < 0 || i >= p->width || j >= p->height)
		return NAN;
	for (int c = 0; c < 3; c++) {
		const double v = p->rgb[3 * ((long)j * p->width + i) + c] / 65535.0;
		sum += (v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4)) / 3;
	}
	return sum;
}

/* Median offset of the profiles' half-height crossings from the ellipse, of a; NAN where few profiles are a clean dark-to-bright step. */
static double offset(const struct photo *photo, const struct ellipse *e)
{
	double off[ANGLES];
	int n = 0;
	for (int k = 0; k < ANGLES; k++) {
		double v[SAMPLES], in = 0, out = 0, point[2], normal[2];
		for (int j = 0; j < SAMPLES; j++) {
			const double s = 1 + (j - middle) * spacing;
			const struct ellipse scaled = { e->cx, e->cy, s * e->a, s * e->b, e->angle };
			ellipse_point(point, normal, &scaled, k * 2 * M_PI / ANGLES);
			v[j] = luma(photo, point[0], point[1]);
		}
		for (int j = 0; j < 10; j++) {
			in += v[j] / 10;
			out += v[SAMPLES - 1 - j] / 10;
		}
		const double half = (in + out) / 2;
		int crossings = 0;
		for (int j = 10; j < SAMPLES - 10; j++)
			if ((v[j] < half) != (v[j + 1] < half) && ++crossings == 1)
				off[n] = (j + (half - v[j]) / (v[j + 1] - v[j]) - middle) * spacing;
		n += crossings == 1 && out > 2 * in;
	}
	return n > 40 ? stats_median(n, off) : NAN;
}

/* Half-height crossings lie up to 0.05 mm, 0.9 % of a, beside the middle of the ramp; shading and tone curves add to it. */
static void ellipses_lie_on_the_limbus(void **state)
{
	(void)state;
	int clean[2] = { 0 };
	for (int i = 0; i < 300 && (clean[0] < CLEAN || clean[1] < CLEAN); i++) {
		const bool cast = i % 10 >= 7;
		if (clean[cast] >= CLEAN)
			continue;
		struct unseen u = unseen_sized(7, i, 320, 240);
		const struct unseen_eye *eye = &u.eye[0];
		const double off = eye->showing > 0.5 && eye->limbus.a > 50 ? offset(&u.photo, &eye->limbus) : NAN;
		if (!isnan(off)) {
			clean[cast]++;
			assert_true(fabs(off) < 0.015);
		}
		unseen_free(&u);
	}
	assert_int_equal(clean[0], CLEAN);
	assert_int_equal(clean[1], CLEAN);
}

static void a_number_is_a_picture(void **state)
{
	(void)state;
	for (int i = 6; i < 8; i++) {
		struct unseen a = unseen_sized(3, i, 320, 240), b = unseen_sized(3, i, 320, 240), other = unseen_sized(4, i, 320, 240);
		const size_t size = sizeof *a.photo.rgb * 3 * 320 * 240;
		assert_memory_equal(a.photo.rgb, b.photo.rgb, size);
		assert_memory_equal(&a.eye[0].limbus, &b.eye[0].limbus, sizeof a.eye[0].limbus);
		assert_int_not_equal(memcmp(a.photo.rgb, other.photo.rgb, size), 0);
		unseen_free(&a);
		unseen_free(&b);
		unseen_free(&other);
	}
}

/* A dark ellipse on white: every alteration leaves it on its own ellipse. */
static void altered_ellipses_follow(void **state)
{
	(void)state;
	const struct ellipse e = { 170.3, 110.6, 60, 45, 0.4 };
	struct photo photo = { .width = 330, .height = 240, .bits = 8, .rgb = calloc(3 * 330 * 240, sizeof(uint16_t)) };
	for (int y = 0; y < 240; y++)
		for (int x = 0; x < 330; x++) {
			double t;
			const double away = ellipse_distance(&t, &e, (const double[2]){ x + 0.5, y + 0.5 }), share = fmin(fmax(0.5 + away / 4, 0), 1);
			for (int c = 0; c < 3; c++)
				photo.rgb[3 * (y * 330 + x) + c] = (uint16_t)(257 * lround(40 + 150 * share));
		}
	const double before = offset(&photo, &e);
	for (int i = 0; i < ALTERED_ALL; i++) {
		const struct altered how = altered_all(i);
		struct photo after = altered_photo(&photo, &how, &e);
		const struct ellipse there = altered_ellipse(&e, &photo, &how, &e);
		// Half a px of 60 a, where pixels are read without interpolation; a clipped exposure moves the half height.
		const double allowed = how.kind == ALTERED_EXPOSED ? 0.03 : 0.009;
		NEAR(offset(&after, &there), before, allowed);
		photo_free(&after);
	}
	photo_free(&photo);
}

/* A refusal that names a tolerance keeps its word: at that tolerance the same eye is taken, within it. */
static void a_tolerance_that_is_named_is_taken(void **state)
{
	(void)state;
	const double kept = answer_conf()->tolerance;
	int named = 0;
	for (int i = 0; i < 60 && named < NAMED; i++) {
		struct unseen u = unseen_sized(11, i, 640, 480);
		struct answer a;
		answer_ours(&a, &u.photo, u.aspect);
		const double at = a.rough;
		if (at > 0) {
			named++;
			answer_conf()->tolerance = at;
			assert_true(answer_conf()->tolerance > kept);
			answer_ours(&a, &u.photo, u.aspect);
			assert_true(a.ok);
			assert_true(ellipse_apart(&a.e, &answer_meant(&a.e, &u)->limbus) < answer_conf()->tolerance * a.e.a);
			answer_conf()->tolerance = kept;
		}
		unseen_free(&u);
	}
	assert_int_equal(named, NAMED);
}

static void a_verdict_knows_right_from_wrong(void **state)
{
	(void)state;
	struct unseen u = { .n = 2 };
	u.eye[0].limbus = (struct ellipse){ 100, 100, 50, 48, 0 };
	u.eye[1].limbus = (struct ellipse){ 300, 100, 50, 48, 0 };
	const struct ellipse got = { 300.5, 100, 50.2, 48, 1 };
	assert_ptr_equal(answer_meant(&got, &u), &u.eye[1]);
	NEAR(ellipse_apart(&got, &u.eye[1].limbus), 0.5, 1e-12);
	NEAR(ellipse_apart(&got, &(struct ellipse){ 300.5, 100, 49, 48, 0 }), 1.2, 1e-12);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ellipses_lie_on_the_limbus),
		cmocka_unit_test(a_number_is_a_picture),
		cmocka_unit_test(altered_ellipses_follow),
		cmocka_unit_test(a_tolerance_that_is_named_is_taken),
		cmocka_unit_test(a_verdict_knows_right_from_wrong),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
