/* limbus: rendered captures with truth, synthetic eyes, and pictures that must be refused. */
#include "base/mem.h"
#include "limbus/record.h"
#include "limbus/trial.h"
#include "math/ellipse_fit.h"
#include "math/rng.h"
#include "math/vec.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/truth/truth.h"
#include "tests/lib/unit.h"

static const double DEG = M_PI / 180;

/* Largest of the distance of the centres and the differences of the semi-axes, px. */
static double ellipse_error(const struct ellipse *a, const struct ellipse *b)
{
	return fmax(hypot(a->cx - b->cx, a->cy - b->cy), fmax(fabs(a->a - b->a), fabs(a->b - b->b)));
}

static double axis_error(const struct pose *pose, const double truth[4][4])
{
	double dot = 0;
	for (int i = 0; i < 3; i++)
		dot += pose->cam_from_eye[i][2] * truth[i][2];
	return acos(fmin(dot, 1));
}

static struct pose pose_from(const struct limbus_found *found, const struct photo *photo, const struct truth *truth)
{
	struct limbus_record *record = mem_new(1, sizeof *record);
	struct pose pose;
	struct err err = { 0 };
	limbus_record_fill(record, found, photo);
	record->view.camera = (struct camera){ .focal_px = truth->focal_px, .source = CAMERA_CONF,
		                               .center_px = { truth->center_px[0], truth->center_px[1] } };
	assert_true(limbus_pose(&pose, &record->view, &truth->eye, &pose_defaults, &err));
	free(record);
	return pose;
}

static void test_captures(void **state)
{
	(void)state;
	char *dirs[64];
	int n = truth_captures(dirs, 64);
	if (n == 0) {
		print_message("no rendered captures here: skipped\n");
		skip();
	}
	struct limbus_found *found = mem_new(1, sizeof *found);
	for (; SANITISED && n > 3; n--)
		free(dirs[n - 1]);
	for (int i = 0; i < n; i++) {
		struct truth truth;
		struct photo photo = { 0 };
		struct err err = { 0 };
		assert_true(truth_load(&truth, dirs[i], &err));
		assert_true(photo_load(&photo, truth.photo, 100, &err));
		limbus_find(found, &photo, 0, &limbus_defaults);
		if (!found->ok)
			fail_msg("%s: %s", truth.name, found->reason);
		double error = ellipse_error(&found->limbus.e, &truth.limbus);
		struct pose pose = pose_from(found, &photo, &truth);
		double axis = axis_error(&pose, truth.cam_from_eye) / DEG;
		print_message("%-22s ellipse %.3f px, axis %.3f deg, seen %.2f (truth %.2f)\n", truth.name, error, axis,
		              found->limbus.coverage, 1 - truth.covered);
		/* the project's bars: worst 1.5 px, worst 2 degrees; the two-fold choice must be right for the latter */
		assert_true(error < 1.5);
		assert_true(axis < 2);
		/* the visible share, as an artist would call it */
		assert_true(fabs(found->limbus.coverage - (1 - truth.covered)) < 0.35);
		photo_free(&photo);
		free(dirs[i]);
	}
	free(found);
}

static void test_synthetic(void **state)
{
	(void)state;
	struct limbus_found *found = mem_new(1, sizeof *found);
	struct limbus_conf rough = limbus_defaults;
	rough.tolerance = 2 * LIMBUS_RIGHT;
	int close = 0, right = 0, wrong = 0, rougher = 0, n = 0;
	for (int i = SANITISED ? 40 : 0; i < SYNTH_GRID * 3 / SYNTH_LEVELS; i += SANITISED ? 80 : 8, n++) {  // occlusion 0, 15 and 30 %
		struct synth_eye eye = synth_eye_grid(i + i / 8 % 6);  // all colours
		struct synth_truth truth;
		struct photo photo = synth_eye_render(&eye, &truth);
		limbus_find(found, &photo, 0, &limbus_defaults);
		double error = ellipse_error(&found->limbus.e, &truth.limbus) / truth.limbus.a;
		close += found->ok && error < 0.01;
		right += found->ok && error < LIMBUS_RIGHT;
		wrong += found->ok && error >= LIMBUS_RIGHT;
		const double gross = found->posterior.gross;
		limbus_find(found, &photo, 0, &rough);
		error = ellipse_error(&found->limbus.e, &truth.limbus) / truth.limbus.a;
		rougher += found->ok && error < rough.tolerance;
		assert_true(found->posterior.gross < gross + 0.02);  // who allows more is surer
		assert_true(!found->ok || error < rough.tolerance);
		photo_free(&photo);
	}
	print_message("%d synthetic eyes: %d within 1 %%, %d within 2 %%, %d wrong\n", n, close, right, wrong);
	/* The whole grid, and what is missed on it, is bench_limbus'. These irises have little pattern: some pass for painted ones. */
	assert_true(right >= 0.6 * n);
	assert_true(close >= 0.5 * n);
	assert_int_equal(wrong, 0);
	assert_true(rougher >= right);
	free(found);
}

