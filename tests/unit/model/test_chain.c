/* The skin column as a whole against closed forms: a person whose skin and lids move by known affine maps is learnt from a
 * clip, carried to a character that is a known similarity of the person's mesh, and driven. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "rig/deform/deform.h"
#include "register/transfer.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/scenes/linear_clip.h"
#include "tests/lib/conf/transfer_conf.h"
#include "tests/lib/unit.h"

enum { FRAMES = 500, EVERY = 16, INPUTS = 12, POSES = 12 };

/* Frames of a face: controls at random, the first one the rest's; every 16th vertex is tracked. */
struct filmed {
	struct face face;
	int n_tracked;
	double c[FRAMES][INPUTS], g[FRAMES][INPUTS], time[FRAMES], confidence[FRAMES][2];
};

static void random_controls(double *c, struct rng *rng)
{
	for (int i = 0; i < INPUTS; i++)
		c[i] = i < SKIN_EYE_INPUTS && i % 5 < 3 ? rng_range(rng, -20, 20) : rng_uniform(rng);
}

static bool read_frames(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	struct filmed *f = ctx;
	const struct skin_model *m = &f->face.model;
	double *u = mem_new(2 * (size_t)m->n_vertices, sizeof *u);
	(void)err;
	for (long r = 0; r < n; r++) {
		skin_model_predict(u, lid + r * m->n_lid, m, f->c[first + r]);
		for (int i = 0; i < f->n_tracked; i++) {
			memcpy(skin + 2 * (r * f->n_tracked + i), u + 2 * EVERY * i, 2 * sizeof *u);
			seen[r * f->n_tracked + i] = 1;
		}
	}
	free(u);
	return true;
}

static struct filmed *film(void)
{
	struct filmed *f = mem_new(1, sizeof *f);
	struct rng rng = { 31 };
	face_make(&f->face, true);
	struct skin_model *m = &f->face.model;
	for (int eye = 0; eye < 2; eye++)  // the upper lids follow the gaze, px a degree
		m->L[2 * eye * (SKIN_EYE_INPUTS + 1) + 5 * eye + 1] = 1.5;
	f->n_tracked = (m->n_vertices + EVERY - 1) / EVERY;
	for (int r = 0; r < FRAMES; r++) {
		if (r)
			random_controls(f->c[r], &rng);
		else
			memcpy(f->c[r], m->rest_controls, sizeof f->c[r]);
		skin_model_inputs(f->g[r], m, f->c[r]);
		f->time[r] = r / 60.0;
		f->confidence[r][0] = f->confidence[r][1] = 1;
	}
	return f;
}

static void learn(struct skin_model *learnt, struct filmed *f)
{
	const struct skin_model *m = &f->face.model;
	struct train_clip clip = { .n = FRAMES, .n_au = m->n_au, .n_points = m->n_points, .n_vertices = f->n_tracked, .time = f->time,
		                       .g = f->g[0], .confidence = f->confidence[0], .read = read_frames, .ctx = f, .place = "clip" };
	struct train_conf conf = train_defaults;
	struct train_report report;
	struct err err = { 0 };
	conf.brief = true;
	if (!train_run(learnt, &report, &clip, &conf, &err))
		fail_msg("%s", err.msg);
	learnt->camera = m->camera;
	for (int i = 0; i < f->n_tracked; i++)
		learnt->vertices[i] = EVERY * i;
	train_report_free(&report);
}

/* target = 1.25 R x + shift: turned about all three axes. */
static const double scale = 1.25, shift[3] = { 40, -70, 25 };

static void similarity(double out[3], const double x[3])
{
	double a = 0.35, b = -0.2, q[3] = { cos(a) * x[0] - sin(a) * x[1], sin(a) * x[0] + cos(a) * x[1], x[2] };
	out[0] = scale * (cos(b) * q[0] + sin(b) * q[2]) + shift[0];
	out[1] = scale * q[1] + shift[1];
	out[2] = scale * (-sin(b) * q[0] + cos(b) * q[2]) + shift[2];
}

