/* What eyeballs behind lids tell of a lens, against scenes whose lens is known. */
#include "track/head/lens.h"
#include "tests/lib/unit.h"

enum { EYES = 2, AROUND = 40, LIDS_ALL = EYES * AROUND, ALL = LIDS_ALL + 2 * EYES };
static const double apart = 31, behind = 15, away = 650, focal = 6000, center_mm = 0.3;

/* Lids in a plane that faces the camera, known very well, and eyeballs' centres behind it, known to center_mm each way. Returns how many sights. */
static int see(struct head_sight s[ALL], double weight)
{
	const struct camera camera = { .focal_px = focal, .center_px = { 640, 360 } };
	const double pose[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, away }, { 0, 0, 0, 1 } };
	const double px = center_mm * focal / (away + behind);
	int n = 0;
	for (int e = 0; e < EYES; e++)
		for (int i = 0; i < AROUND; i++) {
			const double a = 2 * M_PI * i / AROUND;
			s[n] = (struct head_sight){ .head = { (e ? -apart : apart) + 14 * cos(a), 5 * sin(a), 0 }, .line = true, .normal = { cos(a), -sin(a) }, .weight = weight };
			assert_true(head_project(s[n].px, &camera, pose, s[n].head));
			n++;
		}
	for (int e = 0; e < EYES; e++)
		for (int k = 0; k < 2; k++) {
			s[n] = (struct head_sight){ .head = { e ? -apart : apart, 0, -behind }, .line = true, .sure = true, .normal = { !k, k }, .weight = 1 / (px * px) };
			assert_true(head_project(s[n].px, &camera, pose, s[n].head));
			n++;
		}
	return n;
}

/* The pose that they have under another lens. */
static void lay(double m[4][4], struct camera *camera, struct head_prior *prior, double told, int n, const struct head_sight *s)
{
	const double start[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, away * told }, { 0, 0, 0, 1 } };
	*camera = (struct camera){ .focal_px = focal * told, .center_px = { 640, 360 } };
	*prior = (struct head_prior){ .sigma = { 0.035, 0.1, INFINITY, INFINITY, INFINITY, INFINITY } };
	memcpy(m, start, sizeof start);
	memcpy(prior->cam_from_head, start, sizeof start);
	assert_true(isfinite(head_pose_fit(m, n, s, camera, INFINITY, prior)));
}

/* A lens told as half or twice what it is: the true one is found, and told rightly its sigma is that of the centres' distance apart, center_mm / sqrt(2) each,
 * over what perspective moves them by, apart * behind / (away + behind). */
static void finds_the_lens(void **state)
{
	(void)state;
	static const double told[] = { 0.5, 0.8, 1, 2 };
	struct head_sight s[ALL];
	const int n = see(s, 100);
	for (int i = 0; i < 4; i++) {
		double m[4][4];
		struct camera camera;
		struct head_prior prior;
		struct head_lens lens;
		lay(m, &camera, &prior, told[i], n, s);
		assert_true(head_lens_fit(&lens, (const double(*)[4])m, n, s, &camera, INFINITY, &prior));
		NEAR(camera.focal_px / lens.share, focal, 0.01 * focal);
		// to second order in behind / away: 2 %
		const double sigma = told[i] * center_mm / sqrt(2) / (apart * behind / (away + behind));
		NEAR(lens.sigma, sigma, 0.05 * sigma);
	}
}

/* Lids alone lie in a plane: they tell next to nothing. */
static void flat_tells_nothing(void **state)
{
	(void)state;
	struct head_sight s[ALL];
	double m[4][4];
	struct camera camera;
	struct head_prior prior;
	struct head_lens lens;
	see(s, 1);
	lay(m, &camera, &prior, 1, LIDS_ALL, s);
	assert_true(!head_lens_fit(&lens, (const double(*)[4])m, LIDS_ALL, s, &camera, INFINITY, &prior) || lens.sigma > 5);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_the_lens),
		cmocka_unit_test(flat_tells_nothing),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
