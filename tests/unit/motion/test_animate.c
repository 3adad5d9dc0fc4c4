/* Eyes and lids in motion: the main sequence, minimum jerk, blinks, the reflex, vergence, pursuit, saliency, scripts. */
#include "motion/animate.h"

#include "base/mem.h"
#include "image/saliency.h"
#include "image/saliency_pick.h"
#include "math/stats.h"
#include "math/vec.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

/* config/animate.conf. */
static const struct animate_conf usual = {
	.gaze = { .saccade = { 0.021, 0.0022, 1.65, 0.48, 0.32 }, .latency = { 0.2, 0.03 }, .catch_up = { 0.125, 0.02 },
	          .gain = { 0.95, 0.03 }, .threshold = 0.7, .crossing = { 0.04, 0.18 }, .crossing_lead = 0.125, .pursuit_gain = 0.95, .pursuit_delay = 0.1,
	          .pursuit_tau = 0.06, .pursuit_limit = 80, .vor_gain = 0.97, .vergence_delay = 0.16, .vergence_tau = 0.2,
	          .drift = 0.05, .drift_tau = 0.5, .range = 45, .ipd = 63 },
	.blink = { { 0.1339, 0.1605 }, { 0.02, 2 }, { 34.5895, 3.805 }, 30.7845, 0.0375, 0.00093, 2, 0.008, 1.5 },
	.fps = 60, .duration = NAN, .key_latency = 0, .hold = 1, .blinks = true, .gaze_blink = 33, .beyond = 0.15, .scene_deg = 40,
	.screen = { 1920, 1080 }, .scene_distance = 700, .seed = 1,
};

/* Without chance and drift: what is left is the rule. */
static struct gaze_conf steady(void)
{
	struct gaze_conf c = usual.gaze;
	c.latency[1] = c.catch_up[1] = c.gain[1] = c.drift = 0;
	c.gain[0] = 1;
	return c;
}

static void main_sequence(void **state)
{
	(void)state;
	// Normal ranges of duration (ms) and peak velocity (degrees/s): Bahill, Clark and Stark 1975, Baloh et al. 1975,
	// Bahill, Brockenbrough and Troost 1981, as their curves overlap.
	static const double want[][5] = {
		{ 1, 18, 45, 35, 100 }, { 5, 28, 55, 150, 320 }, { 10, 40, 70, 270, 460 }, { 20, 60, 95, 400, 620 }, { 30, 80, 125, 470, 700 },
	};
	for (int i = 0; i < COUNT(want); i++) {
		struct saccade s;
		saccade_make(&s, want[i][0], &usual.gaze.saccade);
		assert_true(1e3 * s.duration > want[i][1] && 1e3 * s.duration < want[i][2]);
		assert_true(s.peak > want[i][3] && s.peak < want[i][4]);
		// The course has the peak it promises, where it promises it; it grows throughout.
		double peak = 0, when = 0, dt = s.duration / 1000;
		for (int k = 0; k < 1000; k++) {
			double v = s.amplitude * (saccade_at(&s, (k + 1) * dt) - saccade_at(&s, k * dt)) / dt;
			assert_true(v >= 0);
			when = v > peak ? (k + 0.5) / 1000 : when;
			peak = fmax(peak, v);
		}
		NEAR(peak / s.peak, 1, 0.002);  // the table's step
		NEAR(when, 0.48 - 0.16 * (want[i][0] - 1) / 39, 0.01);
		assert_true(saccade_at(&s, 0) == 0 && saccade_at(&s, s.duration) == 1 && saccade_at(&s, 9) == 1);
	}
}