/* The character: the person's sheet moved; its rig, by transfer and extrapolate. */
static void character(struct rig *rig, const struct filmed *f, const struct skin_model *learnt, struct mesh *target)
{
	const struct mesh *subject = &f->face.skin;
	struct transfer t;
	struct rig_motion motion;
	struct rig_report report;
	struct rig_conf conf = face_conf();
	struct err err = { 0 };
	for (int i = 0; i < subject->n_vertices; i++) {
		double x[3] = { subject->vertices[i][0], subject->vertices[i][1], subject->vertices[i][2] };
		similarity(x, x);
		for (int c = 0; c < 3; c++)
			target->vertices[i][c] = (float)x[c];
	}
	if (!transfer_run(&t, target, subject, 0, &transfer_defaults, &err))
		fail_msg("%s", err.msg);
	assert_true(t.same_topology);
	NEAR(t.scale, 1 / scale, 1e-5);
	int32_t *start = mem_new((size_t)t.n + 1, sizeof *start);
	for (int i = 0; i < t.n; i++) {
		start[i + 1] = 3 * (i + 1);
		NEAR(t.weight[i][0] + t.weight[i][1] + t.weight[i][2], 1, 1e-12);
	}
	struct rig_character ch = { .mesh = target, .registered = (const float(*)[3])t.registered, .b_start = start, .b_column = t.column[0],
		                        .b_weight = t.weight[0], .confidence = t.confidence, .eye_radius = f->face.radius };
	memcpy(ch.subject_from_target, t.subject_from_target, sizeof ch.subject_from_target);
	memcpy(ch.eye_center, f->face.center, sizeof ch.eye_center);
	rig_motion_of_model(&motion, learnt);
	if (!rig_make(rig, &report, &motion, &ch, &conf, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(report.tracked, f->n_tracked);
	rig_motion_free(&motion);
	transfer_free(&t);
	free(start);
}

static void train_transfer_extrapolate_drive(void **state)
{
	(void)state;
	struct filmed *f = film();
	const struct skin_model *m = &f->face.model;
	struct skin_model learnt;
	struct rig rig;
	struct mesh target = f->face.skin;
	struct rng rng = { 77 };
	target.vertices = mem_new((size_t)target.n_vertices, sizeof *target.vertices);
	learn(&learnt, f);
	character(&rig, f, &learnt, &target);
	struct deform *deform = deform_new(&rig);
	double *u = mem_new(2 * (size_t)m->n_vertices, sizeof *u), *rest = mem_new(2 * (size_t)m->n_vertices, sizeof *rest);
	float (*x)[3] = mem_new((size_t)rig.n, sizeof *x);
	double worst = 0, most = 0;
	deform_rest(deform, x, 0);
	skin_model_predict(rest, 0, m, m->rest_controls);
	for (int pose = 0; pose < POSES; pose++) {
		double c[INPUTS], g[INPUTS], e[RIG_COMPONENTS], turn[2][3][3];
		random_controls(c, &rng);
		skin_model_predict(u, 0, m, c);
		skin_model_inputs(g, m, c);  // the learnt model has another idea of closed and open
		skin_model_controls(c, &learnt, g);
		rig_components(e, &rig, c);
		for (int s = 0; s < 2; s++)
			rig_globe_rotation(turn[s], &rig, (double[3]){ 0 });
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		for (int i = 0; i < m->n_vertices; i += EVERY) {
			const float *home = f->face.skin.vertices[i];
			double mm = 588.0 / 5000, d[2] = { mm * (u[2 * i] - rest[2 * i]), -mm * (u[2 * i + 1] - rest[2 * i + 1]) };
			double want[3] = { home[0] + d[0], home[1] + d[1], home[2] };
			similarity(want, want);
			for (int k = 0; k < 3; k++)
				worst = fmax(worst, fabs(x[i][k] - want[k]));
			most = fmax(most, hypot(d[0], d[1]));
		}
	}
	assert_true(most > 0.5);
	assert_true(worst < 2e-4);  // mm: single precision of px near 1000 and of the skull map
	free(u);
	free(rest);
	free(x);
	free(target.vertices);
	deform_free(deform);
	rig_free(&rig);
	skin_model_free(&learnt);
	face_free(&f->face);
	free(f);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(train_transfer_extrapolate_drive) };
	return cmocka_run_group_tests(tests, 0, 0);
}
