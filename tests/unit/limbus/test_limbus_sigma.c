/* The sigmas that limbus reports against the errors it makes: 204 noisy renderings of synthetic eyes. */
#include "base/mem.h"
#include "limbus/record.h"
#include "math/rng.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/unit.h"

enum { PARAMS = 6 };  // cx, cy, a, b, angle, theta
enum { EYES = SANITISED ? 12 : 34, NOISES = SANITISED ? 1 : 6 };

static struct photo noisy(const struct photo *clean, double sigma, struct rng *rng)
{
	struct photo photo = *clean;
	const long n = 3L * clean->width * clean->height;
	photo.rgb = mem_array((size_t)n, sizeof *photo.rgb);
	for (long i = 0; i < n; i++) {
		double v = clean->rgb[i] / 257.0 + 255 * sigma * rng_normal(rng);
		photo.rgb[i] = (uint16_t)(257 * lround(fmin(fmax(v, 0), 255)));
	}
	return photo;
}

/* Counts the parameters whose error is within one reported sigma. False: the fit failed. */
static bool judge(int within[PARAMS], const struct photo *photo, const struct synth_eye *eye,
                  const struct synth_truth *truth, struct rim *rim)
{
	struct pyramid pyramid = pyramid_make(photo);
	struct ellipse start = truth->limbus;
	start.cx += 0.01 * start.a;
	start.a *= 1.01;
	bool ok = rim_fit(rim, photo, &pyramid.tint, &start, &limbus_defaults.rim);
	pyramid_free(&pyramid);
	if (!ok)
		return false;
	double sigma[ELLIPSE_N];
	const struct ellipse *e = &rim->e, *t = &truth->limbus;
	ellipse_sigma(sigma, e, rim->cov_q);
	within[0] += fabs(e->cx - t->cx) < sigma[0];
	within[1] += fabs(e->cy - t->cy) < sigma[1];
	within[2] += fabs(e->a - t->a) < sigma[2];
	within[3] += fabs(e->b - t->b) < sigma[3];
	within[4] += fabs(remainder(e->angle - t->angle, M_PI)) < sigma[4];
	struct pose_view view = { .camera = { .focal_px = truth->focal_px, .source = CAMERA_CONF,
		                              .center_px = { eye->width / 2.0, eye->height / 2.0 } }, .limbus = *e };
	memcpy(view.cov_q, rim->cov_q, sizeof view.cov_q);
	struct eye anatomy = { .cornea_radius = SYNTH_CORNEA_R, .cornea_asphericity = 1, .index = SYNTH_INDEX,
		               .limbus_radius = SYNTH_LIMBUS_R, .limbus_aspect = 1, .iris_depth = SYNTH_IRIS_DEPTH };
	struct pose pose;
	struct err err = { 0 };
	ok = limbus_pose(&pose, &view, &anatomy, &pose_defaults, &err);
	within[5] += ok && fabs(pose.theta - eye->theta) < pose.theta_sigma;
	return ok;
}

static void test_sigma(void **state)
{
	(void)state;
	int within[PARAMS] = { 0 }, n = 0;
	struct rim *rim = mem_new(1, sizeof *rim);
	struct rng rng = { 21 };
	for (int i = 0; i < EYES; i++) {
		struct synth_eye eye = synth_eye_grid(i);
		struct synth_truth truth;
		double noise = eye.noise;
		eye.noise = 0;
		eye.theta = 0.2 + 0.45 * i / EYES;  // nearer the front theta has no normal error: its square has
		struct photo clean = synth_eye_render(&eye, &truth);
		for (int k = 0; k < NOISES; k++) {
			struct photo photo = noisy(&clean, noise, &rng);
			n += judge(within, &photo, &eye, &truth, rim);
			photo_free(&photo);
		}
		photo_free(&clean);
	}
	free(rim);
	static const char *const names[PARAMS] = { "cx", "cy", "a", "b", "angle", "theta" };
	double all = 0;
	for (int i = 0; i < PARAMS; i++) {
		print_message("%s: %.0f %% of %d within 1 sigma\n", names[i], 100.0 * within[i] / n, n);
		all += (double)within[i] / n / PARAMS;
	}
	assert_true(n >= 200 * EYES * NOISES / 204);
	/* the bar: 68 +- 8 %; of fewer, what chance adds to it, three times over */
	double bar = NOISES == 6 ? 0.08 : 0.08 + 3 * sqrt(0.68 * 0.32 / n);
	assert_true(fabs(all - 0.68) < bar);
	assert_true(fabs((double)within[5] / n - 0.68) < bar);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_sigma) };
	return cmocka_run_group_tests(tests, 0, 0);
}