static void closed_forms(void **state)
{
	(void)state;
	// Flash and Hogan: half way at half time, peak speed 15/8 of the mean, still at both ends; the least jerk, 720.
	NEAR(minimum_jerk(0.5), 0.5, 1e-15);
	NEAR((minimum_jerk(0.5 + 1e-5) - minimum_jerk(0.5 - 1e-5)) / 2e-5, 1.875, 1e-8);
	double jerk = 0, h = 1e-3;
	for (double t = h / 2; t < 1; t += h) {
		double d = 60 - 360 * t + 360 * t * t;
		jerk += h * d * d;
		NEAR((minimum_jerk(t + 1e-5) - minimum_jerk(t - 1e-5)) / 2e-5, 30 * t * t * (1 - t) * (1 - t), 1e-8);
	}
	NEAR(jerk, 720, 0.01);
	assert_true(minimum_jerk(-1) == 0 && minimum_jerk(2) == 1);
	// Listing's law against the rotation itself: torsion of a Fick frame is atan2 of what is left, and odd in each angle.
	NEAR(listing_torsion(0, 20), 0, 1e-12);
	NEAR(listing_torsion(-15, 0), 0, 1e-12);
	// Classical false torsion: tan(t / 2) = tan(h / 2) tan(v / 2), its sign by our axes.
	double h20 = tan(10 * M_PI / 180), v30 = tan(15 * M_PI / 180);
	NEAR(fabs(listing_torsion(20, 30)), 2 * atan(h20 * v30) * 180 / M_PI, 1e-10);
	NEAR(listing_torsion(20, 30), -listing_torsion(-20, 30), 1e-10);
}

static void vergence_geometry(void **state)
{
	(void)state;
	double eye[2][3], ahead[2] = { 0, 0 }, aside[2] = { 30, 10 };
	gaze_eyes(eye, ahead, 400, 63);
	NEAR(eye[0][0], -atan(31.5 / 400) * 180 / M_PI, 1e-12);  // the left eye turns towards the nose: to the person's right
	NEAR(eye[1][0], -eye[0][0], 1e-12);
	gaze_eyes(eye, aside, INFINITY, 63);
	for (int e = 0; e < 2; e++) {
		NEAR(eye[e][0], 30, 1e-12);
		NEAR(eye[e][1], 10, 1e-12);
	}
	// Both lines of sight meet in the point.
	gaze_eyes(eye, aside, 300, 63);
	double h = 30 * M_PI / 180, v = 10 * M_PI / 180, p[3] = { 300 * sin(h) * cos(v), 300 * sin(v), 300 * cos(h) * cos(v) };
	for (int e = 0; e < 2; e++) {
		double from[3] = { e ? -31.5 : 31.5, 0, 0 }, to[3], a = eye[e][0] * M_PI / 180, b = eye[e][1] * M_PI / 180;
		double sight[3] = { sin(a) * cos(b), sin(b), cos(a) * cos(b) }, off[3];
		vec_add(to, p, -1, from);
		vec_cross(off, sight, to);
		NEAR(vec_norm(off), 0, 1e-10);
	}
}

struct scene {
	double at, jump[2], speed, head_hz, head_deg, near;
};

static void look(void *ctx, double t, struct gaze_input *in)
{
	const struct scene *s = ctx;
	*in = (struct gaze_input){ .distance = s->near > 0 && t >= s->at ? s->near : INFINITY };
	for (int k = 0; k < 2 && t >= s->at; k++)
		in->target[k] = s->jump[k];
	in->target[0] += t >= s->at ? s->speed * (t - s->at) : 0;
	in->head[0] = s->head_deg * sin(2 * M_PI * s->head_hz * t);
}

static void a_saccade(void **state)
{
	(void)state;
	struct gaze_conf conf = steady();
	struct scene scene = { .at = 0.5, .jump = { 12, -9 } };
	struct gaze_sim *sim = gaze_sim_new(&conf, look, &scene, 1);
	struct gaze_output out;
	int n;
	for (int ms = 0; ms <= 1500; ms++) {
		gaze_sim_at(sim, 1e-3 * ms, &out);
		if (ms <= 698)
			assert_true(out.cyclopean[0] == 0 && !out.in_saccade);
	}
	const struct gaze_saccade *s = gaze_sim_saccades(sim, &n);
	assert_int_equal(n, 1);
	NEAR(s[0].start, 0.7, 0.002);
	NEAR(s[0].amplitude, 15, 1e-9);
	NEAR(s[0].duration, 0.021 + 15 * 0.0022, 1e-12);
	NEAR(out.cyclopean[0], 12, 1e-9);
	NEAR(out.cyclopean[1], -9, 1e-9);
	gaze_sim_free(sim);
	// It falls short, and one correction follows around 125 ms later.
	conf.gain[0] = 0.9;
	sim = gaze_sim_new(&conf, look, &scene, 1);
	gaze_sim_at(sim, 1.5, &out);
	s = gaze_sim_saccades(sim, &n);
	assert_int_equal(n, 2);
	NEAR(s[0].amplitude, 13.5, 1e-9);
	NEAR(s[1].start - s[0].start - s[0].duration, 0.05 + 0.125, 0.005);
	gaze_sim_free(sim);
}

