/* How likely a clip is wrong by all that would differ: Bayes' rule, by states written by hand. */
#include "base/mem.h"
#include "track/clip/agree.h"
#include "track/clip/trust.h"
#include "tests/lib/unit.h"

enum { FRAMES = 40 };
static const double DEGREE = M_PI / 180;

/* Keys with round numbers: right scales of 1, wrong ones of 10. */
static struct track_conf keys(void)
{
	struct track_conf conf = { .wrong_prior = 0.2, .wrong_deg = 3, .trust_odd = 1e-4, .nearest_mm = 362, .eye = { .limbus_radius = 5.85 } };
	for (int i = 0; i < TRUST_EVIDENCES; i++) {
		conf.trust[i][0] = 1;
		conf.trust[i][1] = 10;
	}
	return conf;
}

/* A clip whose eyes converge by 2 degrees and look straight on; skin a pixel off at 10 px/mm. */
struct film {
	struct track_clip clip;
	struct track_subject subject;
	struct track_result result;
};

static void shoot(struct film *film, double higher_deg, double apart_deg, double iris_mm)
{
	*film = (struct film){ .clip = { .camera = { .focal_px = 5000 }, .pose_given = true } };
	struct track_result *r = &film->result;
	film->clip.cam_from_head[2][3] = 500;
	r->pose = mem_new(FRAMES, sizeof *r->pose);
	r->eyes.globe[SIDE_LEFT].center_in_head[0] = 31;
	r->eyes.globe[SIDE_RIGHT].center_in_head[0] = -31;
	r->n = FRAMES;
	r->has_eyes = true;
	r->lost_at = mem_new(FRAMES, sizeof *r->lost_at);
	r->misfit = mem_array(FRAMES, sizeof *r->misfit);
	r->eyes.state = mem_new(FRAMES, sizeof *r->eyes.state);
	for (long f = 0; f < FRAMES; f++) {
		r->misfit[f] = 1;
		r->pose[f][2][3] = 500;
		for (int e = 0; e < SIDES; e++) {
			r->eyes.state[f][e].gaze[0] = DEGREE * (e == SIDE_LEFT ? 0.5 : -0.5) * apart_deg;
			r->eyes.state[f][e].gaze[1] = DEGREE * (e == SIDE_LEFT ? 0.5 : -0.5) * higher_deg;
		}
	}
	for (int e = 0; e < SIDES; e++) {
		r->eyes.globe[e].seen = true;
		r->eyes.globe[e].limbus_radius = 5.85 + iris_mm;
	}
}

static struct track_trust trust_of(double higher_deg, double apart_deg, double iris_mm)
{
	struct film film;
	struct track_trust t;
	const struct track_conf conf = keys();
	shoot(&film, higher_deg, apart_deg, iris_mm);
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	track_result_free(&film.result);
	return t;
}

/* What a clip tells of itself, and Bayes' rule over it. */
static void all_in_order(void **state)
{
	(void)state;
	const struct track_trust t = trust_of(0, -2, 0);
	assert_true(isnan(t.value[TRUST_LAID]) && t.log_odds[TRUST_LAID] == 0);
	NEAR(t.value[TRUST_SKIN], 0.1, 1e-12);
	NEAR(t.value[TRUST_APART], 0, 1e-12);
	// at x = 0 the densities' quotient is 2 (10 (1 - odd) + odd) / (10 + 1)
	NEAR(t.log_odds[TRUST_LEVEL], log(2 * (10 * (1 - 1e-4) + 1e-4) / 11), 1e-12);
	double odds = 4;
	for (int i = 0; i < TRUST_EVIDENCES; i++)
		odds *= exp(t.log_odds[i]);
	NEAR(t.wrong, 1 / (1 + odds), 1e-12);
	assert_true(t.wrong < 0.03);
}