/* A ring light mirrored within the pupil, as bright as paper. */
static void mirror_ring(struct photo *photo, const struct ellipse *pupil)
{
	for (int y = 0; y < photo->height; y++)
		for (int x = 0; x < photo->width; x++) {
			const double r = hypot(x + 0.5 - pupil->cx, y + 0.5 - pupil->cy) / pupil->a;
			for (int c = 0; c < 3 && r > 0.55 && r < 0.85; c++)
				photo->rgb[3 * ((long)y * photo->width + x) + c] = 62000;
		}
}

/* The hole of a mirrored ring light is dark, round and sharp, and no pupil. */
static void test_ring_light(void **state)
{
	(void)state;
	struct limbus_found *found = mem_new(1, sizeof *found);
	struct limbus_conf anything = limbus_defaults;
	anything.pupil.brightest = 10;
	enum { EYES = SANITISED ? 1 : 4 };
	int seen = 0, holes = 0;
	for (int i = 0; i < SYNTH_GRID / SYNTH_LEVELS && seen < EYES; i++) {
		struct synth_eye eye = synth_eye_grid(i);
		struct synth_truth truth;
		eye.glints = 0;
		struct photo photo = synth_eye_render(&eye, &truth);
		limbus_find(found, &photo, 0, &limbus_defaults);
		if (found->ok && found->has_pupil) {
			const struct ellipse pupil = found->pupil.e;
			mirror_ring(&photo, &pupil);
			limbus_find(found, &photo, 0, &limbus_defaults);
			assert_true(!found->ok || !found->has_pupil || ellipse_error(&found->pupil.e, &pupil) < 0.2 * pupil.a);
			limbus_find(found, &photo, 0, &anything);
			holes += found->ok && found->has_pupil && found->pupil.e.a < 0.7 * pupil.a;
			seen++;
		}
		photo_free(&photo);
	}
	assert_int_equal(seen, EYES);
	assert_true(SANITISED || holes > 0);
	free(found);
}

static struct photo plain(int width, int height, uint16_t r, uint16_t g, uint16_t b)
{
	struct photo photo = { .width = width, .height = height, .bits = 8 };
	photo.rgb = mem_array(3 * (size_t)width * (size_t)height, sizeof *photo.rgb);
	for (long i = 0; i < (long)width * height; i++) {
		photo.rgb[3 * i] = r;
		photo.rgb[3 * i + 1] = g;
		photo.rgb[3 * i + 2] = b;
	}
	return photo;
}

static void refused(struct photo photo, const char *word)
{
	struct limbus_found *found = mem_new(1, sizeof *found);
	limbus_find(found, &photo, 0, &limbus_defaults);
	if (found->ok)
		fail_msg("found an eye where there is none (%s)", word);
	if (!strstr(found->reason, word))
		fail_msg("reason \"%s\" does not say \"%s\"", found->reason, word);
	free(found);
	photo_free(&photo);
}