/* The head shakes at 2 Hz: the eyes turn back by the gain, without a saccade's help. */
static void reflex(void **state)
{
	(void)state;
	for (double gain = 0.5; gain <= 1; gain += 0.5) {
		struct gaze_conf conf = steady();
		struct scene scene = { .at = 99, .head_hz = 2, .head_deg = 2 };
		struct gaze_output out;
		double sum = 0, squares = 0;
		conf.vor_gain = gain;
		conf.threshold = 20;  // no saccades
		conf.pursuit_gain = 0;
		struct gaze_sim *sim = gaze_sim_new(&conf, look, &scene, 1);
		for (int ms = 0; ms <= 2000; ms++) {
			double head = 2 * sin(2 * M_PI * 2 * 1e-3 * ms);
			gaze_sim_at(sim, 1e-3 * ms, &out);
			sum += out.cyclopean[0] * head;
			squares += head * head;
		}
		NEAR(-sum / squares, gain, 1e-3);
		gaze_sim_free(sim);
	}
}

/* A ramp: velocity gain as told; a step-ramp that comes back through the line of sight needs no saccade (Rashbass 1961;
 * de Brouwer et al. 2002), one that runs away does. */
static void pursuit(void **state)
{
	(void)state;
	struct gaze_conf conf = steady();
	struct scene ramp = { .at = 0.2, .speed = 15 };
	struct gaze_output a, b;
	int n;
	struct gaze_sim *sim = gaze_sim_new(&conf, look, &ramp, 1);
	gaze_sim_at(sim, 0.299, &a);
	assert_true(a.cyclopean[0] == 0);  // 100 ms late
	double moved = 0, last = 0, counted = 0;
	for (int ms = 1000; ms < 2000; ms++) {
		gaze_sim_at(sim, 1e-3 * ms, &b);
		bool smooth = ms > 1000 && !a.in_saccade && !b.in_saccade;
		moved += smooth ? b.cyclopean[0] - last : 0;
		counted += smooth ? 1e-3 : 0;
		last = b.cyclopean[0];
		a = b;
	}
	NEAR(moved / counted / 15, 0.95, 0.01);
	NEAR(b.cyclopean[0], 15 * 1.8, 1.5);  // kept up with by catch-up saccades
	gaze_sim_saccades(sim, &n);
	assert_true(n >= 1);
	gaze_sim_free(sim);
	struct scene back = { .at = 0.2, .jump = { -3 }, .speed = 15 };
	sim = gaze_sim_new(&conf, look, &back, 1);
	gaze_sim_at(sim, 0.7, &b);
	gaze_sim_saccades(sim, &n);
	gaze_sim_free(sim);
	assert_int_equal(n, 0);
	int away_n;
	struct scene away = { .at = 0.2, .jump = { 3 }, .speed = 15 };
	sim = gaze_sim_new(&conf, look, &away, 1);
	gaze_sim_at(sim, 0.7, &b);
	gaze_sim_saccades(sim, &away_n);
	assert_true(away_n >= 1 && away_n > n);
	gaze_sim_free(sim);
}

static void vergence_dynamics(void **state)
{
	(void)state;
	struct gaze_conf conf = steady();
	struct scene scene = { .at = 0.5, .near = 250 };
	struct gaze_output out;
	struct gaze_sim *sim = gaze_sim_new(&conf, look, &scene, 1);
	double full = 2 * atan(31.5 / 250) * 180 / M_PI;
	gaze_sim_at(sim, 0.655, &out);
	NEAR(out.eye[1][0] - out.eye[0][0], 0, 1e-9);
	gaze_sim_at(sim, 0.66 + 0.2, &out);
	// One time constant on, nearness (not angle) has gone 1 - 1/e of its way.
	NEAR(out.eye[1][0] - out.eye[0][0], 2 * atan(31.5 / 250 * (1 - exp(-1))) * 180 / M_PI, 0.1);
	gaze_sim_at(sim, 3, &out);
	NEAR(out.eye[1][0] - out.eye[0][0], full, 0.01);
	gaze_sim_free(sim);
}