/* Eyes that converge on the camera are as they should be, on what is nearer they are not. */
static void together(void **state)
{
	(void)state;
	const double camera = atan2(62, 500) / DEGREE;
	NEAR(trust_of(0, -0.9 * camera, 0).value[TRUST_APART], 0, 1e-12);
	NEAR(trust_of(0, -camera - 3, 0).value[TRUST_APART], 3, 1e-9);
	NEAR(trust_of(0, 2, 0).value[TRUST_APART], 2, 1e-9);
}

/* Seen from so near as a lens told too short makes it, eyes that converge on the camera squint: what people look at for long is further away. */
static void too_near(void **state)
{
	(void)state;
	struct film film;
	struct track_trust t;
	const struct track_conf conf = keys();
	const double camera = atan2(62, 200) / DEGREE, read = atan2(62, 362) / DEGREE;
	shoot(&film, 0, -camera, 0);
	film.clip.cam_from_head[2][3] = 200;
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.value[TRUST_APART], camera - read, 1e-9);
	assert_true(t.wrong > trust_of(0, 0, 0).wrong);
	// it is the eyes' distance that counts, not that of the mesh's origin behind them
	for (int e = 0; e < SIDES; e++)
		film.result.eyes.globe[e].center_in_head[2] = 100;
	film.clip.cam_from_head[2][2] = -1;
	film.clip.cam_from_head[2][3] = 600;
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.value[TRUST_APART], camera - atan2(62, 500) / DEGREE, 1e-9);
	track_result_free(&film.result);
}

/* Outlines are off by a share of a pixel in a small picture, too: of eyes a fifth as large 0.6 px are no more than that. */
static void a_small_picture(void **state)
{
	(void)state;
	struct film film;
	struct track_conf conf = keys();
	shoot(&film, 0, 0, 0);
	film.clip.info.width = 1280;
	film.clip.pose_refined = true;
	film.clip.pose_px = 0.6;
	film.clip.skin_mm = NAN;
	for (int e = 0; e < SIDES; e++)
		film.subject.opening[e] = (struct eye_opening){ .open = true, .canthus = { { -15, 0, 0 }, { 15, 0, 0 } } };
	// openings of 30 mm at 500 mm: a fifth of 253 px
	film.clip.camera.focal_px = 0.2 * 253 * 500 / 30;
	NEAR(trust_scale(&film.clip, &film.subject), 0.2, 1e-12);
	const double x = 3, odd = 1e-4;
	for (int k = 0; k < 2; k++) {
		conf.outline = k;
		const double right = hypot(1, 5 * k), wrong = hypot(10, 5 * k), n = exp(-0.5 * x * x / (right * right)) / right, m = exp(-0.5 * x * x / (wrong * wrong)) / wrong;
		NEAR(trust_reference(&film.clip, &film.subject, &conf), log(((1 - odd) * n + odd * m) / (0.5 * (n + m))), 1e-9);
		assert_true((trust_reference(&film.clip, &film.subject, &conf) > 0) == k);
	}
	track_result_free(&film.result);
}

/* A millimetre of skin is as large in the picture as the eyes are near, wherever the mesh has its origin: at the eyes, 100 mm behind them, or on the ground. */
static void at_the_eyes_depth(void **state)
{
	(void)state;
	static const double behind[] = { 0, 100, 1600 };
	struct film film;
	struct track_trust t;
	const struct track_conf conf = keys();
	for (int i = 0; i < COUNT(behind); i++) {
		shoot(&film, 0, 0, 0);
		for (int e = 0; e < SIDES; e++)
			film.subject.center[e][2] = behind[i];
		film.subject.opening[SIDE_LEFT] = (struct eye_opening){ .open = true, .center = { 31, 0, behind[i] + 12 } };
		film.subject.opening[SIDE_RIGHT] = (struct eye_opening){ .open = true, .center = { -31, 0, behind[i] + 12 } };
		for (long f = 0; f < FRAMES; f++) {
			film.result.pose[f][2][2] = -1;
			film.result.pose[f][2][3] = 512 + behind[i];
		}
		track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
		NEAR(t.value[TRUST_SKIN], 0.1, 1e-12);
		// a head that comes nearer: a pixel is less of a millimetre there
		for (long f = 0; f < FRAMES; f++)
			film.result.pose[f][2][3] -= 250;
		track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
		NEAR(t.value[TRUST_SKIN], 0.05, 1e-12);
		// where no opening is known, the eyeballs tell it; of one eye alone, that one
		film.subject.opening[SIDE_LEFT].open = film.subject.opening[SIDE_RIGHT].open = false;
		NEAR(track_eyes_depth((const double(*)[4])film.result.pose[0], &film.subject), 262, 1e-12);
		film.subject.center[SIDE_LEFT][2] = NAN;
		film.subject.center[SIDE_RIGHT][2] += 50;
		NEAR(track_eyes_depth((const double(*)[4])film.result.pose[0], &film.subject), 212, 1e-12);
		track_result_free(&film.result);
	}
}