static void test_refused(void **state)
{
	(void)state;
	refused(plain(640, 480, 65535, 65535, 65535), "over-exposed");
	refused(plain(640, 480, 300, 300, 300), "under-exposed");
	refused(plain(640, 480, 40000, 30000, 25000), "no eye");
	refused(plain(60, 40, 40000, 30000, 25000), "too small");
	struct photo noise = plain(640, 480, 0, 0, 0);
	struct rng rng = { 3 };
	for (long i = 0; i < 3L * 640 * 480; i++)
		noise.rgb[i] = (uint16_t)rng_bits(&rng);
	refused(noise, "");
	struct synth_truth truth;
	struct synth_eye closed = synth_eye_grid(5);
	closed.occlusion = 0.85;
	refused(synth_eye_render(&closed, &truth), "");
	struct synth_eye cut = synth_eye_grid(7);
	cut.limbus_px = 140;
	cut.center[0] = 60;
	refused(synth_eye_render(&cut, &truth), "");
}

/* Whether each parameter of an ellipse lies between those of the trials of a window, measured in full. */
static bool between(const struct ellipse *e, const struct trial *best, const struct trials *t)
{
	struct rim *rim = mem_new(1, sizeof *rim);
	double q[ELLIPSE_N], low[ELLIPSE_N], high[ELLIPSE_N];
	bool ok = true;
	assert_true(trial_measure(rim, 0, 0, best, t, false));
	ellipse_to_q(low, &rim->e);
	memcpy(high, low, sizeof high);
	for (int i = 0; i < t->n; i++)
		if (t->trial[i].window == best->window && trial_measure(rim, 0, 0, &t->trial[i], t, false)) {
			ellipse_to_q(q, &rim->e);
			for (int k = 0; k < ELLIPSE_N; k++) {
				low[k] = fmin(low[k], q[k]);
				high[k] = fmax(high[k], q[k]);
			}
		}
	free(rim);
	ellipse_to_q(q, e);
	for (int k = 0; k < ELLIPSE_N; k++)
		ok &= q[k] > low[k] - 1e-9 && q[k] < high[k] + 1e-9;
	return ok;
}

/* What is told lies near the likeliest trial, whose odds are told with it, between those that say the same. */
static void test_likeliest(void **state)
{
	(void)state;
	static const int cases[] = { 16, 61, 112 };
	struct limbus_found *found = mem_new(1, sizeof *found);
	int other = 0;
	for (int k = 0; k < COUNT(cases); k++) {
		struct synth_eye eye = synth_eye_grid(cases[k]);
		struct synth_truth truth;
		struct photo photo = synth_eye_render(&eye, &truth);
		struct pyramid pyramid = pyramid_make(&photo);
		struct trials *trials = trials_new(&photo, &pyramid, &limbus_defaults);
		limbus_find_in(found, trials, 0);
		const struct trial *best = &trials->trial[found->posterior.best];
		assert_true(between(&found->limbus.e, best, trials));
		assert_true(ellipse_error(&best->e, &found->limbus.e) < 0.02 * truth.limbus.a);
		other += best->guide != GUIDE_EVIDENCE;
		trials_free(trials);
		pyramid_free(&pyramid);
		photo_free(&photo);
	}
	assert_true(other > 0);
	free(found);
}

/* Of an eye whose strip is made to tell a limbus that is too wide: how far what is measured by either of its trials lies from that, and from the truth; px. */
static void by_wide_strip(double told[2], double measured[2], const struct synth_eye *eye, double wider)
{
	static const enum trial_guide guide[2] = { GUIDE_STRIP, GUIDE_STRIP_FIRST };
	struct rim *rim = mem_new(2, sizeof *rim);
	struct err err = { 0 };
	struct synth_truth truth;
	struct photo photo = synth_eye_render(eye, &truth);
	struct pyramid pyramid = pyramid_make(&photo);
	struct trials *t = trials_new(&photo, &pyramid, &limbus_defaults);
	assert_true(trials_of_place(t, truth.limbus.cx, truth.limbus.cy, truth.limbus.a, &err));
	for (int i = 0; i < t->n_windows; i++)
		t->window[i].told.q[2] *= wider;
	for (int k = 0; k < 2; k++) {
		const struct trial *trial = 0;
		struct ellipse e;
		bool has_pupil;
		for (int i = 0; i < t->n; i++)
			if (t->trial[i].guide == guide[k])
				trial = &t->trial[i];
		assert_true(trial && ellipse_from_q(&e, trial->window->told.q));
		assert_true(trial_measure(rim, rim + 1, &has_pupil, trial, t, true));
		told[k] = ellipse_apart(&rim->e, &e);
		measured[k] = ellipse_apart(&rim->e, &truth.limbus);
	}
	trials_free(t);
	pyramid_free(&pyramid);
	photo_free(&photo);
	free(rim);
}