static void blinks(void **state)
{
	(void)state;
	enum { N = 20000 };
	static double f[N], a[N];
	struct rng rng = { 4 };
	double sum = 0, sum2 = 0;
	for (int i = 0; i < N; i++) {
		f[i] = 1 / blink_interval(&rng, &usual.blink);
		a[i] = blink_amplitude(&rng, &usual.blink);
		assert_true(f[i] >= 0.02 && f[i] <= 2 && a[i] > 0);
		sum += f[i];
		sum2 += a[i];
	}
	// Mean of N(mu, s) cut at lo and hi: mu + s (phi(lo) - phi(hi)) / (Phi(hi) - Phi(lo)).
	double mu = 0.1339, s = 0.1605, lo = (0.02 - mu) / s, hi = (2 - mu) / s;
	double phi = (exp(-lo * lo / 2) - exp(-hi * hi / 2)) / sqrt(2 * M_PI), Phi = 0.5 * (erf(hi / M_SQRT2) - erf(lo / M_SQRT2));
	NEAR(sum / N, mu + s * phi / Phi, 4 * s / sqrt(N));
	NEAR(sum2 / N, 34.5895, 4 * 3.805 / sqrt(N));
	struct blink b = blink_make(1, 30.6, &usual.blink);
	NEAR(b.down, 0.066, 0.0005);   // the search-coil study's spontaneous blink
	NEAR(1.875 * 30.6 / b.down, 875, 20);
	assert_true(b.up > b.down && blink_closure(&b, 1) == 0 && blink_closure(&b, blink_end(&b)) == 0);
	NEAR(blink_closure(&b, 1 + b.down + b.hold / 2), 30.6 / 30.7845, 1e-12);
	double fastest_down = 0, fastest_up = 0;
	for (double t = 1; t < blink_end(&b); t += 1e-4) {
		double v = (blink_closure(&b, t + 1e-4) - blink_closure(&b, t)) / 1e-4;
		fastest_down = fmax(fastest_down, v);
		fastest_up = fmax(fastest_up, -v);
	}
	NEAR(fastest_down / fastest_up, 2, 0.01);
	assert_true(blink_make(0, 50, &usual.blink).closure == 1 && blink_make(0, 45, &usual.blink).down > b.down);
}

/* An eye that opens 100 px, its lower lid 20; A: up with the gaze, as everybody's does. */
static struct skin_model small_model(void)
{
	struct skin_model m = { .n_au = 1, .n_points = 2, .n_vertices = 1, .n_lid_pc = 2, .n_skin_pc = 1 };
	skin_model_alloc(&m);
	m.au_names[0] = mem_str("smile");
	for (int e = 0; e < 2; e++) {
		for (int k = 0; k < 2; k++) {
			int at = 5 * e + 3 + k;
			m.closed[at] = 2;
			m.open[at] = k ? 22 : 102;
			m.low[at] = 2;
			m.high[at] = m.open[at];
		}
		memcpy(m.baseline[e][0], (double[]){ 0, 0.01, 0.8 }, sizeof m.baseline[e][0]);
		memcpy(m.baseline[e][1], (double[]){ 0, -0.01, 0.5 }, sizeof m.baseline[e][1]);
	}
	return m;
}

static struct animation keyed(const char *text, const struct skin_model *m, const struct animate_conf *conf)
{
	struct script s;
	struct animation a = { 0 };
	struct err err = { 0 };
	if (!script_read(&s, scratch_text("keys.csv", text), m, &err) || !animate_run(&a, m, 0, &s, 0, conf, &err))
		fail_msg("%s", err.msg);
	script_free(&s);
	return a;
}

/* Lids go with an expression that a script sets, less as it shuts them; recorded lids are what is meant. */
static void expressions_take_lids(void **state)
{
	(void)state;
	struct skin_model m = small_model();
	struct animate_conf conf = usual;
	struct script recorded;
	struct err err = { 0 };
	conf.gaze = steady();
	conf.blinks = false;
	memcpy(m.expression[0], (double[]){ -0.1, -0.3, -0.2, 0.05 }, sizeof m.expression[0]);
	struct animation a = keyed("time_s,horizontal_deg,vertical_deg,smile,openness\n0,0,0,1,1\n1,0,0,1,0.5\n2,0,0,0.5,1\n3,0,0,1,0\n", &m, &conf);
	static const double want[4][4] = { { 0.7, 0.2, 0.6, 0.55 }, { 0.35, 0.1, 0.3, 0.275 }, { 0.75, 0.35, 0.7, 0.525 }, { 0 } };
	for (int s = 0; s < 4; s++)
		for (int k = 0; k < 4; k++)
			NEAR(a.controls[60 * s * a.n_inputs + k / 2 * 5 + 3 + k % 2], want[s][k], 1e-9);
	animation_free(&a);
	// The left eye's lids are told, the right one's are not.
	if (!script_read(&recorded, scratch_text("gaze.csv", "time_s,g1_deg,g2_deg,g4_px,g5_px,au1\n0,0,0,60,12,1\n1,0,0,60,12,1\n"), &m, &err)
	    || !animate_run(&a, &m, &recorded, 0, 0, &conf, &err))
		fail_msg("%s", err.msg);
	NEAR(a.g[3], 60, 1e-12);
	NEAR(a.g[4], 12, 1e-12);
	NEAR(a.controls[8], 0.6, 1e-12);
	animation_free(&a);
	script_free(&recorded);
	skin_model_free(&m);
}