/* One eye alone that laid the mesh on is less sure of it than two, or than one whose centre was told. */
static void by_one_eye(void **state)
{
	(void)state;
	struct film film;
	struct track_trust one, told, given;
	struct track_conf conf = keys();
	conf.wrong_prior_one = 0.5;
	shoot(&film, 0, 0, 0);
	film.clip.pose_given = false;
	film.clip.pose_px = 0;
	film.result.eyes.globe[SIDE_RIGHT].seen = false;
	for (long f = 0; f < FRAMES; f++)
		film.result.eyes.state[f][SIDE_RIGHT].gaze[0] = film.result.eyes.state[f][SIDE_RIGHT].gaze[1] = NAN;
	track_trust(&one, &film.result, &film.clip, &film.subject, &conf);
	film.subject.center_given[SIDE_LEFT] = true;
	track_trust(&told, &film.result, &film.clip, &film.subject, &conf);
	film.subject.center_given[SIDE_LEFT] = false;
	film.clip.pose_given = true;
	track_trust(&given, &film.result, &film.clip, &film.subject, &conf);
	// odds of 1 instead of 4
	NEAR((1 - told.wrong) / told.wrong, 4 * (1 - one.wrong) / one.wrong, 1e-6);
	assert_true(given.wrong < one.wrong);
	track_result_free(&film.result);
}

/* One far off is not outvoted; two a little off weigh together; one a little off does not decide. */
static void weighed_together(void **state)
{
	(void)state;
	assert_true(trust_of(0, 25, 0).wrong > 0.9);
	assert_true(trust_of(3.4, 0, 0).wrong < 0.5 && trust_of(0, 3.4, 0).wrong < 0.5);
	assert_true(trust_of(3.4, 3.4, 0).wrong > 0.5);
	assert_true(trust_of(3.4, 3.4, 3.4).wrong > trust_of(3.4, 3.4, 0).wrong);
	assert_true(trust_of(-3.4, 3.4, 0).wrong > 0.5);
	assert_true(trust_of(1e9, 0, 0).wrong > 0.9 && isfinite(trust_of(1e9, 0, 0).log_odds[TRUST_LEVEL]));
}

/* Gaze that is followed rightly, but may be off by degrees: one standard deviation of 3 degrees of one eye's height means past them in 32 %. */
static void off_by_degrees(void **state)
{
	(void)state;
	struct film film;
	struct track_trust t, none;
	const struct track_conf conf = keys();
	shoot(&film, 0, 0, 0);
	track_trust(&none, &film.result, &film.clip, &film.subject, &conf);
	assert_true(none.far == 0);
	for (long f = 0; f < FRAMES; f++) {
		film.result.eyes.state[f][0].sigma[0] = film.result.eyes.state[f][1].sigma[0] = film.result.eyes.state[f][0].sigma[1] = DEGREE;
		film.result.eyes.state[f][1].sigma[1] = 3 * DEGREE;
	}
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.far, 0.31731, 1e-5);
	NEAR(t.wrong, 1 - (1 - none.wrong) * (1 - 0.31731), 1e-5);
	track_result_free(&film.result);
}