/* A sharp edge outweighs the strip, however that is weighed; a soft one moves the strip's ellipse less where that comes first. */
static void test_strip_first(void **state)
{
	(void)state;
	double told[2], measured[2];
	struct synth_eye eye = synth_eye_grid(50);
	by_wide_strip(told, measured, &eye, 1.01);
	assert_true(measured[0] < 0.2 && measured[1] < 0.2 && told[1] > 0.8);
	eye.ramp *= 8;
	by_wide_strip(told, measured, &eye, 1.01);
	assert_true(told[1] < 0.3 * told[0]);
}

/* A view of a known pose: the limbus projected point by point, nothing measured. */
static struct pose_view ideal_view(const struct eye *eye, const double cam_from_eye[4][4], double focal_px)
{
	enum { N = 48 };
	struct fit fit = { .camera = { .focal_px = focal_px, .center_px = { 800, 600 }, .source = CAMERA_CONF } };
	struct pose_view view = { .camera = fit.camera };
	double p[N][2];
	memcpy(fit.cam_from_eye, cam_from_eye, sizeof fit.cam_from_eye);
	for (int i = 0; i < N; i++) {
		double t = 2 * M_PI * i / N, r = eye->limbus_radius;
		double P[3] = { r * cos(t), r * eye->limbus_aspect * sin(t), eye_limbus_depth(eye) };
		assert_true(fit_project(p[i], &fit, P));
	}
	assert_true(ellipse_fit_direct(&view.limbus, N, p, 0));
	for (int i = 0; i < ELLIPSE_N; i++)
		view.cov_q[i][i] = 0.01;
	return view;
}

static void test_pose(void **state)
{
	(void)state;
	struct eye eye = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85,
		           .limbus_aspect = 1, .iris_depth = 3.3 };
	for (double aspect = 0.92; aspect < 1.01; aspect += 0.08)
		for (double theta = 8; theta <= 50; theta += 14)
			for (double phi = 0; phi < 360; phi += 75) {
				double z[3] = { sin(theta * DEG) * cos(phi * DEG), sin(theta * DEG) * sin(phi * DEG), cos(theta * DEG) };
				double R[3][3], m[4][4] = { 0 };
				mat_smallest_rotation(R, (double[3]){ 0, 0, 1 }, z);
				for (int i = 0; i < 3; i++)
					memcpy(m[i], R[i], sizeof R[i]);
				m[0][3] = 2;
				m[1][3] = -1;
				m[2][3] = 90;
				m[3][3] = 1;
				eye.limbus_aspect = aspect;
				struct pose_view view = ideal_view(&eye, m, 7000);
				struct pose_conf conf = pose_defaults;
				conf.aspect_mean = aspect;
				struct pose pose;
				struct err err = { 0 };
				assert_true(limbus_pose(&pose, &view, &eye, &conf, &err));
				/* without a pupil the two poses are alike: one of them is the truth. An ellipse of known aspect
				 * may have other poses near the front, so only tilts beyond its own are asked for. */
				double other[4][4], dot = 0;
				memcpy(other, pose.other_cam_from_eye, sizeof other);
				for (int i = 0; i < 3; i++)
					dot += other[i][2] * m[i][2];
				double error = fmin(axis_error(&pose, m), acos(fmin(dot, 1))) / DEG;
				if (theta > 25 || aspect > 0.99)
					assert_true(error < 0.01);
			}
}