static void keyframes(void **state)
{
	(void)state;
	struct skin_model m = small_model();
	struct animate_conf conf = usual;
	conf.gaze = steady();
	conf.blinks = false;
	struct animation a = keyed("time_s,horizontal_deg,vertical_deg,blink,smile,openness\n0,0,0,,0,1\n1,10,5,,1,\n2,0,0,1,0,0.5\n",
	                           &m, &conf);
	assert_int_equal(a.n, 181);  // 2 s, the last key held for one, both ends
	const double *half = a.g + 30 * a.n_inputs, *one = a.g + 90 * a.n_inputs;
	NEAR(half[10], 0.5, 1e-12);  // minimum jerk, half way
	NEAR(one[0], 10, 1e-9);
	NEAR(one[1], 5, 1e-9);
	// Equation 3.11 at that gaze, c of minimum jerk three quarters of the way from 1 to 0.5.
	double c = 1 - 0.5 * minimum_jerk(0.75);
	NEAR(a.controls[90 * a.n_inputs + 3], c * 0.85, 1e-9);
	NEAR(one[3], 2 + 100 * c * 0.85, 1e-9);
	NEAR(one[4], 2 + 20 * c * 0.45, 1e-9);
	// The blink begins with its key: shut (0.5 open to 0) within 66 ms.
	assert_int_equal(a.n_blinks, 1);
	double shut = 1;
	for (int i = 120; i < 140; i++)
		shut = fmin(shut, a.controls[i * a.n_inputs + 3]);
	NEAR(shut, 0, 0.02);
	assert_int_equal(a.n_saccades, 2);
	NEAR(a.saccades[0].start, 1, 0.0021);  // keys have no latency
	animation_free(&a);
	skin_model_free(&m);
}

/* One eye's lids shut and open again, the other's stay as they are. */
static void winks(void **state)
{
	(void)state;
	struct skin_model m = small_model();
	struct animate_conf conf = usual;
	conf.gaze = steady();
	conf.blinks = false;
	struct animation a = keyed("time_s,wink_left,wink_right\n0,0,0\n1,1,\n2,0,0.5\n", &m, &conf);
	const double *open = a.controls, *shut = a.controls + 60 * a.n_inputs, *right = a.controls + 120 * a.n_inputs;
	NEAR(shut[3], 0, 1e-9);
	NEAR(shut[4], 0, 1e-9);
	NEAR(shut[8], open[8] * (1 - 0.5 * minimum_jerk(0.5)), 1e-9);
	NEAR(right[3], open[3], 1e-9);
	NEAR(right[9], 0.5 * open[9], 1e-9);
	animation_free(&a);
	skin_model_free(&m);
}

static void deterministic(void **state)
{
	(void)state;
	struct skin_model m = small_model();
	struct animate_conf conf = usual;
	conf.duration = 60;
	const char *text = "time_s,horizontal_deg,vertical_deg\n0,0,0\n5,20,5\n9,-20,0\n30,15,-10\n";
	struct animation a = keyed(text, &m, &conf), b = keyed(text, &m, &conf);
	conf.seed = 2;
	struct animation c = keyed(text, &m, &conf);
	assert_memory_equal(a.g, b.g, (size_t)(a.n * a.n_inputs) * sizeof *a.g);
	assert_true(memcmp(a.g, c.g, (size_t)(a.n * a.n_inputs) * sizeof *a.g));
	// Spontaneous blinks of a minute: never two at once, none negative, about as many as 60 s over the mean interval.
	assert_true(a.n_blinks >= 2 && a.n_blinks <= 40);
	for (int i = 1; i < a.n_blinks; i++)
		assert_true(a.blinks[i].start >= blink_end(&a.blinks[i - 1]));
	// Every saccade on the main sequence.
	for (int i = 0; i < a.n_saccades; i++)
		NEAR(a.saccades[i].peak * a.saccades[i].duration / a.saccades[i].amplitude, 1.65, 1e-9);
	for (long i = 0; i < a.n * a.n_inputs; i++)
		assert_true(isfinite(a.g[i]));
	animation_free(&a);
	animation_free(&b);
	animation_free(&c);
	skin_model_free(&m);
}