/* Errors that grow with the gaze are judged where it is large: a tenth of the frames at 3 degrees. And without a mesh the irises' size counts by the scale it has there. */
static void off_at_large_gazes(void **state)
{
	(void)state;
	struct film film;
	struct track_trust t;
	struct track_conf conf = keys();
	conf.trust[TRUST_SCALE][0] = 2;
	conf.trust[TRUST_SCALE][1] = 6;
	conf.wrong_alone_deg = 3;
	shoot(&film, 0, 0, 1);
	film.subject.assumed = true;
	for (long f = 0; f < FRAMES; f++)
		for (int e = 0; e < SIDES; e++)
			film.result.eyes.state[f][e].sigma[0] = film.result.eyes.state[f][e].sigma[1] = (f < FRAMES / 10 ? 3 : 0.5) * DEGREE;
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.far, 0.31731, 1e-5);
	assert_true(isnan(t.value[TRUST_IRIS]) && t.log_odds[TRUST_IRIS] == 0);
	NEAR(t.value[TRUST_SCALE], 1, 1e-12);
	// N(1; 2) = exp(-1/8) / 2 against (N(1; 2) + N(1; 6)) / 2
	const double right = exp(-0.125) / 2, wrong = exp(-1 / 72.0) / 6;
	NEAR(t.log_odds[TRUST_SCALE], log(2 * right / (right + wrong)), 1e-3);
	// less is asked for without a mesh: two sigma; with one it is what it was
	conf.wrong_alone_deg = 6;
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.far, 0.0455, 1e-5);
	NEAR(trust_sigma_deg(&film.result), 0.5, 1e-12);
	film.subject.assumed = false;
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.far, 0.31731, 1e-5);
	track_result_free(&film.result);
}

/* Average eyeballs between the corners that hold the head: eyes that look apart by as much as their own standard deviations say are not odd; skin has no say. */
static void held_by_the_eyes(void **state)
{
	(void)state;
	struct film film;
	struct track_trust by_skin, held;
	struct track_conf conf = keys();
	conf.wrong_alone_deg = 60;
	conf.trust[TRUST_APART][0] = 1.5;
	conf.trust[TRUST_APART][1] = 8;
	shoot(&film, 0, 6, 0);
	film.subject.assumed = true;
	for (long f = 0; f < FRAMES; f++)
		for (int e = 0; e < SIDES; e++)
			film.result.eyes.state[f][e].sigma[0] = film.result.eyes.state[f][e].sigma[1] = 6 * DEGREE;
	track_trust(&by_skin, &film.result, &film.clip, &film.subject, &conf);
	film.result.place_mm = 0.3;
	track_trust(&held, &film.result, &film.clip, &film.subject, &conf);
	NEAR(held.value[TRUST_APART], by_skin.value[TRUST_APART], 1e-12);
	// N(x; sqrt(1.5^2 + 2 6^2)) against that and N(x; sqrt(8^2 + 2 6^2))
	const double x = held.value[TRUST_APART], a = sqrt(1.5 * 1.5 + 72), b = sqrt(64 + 72.0), right = exp(-0.5 * x * x / (a * a)) / a, wrong = exp(-0.5 * x * x / (b * b)) / b;
	NEAR(held.log_odds[TRUST_APART], log(2 * right / (right + wrong)), 1e-3);
	assert_true(by_skin.log_odds[TRUST_APART] < 0 && held.log_odds[TRUST_APART] > 0);
	assert_true(isfinite(by_skin.value[TRUST_SKIN]) && isnan(held.value[TRUST_SKIN]));
	// and a face that is like faces speaks for it, one that is not against it; where it was not looked at nothing does
	assert_true(isnan(held.value[TRUST_UNLIKE]) && held.log_odds[TRUST_UNLIKE] == 0);
	for (int k = 0; k < 2; k++) {
		struct track_trust t;
		film.result.unlike = (k ? 4 : 0.5) * DEGREE;
		track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
		NEAR(t.value[TRUST_UNLIKE], k ? 4 : 0.5, 1e-12);
		assert_true(k ? t.wrong > held.wrong : t.wrong < held.wrong);
	}
	track_result_free(&film.result);
}

