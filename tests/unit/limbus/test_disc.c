/* Ellipses in planes of evidence that are drawn by their equations: found again, whatever lids hide, and not where there is none. */
#include "base/mem.h"
#include "limbus/candidates.h"
#include "limbus/disc.h"
#include "tests/lib/unit.h"

enum { W = 96, H = 72 };

struct eye { double x, y, a, ratio, turn, lids; };  // lids: how far they stand from the middle, px

/* Skin, a band of sclera between the lids, iris in the ellipse; blurred by nothing. 2 px of the photograph in one, from (10, 20) on. */
static struct evidence planes_of(const struct eye *eye, int eyes)
{
	struct evidence e = { .width = W, .height = H, .x0 = 10, .y0 = 20, .scale = 2 };
	float *px = mem_new((size_t)EVIDENCE_CLASSES * W * H, sizeof *px);
	for (int c = 0; c < EVIDENCE_CLASSES; c++)
		e.plane[c] = px + c * W * H;
	for (int i = 0; i < W * H; i++) {
		int class = EVIDENCE_SKIN;
		for (int k = 0; k < eyes; k++) {
			const double dx = i % W + 0.5 - eye[k].x, dy = i / W + 0.5 - eye[k].y, u = cos(eye[k].turn) * dx + sin(eye[k].turn) * dy;
			const double v = (cos(eye[k].turn) * dy - sin(eye[k].turn) * dx) / eye[k].ratio;
			if (fabs(dy) < eye[k].lids && fabs(dx) < 2.2 * eye[k].a)
				class = hypot(u, v) < eye[k].a ? EVIDENCE_IRIS : EVIDENCE_SCLERA;
		}
		e.plane[class][i] = 1;
	}
	return e;
}

static void the_ellipse_is_found_again(void **state)
{
	(void)state;
	static const struct eye eyes[] = { { 48, 36, 14, 1, 0, 30 }, { 50.3, 33.6, 12, 0.75, 0.6, 30 }, { 45, 38, 15, 1, 0, 9 }, { 40, 30, 9, 0.9, 1.4, 7 } };
	for (int k = 0; k < COUNT(eyes); k++) {
		const struct eye *eye = &eyes[k];
		struct evidence e = planes_of(eye, 1);
		struct evidence_region r = { e.x0 + 2 * (eye->x + 2), e.y0 + 2 * (eye->y - 2), 2 * 1.2 * eye->a, 0 };
		disc_fit(&r, &e);
		// Half a pixel of the planes; where lids hide all but the middle, its height is loosely known.
		NEAR((r.x - e.x0) / 2, eye->x, 0.5);
		NEAR((r.y - e.y0) / 2, eye->y, eye->lids < eye->a ? 2 : 0.5);
		NEAR(r.radius / 2, eye->a, 0.06 * eye->a);
		assert_true(r.score > 0.7);
		evidence_free(&e);
	}
}

static void without_sclera_or_iris_the_score_is_low(void **state)
{
	(void)state;
	// As wide as its lids: nothing white beside it.
	struct evidence e = planes_of(&(struct eye){ 48, 36, 60, 1, 0, 12 }, 1);
	struct evidence_region r = { e.x0 + 96, e.y0 + 72, 24, 0 };
	disc_fit(&r, &e);
	assert_true(r.score < 0.4);
	evidence_free(&e);
	e = planes_of(0, 0);
	r = (struct evidence_region){ e.x0 + 96, e.y0 + 72, 24, 0 };
	disc_fit(&r, &e);
	NEAR(r.score, 0, 1e-9);
	evidence_free(&e);
}

/* Two small irises and nothing else: both are spots, and candidates where they have pixels enough. */
static void small_ones_are_spots(void **state)
{
	(void)state;
	static const struct eye eyes[] = { { 30, 36, 2.5, 1, 0, 2.2 }, { 62, 36, 2.5, 1, 0, 2.2 } };
	struct evidence e = planes_of(eyes, 2);
	struct evidence_region r[CANDIDATES_MAX];
	const int n = candidates_spots(r, &e);
	assert_int_equal(n, 2);
	for (int k = 0; k < 2; k++) {
		const struct evidence_region *at = r[0].x < r[1].x ? &r[k] : &r[1 - k];
		NEAR((at->x - e.x0) / 2, eyes[k].x, 1);
		NEAR((at->y - e.y0) / 2, eyes[k].y, 1);
		NEAR(at->radius / 2, 2.5, 1.1);
	}
	assert_int_equal(candidates_of(r, &e), 2);
	evidence_free(&e);
}

static void one_place_is_one_candidate(void **state)
{
	(void)state;
	struct evidence_region list[CANDIDATES_MAX] = { { 100, 100, 20, 0.5 } };
	const struct evidence_region more[] = { { 105, 98, 22, 0.6 }, { 300, 100, 20, 0.9 } };
	const int n = candidates_merge(list, 1, more, 2);
	assert_int_equal(n, 2);
	NEAR(list[0].x, 300, 0);
	NEAR(list[1].x, 105, 0);
	NEAR(list[1].score, 0.6 + 0.5 * 0.5 * 0.4, 1e-12);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_ellipse_is_found_again),
		cmocka_unit_test(without_sclera_or_iris_the_score_is_low),
		cmocka_unit_test(small_ones_are_spots),
		cmocka_unit_test(one_place_is_one_candidate),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