/* A head that is not held level: a limbus that is no circle seems tilted, unless its roll is as uncertain as people's. */
static void test_roll(void **state)
{
	(void)state;
	const struct eye eye = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85, .limbus_aspect = 0.925, .iris_depth = 3.3 };
	const double roll = 5 * DEG, m[4][4] = { { cos(roll), -sin(roll), 0, 0 }, { sin(roll), cos(roll), 0, 0 }, { 0, 0, 1, 90 }, { 0, 0, 0, 1 } };
	const struct pose_view view = ideal_view(&eye, m, 7000);
	struct pose_conf conf = pose_defaults;
	struct pose level, turned;
	struct err err = { 0 };
	conf.aspect_mean = eye.limbus_aspect;
	assert_true(limbus_pose(&level, &view, &eye, &conf, &err));
	conf.roll_sigma = 4 * DEG;
	assert_true(limbus_pose(&turned, &view, &eye, &conf, &err));
	// A shape tells the square of the tilt near the front (limbus/rice.h): 0 is far off with a level head, and not with a turned one.
	const double off[2] = { pow(level.theta + level.theta_sigma, 2) - pow(level.theta, 2), pow(turned.theta + turned.theta_sigma, 2) - pow(turned.theta, 2) };
	assert_true(level.theta > 5 * DEG && pow(level.theta, 2) > 10 * off[0]);
	assert_true(pow(turned.theta, 2) < 1.5 * off[1]);
}

/* Linear light is made where it is asked for: there it is the mean over squares of the decoded codes, wherever else was asked before, and profiles
 * across an ellipse ask for all that they see. */
static void test_need(void **state)
{
	(void)state;
	enum { W = 260, H = 190 };
	static const double weight[3] = { 0.5, -0.25, 1 };
	static const double ask[][4] = { { 96.5, 50, 96.5, 50 }, { 60, 20, 140, 31 }, { -50, 150, 300, 400 }, { 0, 0, W, H } };
	struct photo photo = { .width = W, .height = H, .bits = 16, .rgb = mem_array(3 * W * H, sizeof(uint16_t)) };
	struct rng rng = { 17 };
	for (int i = 0; i < 3 * W * H; i++)
		photo.rgb[i] = (uint16_t)rng_below(&rng, 65536);
	for (int k = 1; k <= 3; k++) {
		const struct ellipse e = { 131, 92, 60, 55, 0.4 };
		struct grey g = grey_linear(&photo, &e, 1.4, 60.0 / k, weight);
		for (int a = 0; a < COUNT(ask); a++) {
			grey_need(&g, 1, &ask[a]);
			for (int y = 0; y < g.height; y++)
				for (int x = 0; x < g.width; x++) {
					const double u = g.x0 + (x + 0.5) * k, v = g.y0 + (y + 0.5) * k;
					double sum = 0;
					if (u < ask[a][0] - k || u > ask[a][2] + k || v < ask[a][1] - k || v > ask[a][3] + k)
						continue;
					for (int j = 0; j < k * k; j++)
						for (int c = 0; c < 3; c++)
							sum += weight[c] / (k * k) * linear_from_srgb((float)photo.rgb[3 * (((int)g.y0 + y * k + j / k) * W + (int)g.x0 + x * k + j % k) + c] / 65535.0F);
					NEAR(g.px[y * g.width + x], sum, 2e-6);  // twenty-seven sums of floats
				}
		}
		struct grey few = grey_linear(&photo, &e, 1.4, 60.0 / k, weight);
		struct ring seen = ring_sample(&few, &e, -9, 9, 0.7, 6, W, H), all = ring_sample(&g, &e, -9, 9, 0.7, 6, W, H);
		assert_memory_equal(seen.v, all.v, sizeof *seen.v * ARCS * (size_t)seen.m);
		ring_free(&seen);
		ring_free(&all);
		grey_free(&few);
		grey_free(&g);
	}
	photo_free(&photo);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_need), cmocka_unit_test(test_pose), cmocka_unit_test(test_roll), cmocka_unit_test(test_refused), cmocka_unit_test(test_synthetic), cmocka_unit_test(test_ring_light),
		cmocka_unit_test(test_captures), cmocka_unit_test(test_likeliest), cmocka_unit_test(test_strip_first),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
