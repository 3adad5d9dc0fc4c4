/* The line of sight against the optical axis. Truth: eyes turned by hand until a line of sight of known kappa meets the camera. */
#include "base/mem.h"
#include "track/clip/kappa.h"
#include "track/gaze/globe.h"
#include "tests/lib/unit.h"

enum { FRAMES = 20, FIRST = 4, LAST = 15 };
static const double DEGREE = M_PI / 180, true_kappa[2] = { 6.2, -0.8 };

/* A head turned by 12 degrees about y and moved; both eyes meet the camera in the frames told, and look aside in the others. */
static void look_at_camera(struct track_result *r, double sigma_deg)
{
	const double c = cos(12 * DEGREE), s = sin(12 * DEGREE), pose[4][4] = { { c, 0, s, 20 }, { 0, -1, 0, -15 }, { s, 0, -c, 600 }, { 0, 0, 0, 1 } };
	*r = (struct track_result){ .n = FRAMES, .has_eyes = true };
	r->lost_at = mem_new(FRAMES, sizeof *r->lost_at);
	r->pose = mem_new(FRAMES, sizeof *r->pose);
	r->eyes.state = mem_new(FRAMES, sizeof *r->eyes.state);
	for (int e = 0; e < SIDES; e++) {
		r->eyes.globe[e] = (struct eye_globe){ .seen = true, .center_in_head = { e == SIDE_LEFT ? 31 : -31, 30, 80 } };
		double want[3], length = 0, gaze[3] = { 0 };
		for (int k = 0; k < 3; k++) {
			want[k] = -r->eyes.globe[e].center_in_head[k];
			for (int i = 0; i < 3; i++)
				want[k] -= pose[i][k] * pose[i][3];
			length += want[k] * want[k];
		}
		const double nose = e == SIDE_LEFT ? -1 : 1, h = nose * true_kappa[0] * DEGREE, v = true_kappa[1] * DEGREE, axis[3] = { sin(h) * cos(v), sin(v), cos(h) * cos(v) };
		// fixed point: turn by what the line of sight misses the camera by
		for (int round = 0; round < 60; round++) {
			double R[3][3], at[3];
			gaze_rotation(R, gaze);
			for (int k = 0; k < 3; k++)
				at[k] = R[k][0] * axis[0] + R[k][1] * axis[1] + R[k][2] * axis[2];
			gaze[0] += atan2(want[0], want[2]) - atan2(at[0], at[2]);
			gaze[1] += asin(want[1] / sqrt(length)) - asin(at[1]);
		}
		for (long f = 0; f < FRAMES; f++) {
			struct eye_state *state = &r->eyes.state[f][e];
			memcpy(r->pose[f], pose, sizeof pose);
			for (int k = 0; k < 2; k++) {
				state->gaze[k] = gaze[k] + (f < FIRST || f > LAST ? 0.2 : 0);
				state->sigma[k] = sigma_deg * DEGREE;
			}
			state->gaze[2] = NAN;
		}
	}
	// a blink and a frame without gaze among them
	r->eyes.state[7][0].blink = BLINK_CLOSED;
	r->eyes.state[7][0].gaze[0] = 1;
	r->eyes.state[9][1].gaze[1] = NAN;
}

static struct track_conf keys(double first, double last)
{
	return (struct track_conf){ .kappa = { 5, 1.5 }, .kappa_sigma = { 1.5, 1 }, .camera_frames = { first, last } };
}

static void from_the_camera(void **state)
{
	(void)state;
	struct track_result r;
	struct err err = { 0 };
	const struct track_conf conf = keys(FIRST, LAST);
	look_at_camera(&r, 0.5);
	assert_true(track_kappa(&r, &conf, &err));
	for (int e = 0; e < SIDES; e++) {
		assert_int_equal(r.kappa.frames[e], LAST - FIRST);
		for (int k = 0; k < 2; k++) {
			const double a = 1 / (0.5 * 0.5), b = 1 / (conf.kappa_sigma[k] * conf.kappa_sigma[k]);
			NEAR(r.kappa.angle[e][k] / DEGREE, (a * true_kappa[k] + b * conf.kappa[k]) / (a + b), 1e-6);
			NEAR(r.kappa.sigma[e][k] / DEGREE, 1 / sqrt(a + b), 1e-9);
		}
	}
	track_result_free(&r);
}

/* The line of sight that the fit leads to meets the camera, where the prior says nothing. */
static void sight_meets_the_camera(void **state)
{
	(void)state;
	struct track_result r;
	struct err err = { 0 };
	struct track_conf conf = keys(FIRST, LAST);
	conf.kappa_sigma[0] = conf.kappa_sigma[1] = 1e4;
	look_at_camera(&r, 0.5);
	assert_true(track_kappa(&r, &conf, &err));
	for (int e = 0; e < SIDES; e++) {
		double sight[2], want[3];
		kappa_sight(sight, r.eyes.state[FIRST][e].gaze, r.kappa.angle[e], e);
		for (int k = 0; k < 3; k++) {
			want[k] = -r.eyes.globe[e].center_in_head[k];
			for (int i = 0; i < 3; i++)
				want[k] -= r.pose[FIRST][i][k] * r.pose[FIRST][i][3];
		}
		NEAR(sight[0], atan2(want[0], want[2]), 1e-6);
		NEAR(sight[1], atan2(want[1], hypot(want[0], want[2])), 1e-6);
	}
	track_result_free(&r);
}

/* Not told: the prior; told, but hardly seen: the prior; no frames of the clip: an error. */
static void otherwise(void **state)
{
	(void)state;
	struct track_result r;
	struct err err = { 0 };
	look_at_camera(&r, 0.5);
	struct track_conf conf = keys(NAN, NAN);
	assert_true(track_kappa(&r, &conf, &err));
	NEAR(r.kappa.angle[0][0] / DEGREE, 5, 1e-12);
	assert_int_equal(r.kappa.frames[0], 0);
	conf = keys(FIRST, FIRST + 2);
	assert_true(track_kappa(&r, &conf, &err));
	NEAR(r.kappa.angle[1][1] / DEGREE, 1.5, 1e-12);
	NEAR(r.kappa.sigma[1][1] / DEGREE, 1, 1e-12);
	static const double bad[][2] = { { 5, 4 }, { 0, FRAMES }, { 1.5, 4 } };
	for (int i = 0; i < 3; i++) {
		conf = keys(bad[i][0], bad[i][1]);
		assert_false(track_kappa(&r, &conf, &err));
		ERR_HAS(err, "track.camera_frames");
		err = (struct err){ 0 };
	}
	track_result_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(from_the_camera),
		cmocka_unit_test(sight_meets_the_camera),
		cmocka_unit_test(otherwise),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