/* A lens whose perspective is half of what it would be, to a tenth: weighed by itself, whatever else speaks for the clip; and the refusal names its key. */
static void another_lens(void **state)
{
	(void)state;
	struct film film;
	struct err err = { 0 };
	struct track_trust as_told, mistaken;
	struct track_conf conf = keys();
	conf.lens_share[0] = 1e-9;
	conf.lens_share[1] = sqrt(0.99);
	conf.wrong_lens_prior = 0.05;
	conf.wrong_most = 0.2;
	shoot(&film, 0, 0, 0);
	track_trust(&as_told, &film.result, &film.clip, &film.subject, &conf);
	assert_true(as_told.lens == 0);
	film.clip.lens = (struct head_lens){ 1, 0.1 };
	track_trust(&as_told, &film.result, &film.clip, &film.subject, &conf);
	// N(0; 0.1) = 10 against N(0; 1) = 1
	NEAR(as_told.lens, 0.05 / (0.05 + 9.5), 1e-9);
	film.clip.lens.share = 0.5;
	track_trust(&mistaken, &film.result, &film.clip, &film.subject, &conf);
	NEAR(mistaken.lens, 0.05 * exp(-0.125) / (0.05 * exp(-0.125) + 9.5 * exp(-12.5)), 1e-9);
	NEAR(1 - mistaken.wrong, (1 - as_told.wrong) * (1 - mistaken.lens) / (1 - as_told.lens), 1e-9);
	assert_false(track_agrees(&film.result, &film.clip, &film.subject, &conf, &err));
	ERR_HAS(err, "above all for camera.focal_px = 5000");
	ERR_HAS(err, "as a lens of some 10000 px would");
	film.clip.focal_assumed = true;
	track_trust(&mistaken, &film.result, &film.clip, &film.subject, &conf);
	assert_true(mistaken.lens == 0);
	track_result_free(&film.result);
}

/* Nothing known: the prior. */
static void nothing_seen(void **state)
{
	(void)state;
	struct film film = { .clip = { .pose_given = true } };
	struct track_trust t;
	const struct track_conf conf = keys();
	track_trust(&t, &film.result, &film.clip, &film.subject, &conf);
	NEAR(t.wrong, 0.2, 1e-12);
}

/* Nothing known speaks against the clip, nor for it: the refusal blames no evidence, and asks for what a clip without a mesh lacks. */
static void too_little_known(void **state)
{
	(void)state;
	struct film film;
	struct err err = { 0 };
	struct track_conf conf = keys();
	conf.wrong_most = 0.1;
	shoot(&film, 0, 0, 0);
	film.subject.assumed = true;
	for (long f = 0; f < FRAMES; f++) {
		film.result.misfit[f] = NAN;
		for (int e = 0; e < SIDES; e++)
			film.result.eyes.state[f][e].gaze[0] = film.result.eyes.state[f][e].gaze[1] = NAN;
	}
	film.result.eyes.globe[0].seen = film.result.eyes.globe[1].seen = false;
	assert_false(track_agrees(&film.result, &film.clip, &film.subject, &conf, &err));
	assert_non_null(strstr(err.msg, "too little shows that it is right: wrong with a probability of 0.2"));
	assert_non_null(strstr(err.msg, "subject.ply"));
	assert_null(strstr(err.msg, "nan"));
	track_result_free(&film.result);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_in_order),
		cmocka_unit_test(together),
		cmocka_unit_test(too_near),
		cmocka_unit_test(a_small_picture),
		cmocka_unit_test(at_the_eyes_depth),
		cmocka_unit_test(by_one_eye),
		cmocka_unit_test(weighed_together),
		cmocka_unit_test(off_by_degrees), cmocka_unit_test(off_at_large_gazes),
		cmocka_unit_test(held_by_the_eyes),
		cmocka_unit_test(another_lens),
		cmocka_unit_test(nothing_seen),
		cmocka_unit_test(too_little_known),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
