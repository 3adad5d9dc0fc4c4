/* Skin about the rigid head moves as its neighbours do: a plane of points, a linear motion about the head, noise and strays. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "math/rng.h"
#include "track/clip/together.h"

enum { SIDE = 20, POINTS = SIDE * SIDE, STRAY_EVERY = 23 };

static const double focal = 4000, away = 500, step_mm = 2;  // 8 px a mm

struct film {
	struct track_clip clip;
	struct track_subject subject;
	struct track_points points;
	struct track_result result;
	struct track_conf conf;
	double truth[POINTS][2];
};

static void close_film(struct film *f)
{
	track_result_free(&f->result);
	skin_points_free(&f->points.points);
	free(f->points.head);
}

/* noise: px; stray: px that every STRAY_EVERY-th point is off. */
static void open_film(struct film *f, double noise, double stray)
{
	struct rng rng = { 5 };
	*f = (struct film){ .conf = { .own_mm = 0.06, .astray_mm = 0.15 } };
	f->clip.camera = (struct camera){ .focal_px = focal, .center_px = { 640, 360 } };
	const double pose[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, away }, { 0, 0, 0, 1 } };
	memcpy(f->clip.cam_from_head, pose, sizeof pose);
	f->points.n = f->points.points.n = f->result.n_points = POINTS;
	f->points.head = mem_new(POINTS, sizeof *f->points.head);
	f->points.points.at = mem_new(POINTS, sizeof *f->points.points.at);
	f->result.n = 1;
	f->result.lost_at = mem_new(1, sizeof *f->result.lost_at);
	f->result.pose = mem_new(1, sizeof *f->result.pose);
	memcpy(f->result.pose[0], pose, sizeof pose);
	f->result.skin = mem_new(POINTS, sizeof *f->result.skin);
	f->result.skin_model = mem_new(POINTS, sizeof *f->result.skin_model);
	f->result.confidence = mem_new(POINTS, sizeof *f->result.confidence);
	for (int i = 0; i < POINTS; i++) {
		double *head = f->points.head[i], px[2];
		head[0] = step_mm * (i % SIDE - SIDE / 2);
		head[1] = step_mm * (i / SIDE - SIDE / 2);
		assert_true(head_project(px, &f->clip.camera, pose, head));
		memcpy(f->points.points.at[i], px, sizeof px);
		f->truth[i][0] = px[0] + 3 + 0.01 * (px[1] - 360);
		f->truth[i][1] = px[1] - 2;
		for (int c = 0; c < 2; c++)
			f->result.skin[i][c] = (float)(f->truth[i][c] + noise * rng_normal(&rng) + (i % STRAY_EVERY ? 0 : stray));
		f->result.confidence[i] = 1;
	}
	skin_points_join(&f->points.points, 0, 0, 12);
}

static bool at_rim(int i)
{
	return i % SIDE < 2 || i % SIDE >= SIDE - 2 || i / SIDE < 2 || i / SIDE >= SIDE - 2;
}

static double rms_off(const struct film *f)
{
	double sum = 0;
	int n = 0;
	for (int i = 0; i < POINTS; i++)
		if (!at_rim(i)) {
			sum += pow((double)f->result.skin[i][0] - f->truth[i][0], 2) + pow((double)f->result.skin[i][1] - f->truth[i][1], 2);
			n++;
		}
	return sqrt(sum / n);
}

/* Symmetric neighbours of a linear motion have its mean: nothing moves, nothing is doubted. */
static void test_linear_stays(void **state)
{
	(void)state;
	struct film f;
	open_film(&f, 0, 0);
	track_together(&f.result, &f.points, &f.clip, &f.subject, &f.conf);
	NEAR(rms_off(&f), 0, 0.02);
	for (int i = 0; i < POINTS; i++)
		assert_true(at_rim(i) || f.result.confidence[i] > 0.95f);
	close_film(&f);
}

/* Noise of 1 px each way: a mean of 13 has 0.28 of it, of weights that fall to 0.3 at the farthest about 0.33; Wiener's share of the own is small. */
static void test_noise_falls(void **state)
{
	(void)state;
	struct film f;
	open_film(&f, 1, 0);
	const double before = rms_off(&f);
	track_together(&f.result, &f.points, &f.clip, &f.subject, &f.conf);
	assert_true(rms_off(&f) < 0.55 * before);
	close_film(&f);
}

/* Twice astray_mm is 2.4 px here: a point 6 px off is not seen any more, and is put where its neighbours are; those are not. */
static void test_strays_go(void **state)
{
	(void)state;
	struct film f;
	open_film(&f, 0.05, 6);
	track_together(&f.result, &f.points, &f.clip, &f.subject, &f.conf);
	for (int i = 0; i < POINTS; i++) {
		if (at_rim(i))
			continue;
		assert_true((f.result.confidence[i] > 0) == (i % STRAY_EVERY != 0));
		NEAR(f.result.skin[i][0], f.truth[i][0], 0.4);
		NEAR(f.result.skin_model[i][0], f.result.skin[i][0], 1e-3);
	}
	close_film(&f);
}

/* Skin that stands still about the head and is found to 1 px each way: nothing tells a motion there, and what its neighbours' mean has of the noise goes, too. */
static void test_still_stays(void **state)
{
	(void)state;
	struct film f;
	open_film(&f, 1, 0);
	for (int i = 0; i < POINTS; i++)
		for (int c = 0; c < 2; c++) {
			f.result.skin[i][c] -= (float)(f.truth[i][c] - f.points.points.at[i][c]);
			f.truth[i][c] = f.points.points.at[i][c];
		}
	const double before = rms_off(&f);
	track_together(&f.result, &f.points, &f.clip, &f.subject, &f.conf);
	assert_true(rms_off(&f) < 0.25 * before);
	close_film(&f);
}

/* Of one half a sixth of the points is seen, of the other all: seen alone a point is not believed. */
static void test_alone_goes(void **state)
{
	(void)state;
	struct film f;
	open_film(&f, 0.05, 0);
	for (int i = 0; i < POINTS; i++)
		f.result.confidence[i] = i % SIDE < SIDE / 2 && (i % SIDE % 3 || i / SIDE % 2) ? 0 : 1;
	track_together(&f.result, &f.points, &f.clip, &f.subject, &f.conf);
	for (int i = 0; i < POINTS; i++)
		assert_true(at_rim(i) || (i % SIDE >= SIDE / 2 - 4 && i % SIDE < SIDE / 2 + 2) || (f.result.confidence[i] > 0) == (i % SIDE >= SIDE / 2));
	close_film(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_linear_stays), cmocka_unit_test(test_noise_falls), cmocka_unit_test(test_strays_go), cmocka_unit_test(test_still_stays),
		                                cmocka_unit_test(test_alone_goes) };
	return cmocka_run_group_tests(tests, 0, 0);
}