/* Gaze that was recorded comes out as it went in; gaps are bridged; lids that were recorded are kept. */
static void recorded(void **state)
{
	(void)state;
	struct skin_model m = small_model();
	struct script s;
	struct animation a;
	struct err err = { 0 };
	struct animate_conf conf = usual;
	conf.fps = 10;
	scratch_text("gaze.csv", "frame,time_s,g1_deg,g2_deg,g3_deg,g4_px,g5_px,g6_deg,g7_deg,g8_deg,g9_px,g10_px,au1\n"
	                         "0,0,1,2,0.5,50,10,3,2,,60,12,0\n1,0.1,,,,5,3,,,,,,\n2,0.2,3,6,,50,10,5,6,,60,12,1\n");
	assert_true(script_read(&s, scratch_path("gaze.csv"), &m, &err));
	assert_true(s.kind == SCRIPT_RECORDED && s.has_apertures);
	assert_true(animate_run(&a, &m, &s, 0, 0, &conf, &err));
	assert_int_equal(a.n, 3);
	NEAR(a.g[0], 1, 1e-12);
	NEAR(a.g[11 + 1], 4, 1e-12);
	NEAR(a.g[11 + 3], 5, 1e-12);
	NEAR(a.g[11 + 8], 60, 1e-12);
	NEAR(a.g[11 + 10], 0.5, 1e-12);
	NEAR(a.g[2], 0.5, 1e-12);
	NEAR(a.g[7], listing_torsion(3, 2), 1e-12);
	assert_int_equal(a.n_blinks, 0);
	animation_free(&a);
	script_free(&s);
	// An eye tracker's points on a screen: the middle is straight ahead, its right edge half the width to the right.
	scratch_text("screen.csv", "time_s,x_px,y_px\n0,960,540\n0.5,960,540\n0.501,1920,540\n2,1920,540\n");
	assert_true(script_read(&s, scratch_path("screen.csv"), &m, &err) && s.kind == SCRIPT_SCREEN);
	conf.gaze = steady();
	conf.blinks = false;
	assert_true(animate_run(&a, &m, &s, 0, 0, &conf, &err));
	NEAR((a.g[0] + a.g[5]) / 2, 0, 1e-9);
	NEAR((a.g[11 * 20] + a.g[11 * 20 + 5]) / 2, -20, 0.3);  // 20 degrees to the right; eyes half a metre apart at 700 mm
	animation_free(&a);
	script_free(&s);
	skin_model_free(&m);
}

static void bad_scripts(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} cases[] = {
		{ "time_s,horizontal_deg\n0,1\n", "both or neither" },
		{ "time_s,horizontal_deg,vertical_deg\n0,1,\n", "both or neither in each line" },
		{ "time_s,horizontal_deg,vertical_deg\n0,1,1\n0,2,2\n", ":3: time_s = 0: must be greater" },
		{ "time_s,horizontal_deg,vertical_deg\n0,1,1\n1,200,2\n", ":3: horizontal_deg = 200: must be in [-80, 80] degrees" },
		{ "time_s,smile\n0,1.5\n", ":2: smile = 1.5: must be in [0, 1]" },
		{ "time_s,grin\n0,1\n", "column grin: must be a key" },
		{ "time,smile\n0,1\n", "no column time_s" },
		{ "time_s,smile\n-1,1\n", ":2: time_s = -1" },
		{ "time_s,smile\n", "no row" },
		{ "time_s,smile\nx,1\n", ":2: time_s = x: must be a finite number" },
		{ "time_s,g1_deg,g2_deg\n0,1,95\n", ":2: g2_deg = 95" },
	};
	struct skin_model m = small_model();
	for (int i = 0; i < COUNT(cases); i++) {
		struct script s;
		struct err err = { 0 };
		assert_false(script_read(&s, scratch_text("bad.csv", cases[i].text), &m, &err));
		ERR_HAS(err, cases[i].says);
		script_free(&s);
	}
	skin_model_free(&m);
}

enum { W = 320, H = 240 };

static void paint(unsigned char *rgb, int x0, int y0, int size, int r, int g, int b)
{
	for (int y = y0; y < y0 + size; y++)
		for (int x = x0; x < x0 + size; x++) {
			rgb[3 * (y * W + x)] = (unsigned char)r;
			rgb[3 * (y * W + x) + 1] = (unsigned char)g;
			rgb[3 * (y * W + x) + 2] = (unsigned char)b;
		}
}


static bool near_place(const double at[2], double x, double y, double px)
{
	return hypot(at[0] * W - x, at[1] * H - y) <= px;
}

/* Pop-out in colour, intensity and flicker; inhibition of return sends the eye on, and lets it come back. */
static void popping_out(void **state)
{
	(void)state;
	static unsigned char rgb[W * H * 3];
	struct saliency s = { 0 };
	double at[2];
	memset(rgb, 90, sizeof rgb);
	saliency_push(&s, rgb, W, H, 3 * W);
	assert_false(saliency_next(at, &s));  // nothing in it
	saliency_free(&s);
	for (int i = 0; i < 20; i++)  // green patches, one red, of the same light
		paint(rgb, 20 + i % 5 * 60, 20 + i / 5 * 55, 18, 60, 150, 60);
	paint(rgb, 20 + 3 * 60, 20 + 55, 18, 150, 60, 60);
	saliency_push(&s, rgb, W, H, 3 * W);
	assert_true(saliency_next(at, &s) && near_place(at, 209, 84, 25));
	saliency_inhibit(&s, at, 0.17);
	assert_true(saliency_next(at, &s) && !near_place(at, 209, 84, 40));
	saliency_decay(&s, 5, 0.9);
	assert_true(saliency_next(at, &s) && near_place(at, 209, 84, 25));
	saliency_free(&s);
	memset(rgb, 90, sizeof rgb);
	for (int i = 0; i < 12; i++)
		paint(rgb, 30 + i % 4 * 70, 30 + i / 4 * 70, 20, 140, 140, 140);
	saliency_push(&s, rgb, W, H, 3 * W);
	paint(rgb, 30 + 2 * 70, 30 + 70, 20, 90, 90, 90);  // one of twelve goes out
	saliency_push(&s, rgb, W, H, 3 * W);
	assert_true(saliency_next(at, &s) && near_place(at, 180, 110, 25));
	saliency_free(&s);
}

/* Bars of one slant, 8 by 6 of them, one of another: wherever that one is, it is looked at first. */
static void orientation_pops_out(void **state)
{
	(void)state;
	enum { LONG = 18, CELL = 64, ACROSS = 8 * CELL, DOWN = 6 * CELL };
	static unsigned char rgb[ACROSS * DOWN * 3];
	for (int odd = 0; odd < 48; odd += 5) {
		struct saliency s = { 0 };
		double at[2];
		memset(rgb, 128, sizeof rgb);
		for (int k = 0; k < 48; k++)
			for (int i = -LONG; i <= LONG; i++) {
				int x = CELL / 2 + k % 8 * CELL + i, y = CELL / 2 + k / 8 * CELL + (k == odd ? -i : i);
				memset(rgb + 3 * (y * ACROSS + x - 3), 255, 21);
			}
		saliency_push(&s, rgb, ACROSS, DOWN, 3 * ACROSS);
		assert_true(saliency_next(at, &s));
		assert_int_equal((int)(8 * at[0]) + 8 * (int)(6 * at[1]), odd);
		saliency_free(&s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(main_sequence), cmocka_unit_test(closed_forms),      cmocka_unit_test(vergence_geometry),
		cmocka_unit_test(a_saccade),     cmocka_unit_test(reflex),            cmocka_unit_test(pursuit),
		cmocka_unit_test(vergence_dynamics), cmocka_unit_test(blinks),        cmocka_unit_test(expressions_take_lids), cmocka_unit_test(keyframes), cmocka_unit_test(winks),
		cmocka_unit_test(deterministic), cmocka_unit_test(recorded),          cmocka_unit_test(bad_scripts),
		cmocka_unit_test(popping_out), cmocka_unit_test(orientation_pops_out),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
