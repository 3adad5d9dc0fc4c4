/* Targets of single poses: what each is, that they add up, and that a blink goes round the eye. */
#include "math/vec.h"
#include "rig/deform/arc.h"
#include "rig/deform/lifted.h"
#include "rig/glb/bake.h"
#include "rig/glb/halves.h"
#include "rig/glb/mixed.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/unit.h"

/* An expression's target is what it moves beside a look straight ahead. */
static void expressions_have_targets(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	for (int k = 0; k < EXPRESS_LIDS; k += 2)  // a second one that narrows the eyes
		m->on.rig.expression[1][k] = -0.3;
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &m->conf, &err));
	assert_in_range(b.n_poses, GLB_POSES + 2 + GLB_TURNED + GLB_HALVES, GLB_POSES + 2 + glb_most_mixed(2) + GLB_TURNED + GLB_HALVES);
	float (*x[2])[3] = { calloc((size_t)m->on.rig.n, sizeof **x), calloc((size_t)m->on.rig.n, sizeof **x) };
	struct deform *deform = deform_new(&m->on.rig);
	struct deform_near near = deform_near_of(&m->on.rig);
	for (int k = 0; k < 2; k++) {
		double worst = 0, most = 0;
		for (int on = 0; on < 2; on++) {
			double c[12], e[RIG_COMPONENTS], turn[2][3][3], lifted[2];
			drive_look(c, &m->on.rig, 0, 0, 1);
			drive_express(c, &m->on.rig, k, on, 1);
			rig_components(e, &m->on.rig, c);
			rig_globes_turned(turn, &m->on.rig, c);
			deform_rest(deform, x[on], 0);
			deform_pose(deform, e, (const double(*)[3][3])turn, x[on], 0);
			deform_lifted(lifted, &near, &m->on.rig, c);
			deform_settle(x[on], &m->on.rig, &near, (const double(*)[3][3])turn, lifted);
		}
		assert_string_equal(b.pose_name[GLB_POSES + k], m->conf.expression[k]);
		for (int i = 0; i < b.n; i++)
			for (int c = 0; c < 3; c++) {
				const double want = (double)x[1][b.vertex[i]][c] - (double)x[0][b.vertex[i]][c];
				worst = fmax(worst, fabs(want - (double)b.pose[((GLB_POSES + k) * b.n + i) * 3 + c]));
				most = fmax(most, fabs(want));
			}
		assert_true(most > 0.1 && worst < 1e-4);
	}
	free(x[0]);
	free(x[1]);
	deform_free(deform);
	deform_near_free(&near);
	for (int k = 0; k < EXPRESS_LIDS; k += 2)
		m->on.rig.expression[1][k] = 0;
	glb_bake_free(&b);
}

/* Both eyes' targets together are the pose of both eyes, wherever mesh and globe disagree at rest: here all of the left lids' linings lie in it. */
static void named_poses_add_up(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	static const int pairs[][2] = { { 0, 1 }, { 2, 3 }, { 8, 7 } };
	static const double look[][3] = { { 0, 0, 0 }, { 0, 20, 1 }, { 25, 0, 1 } };
	float (*was)[3] = calloc((size_t)m->on.rig.n, sizeof *was), (*x)[3] = calloc((size_t)m->on.rig.n, sizeof *x);
	memcpy(was, m->on.rig.rest, (size_t)m->on.rig.n * sizeof *was);
	for (int i = 0; i < m->on.rig.n; i++)
		for (int c = 0; c < 3 && m->on.rig.part[i] == RIG_SKIN && m->on.rig.gap[i] < 2; c++)  // 3 mm deeper, towards the globe's centre
			m->on.rig.rest[i][c] -= 3.0f / 14 * (m->on.rig.rest[i][c] - (float)m->on.rig.globe[m->on.rig.side[i]].center[c]);
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &m->conf, &err));
	struct deform *deform = deform_new(&m->on.rig);
	struct deform_near near = deform_near_of(&m->on.rig);
	for (int k = 0; k < 3; k++) {
		const bool whole = look[k][1] != 0;
		double e[RIG_COMPONENTS], turn[2][3][3], c[12], worst = 0, most = 0;
		float (*from)[3] = calloc((size_t)m->on.rig.n, sizeof *from);
		for (int pass = 0; pass < 2; pass++) {  // what it is told against: rest for a blink, the mesh itself for a look up, else a look straight ahead
			drive_look(c, &m->on.rig, pass ? look[k][0] : 0, pass ? look[k][1] : 0, pass ? look[k][2] : 1);
			rig_components(e, &m->on.rig, c);
			rig_globes_turned(turn, &m->on.rig, c);
			deform_rest(deform, x, 0);
			deform_pose(deform, !pass && k == 0 ? m->on.rig.rest_e : e, (const double(*)[3][3])turn, x, 0);
			deform_settle(x, &m->on.rig, &near, (const double(*)[3][3])turn, 0);
			if (!pass)
				memcpy(from, whole ? m->on.rig.rest : x, (size_t)m->on.rig.n * sizeof *from);
		}
		for (int i = 0; i < b.n; i++)
			for (int d = 0; d < 3; d++) {
				const double sum = (double)b.pose[(pairs[k][0] * b.n + i) * 3 + d] + (double)b.pose[(pairs[k][1] * b.n + i) * 3 + d];
				const double want = (double)x[b.vertex[i]][d] - (double)from[b.vertex[i]][d];
				worst = fmax(worst, fabs(sum - want));
				most = fmax(most, fabs(want));
			}
		print_message("two targets: %.2f mm off where the pose moves by %.2f\n", worst, most);
		assert_true(worst < 0.3);
		free(from);
	}
	memcpy(m->on.rig.rest, was, (size_t)m->on.rig.n * sizeof *was);
	free(was);
	free(x);
	deform_free(deform);
	deform_near_free(&near);
	glb_bake_free(&b);
}

/* Shut eyes that look down or up: blinks, looks and what goes with both together are that pose; without the last they are not. */
static void turned_blinks_add_up(void **state)
{
	struct wandering *m = *state;
	struct rig shuts, *rig = &shuts;
	struct rig_conf shutting = face_conf();
	struct glb_bake b;
	struct err err = { 0 };
	shutting.map_step = 4;
	shutting.lid = 6;
	shutting.seal = 0.15;
	assert_true(face_rig(rig, 0, &m->on.face, &shutting, &err));
	float (*x)[3] = calloc((size_t)rig->n, sizeof *x);
	struct deform *deform = deform_new(rig);
	struct deform_near near = deform_near_of(rig);
	assert_true(glb_bake_make(&b, rig, &m->drive, &m->conf, &err));
	for (int up = 0; up < 2; up++) {
		const int turned = b.n_poses - GLB_HALVES - GLB_TURNED + 2 * up, look = up ? 2 : 4;
		double e[RIG_COMPONENTS], c[12], turn[2][3][3], off[2] = { 0 };
		assert_string_equal(b.pose_name[turned + 1], up ? "eyeBlinkRight_up" : "eyeBlinkRight_down");
		drive_look(c, rig, 0, up ? 20 : -20, 0);
		rig_components(e, rig, c);
		rig_globes_turned(turn, rig, c);
		deform_rest(deform, x, 0);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		deform_settle(x, rig, &near, (const double(*)[3][3])turn, 0);
		for (int i = 0; i < b.n; i++)
			for (int with = 0; with < 2; with++) {
				double d[3];
				for (int k = 0; k < 3; k++) {
					double sum = 0;
					for (int eye = 0; eye < 2; eye++)
						sum += (double)b.pose[(eye * b.n + i) * 3 + k] + (double)b.pose[((look + eye) * b.n + i) * 3 + k] + with * (double)b.pose[((turned + eye) * b.n + i) * 3 + k];
					d[k] = rig->rest[b.vertex[i]][k] + sum - (double)x[b.vertex[i]][k];
				}
				off[with] = fmax(off[with], vec_norm(d));
			}
		print_message("shut, looking %s: %.3f mm off by blinks and looks, %.5f with what goes with both\n", up ? "up" : "down", off[0], off[1]);
		assert_true(off[0] > 0.1 && off[1] < 1e-4);  // sums of floats
	}
	free(x);
	deform_free(deform);
	deform_near_free(&near);
	glb_bake_free(&b);
	rig_free(rig);
}

static int pose_of(const struct glb_bake *b, const char *name)
{
	for (int k = 0; k < b->n_poses; k++)
		if (!strcmp(b->pose_name[k], name))
			return k;
	return -1;
}

static double pose_at(const struct glb_bake *b, int pose, int i, int c)
{
	return pose < 0 ? 0 : (double)b->pose[((long)pose * b->n + i) * 3 + c];
}

/* Eyes that shut in an expression that narrows them: blinks, expression and what goes with both together are that pose, against a blink's own; without the last the lids that
 * are shut already go on. It moves its own side of the face alone. An expression that moves nothing near the eyes has none. */
static void blinks_in_expressions_add_up(void **state)
{
	struct wandering *m = *state;
	struct rig shuts, *rig = &shuts;
	struct rig_conf shutting = face_conf();
	struct glb_bake b;
	struct err err = { 0 };
	shutting.map_step = 4;
	shutting.lid = 6;
	shutting.seal = 0.15;
	assert_true(face_rig(rig, 0, &m->on.face, &shutting, &err));
	for (int k = 0; k < EXPRESS_LIDS; k++) {
		rig->expression[0][k] = 0;
		rig->expression[1][k] = -0.3;
	}
	for (int k = 0; k < RIG_COMPONENTS; k++)
		rig->W[k * (rig->n_inputs + 1) + SKIN_EYE_INPUTS] = 0;
	float (*x[2])[3] = { calloc((size_t)rig->n, sizeof **x), calloc((size_t)rig->n, sizeof **x) };  // at rest; the pose
	struct deform *deform = deform_new(rig);
	struct deform_near near = deform_near_of(rig);
	assert_true(glb_bake_make(&b, rig, &m->drive, &m->conf, &err));
	for (int k = 0; k < 2; k++) {
		double e[RIG_COMPONENTS], c[12], turn[2][3][3], off[2] = { 0 }, alone = 0;
		drive_look(c, rig, 0, 0, 0);
		drive_express(c, rig, k, 1, 0);
		rig_components(e, rig, c);
		rig_globes_turned(turn, rig, c);
		for (int pass = 0; pass < 2; pass++) {
			deform_rest(deform, x[pass], 0);
			deform_pose(deform, pass ? e : rig->rest_e, (const double(*)[3][3])turn, x[pass], 0);
			deform_settle(x[pass], rig, &near, (const double(*)[3][3])turn, 0);
		}
		char left[64], right[64];
		snprintf(left, sizeof left, "eyeBlinkLeft_%s", m->conf.expression[k]);
		snprintf(right, sizeof right, "eyeBlinkRight_%s", m->conf.expression[k]);
		const int mixed[2] = { pose_of(&b, left), pose_of(&b, right) };
		assert_true((mixed[0] < 0) == (mixed[1] < 0));
		for (int i = 0; i < b.n; i++) {
			for (int with = 0; with < 2; with++) {
				double d[3];
				for (int q = 0; q < 3; q++) {
					double sum = pose_at(&b, GLB_POSES + k, i, q);
					for (int eye = 0; eye < 2; eye++)
						sum += pose_at(&b, eye, i, q) + with * pose_at(&b, mixed[eye], i, q);
					d[q] = sum - ((double)x[1][b.vertex[i]][q] - (double)x[0][b.vertex[i]][q]);
				}
				off[with] = fmax(off[with], vec_norm(d));
			}
			if (fabsf(rig->rest[b.vertex[i]][0]) > 10 && rig->rest[b.vertex[i]][0] < 0)
				alone = fmax(alone, fabs(pose_at(&b, mixed[0], i, 0)) + fabs(pose_at(&b, mixed[0], i, 1)) + fabs(pose_at(&b, mixed[0], i, 2)));
		}
		print_message("shut, %s: %.3f mm off by blinks and expression, %.4f with what goes with both\n", m->conf.expression[k], off[0], off[1]);
		assert_true(k ? mixed[0] >= 0 && off[0] > 0.5 && off[1] < 0.041 : mixed[0] < 0 && off[0] < 1e-4);  // what moves by less than 0.02 mm is left, on the nose of both eyes
		assert_true(alone < 1e-6);
		if (k) {
			const struct glb_driven *d = &b.driven[mixed[1]];
			assert_true(d->by == 1 && d->and == GLB_POSES + 1 && !d->half);
		}
	}
	free(x[0]);
	free(x[1]);
	deform_free(deform);
	deform_near_free(&near);
	glb_bake_free(&b);
	rig_free(rig);
}

/* Whatever an expression is called, no two targets have one name. */
static void no_name_twice(void **state)
{
	struct wandering *m = *state;
	static const char *const called[2] = { "down_half", "down" };
	struct glb_conf conf = m->conf;
	struct glb_bake b;
	struct err err = { 0 };
	conf.expression = called;
	for (int k = 0; k < EXPRESS_LIDS; k++)
		m->on.rig.expression[1][k] = -0.3;
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &conf, &err));
	for (int k = 0; k < b.n_poses; k++)
		for (int i = 0; i < k; i++)
			assert_string_not_equal(b.pose_name[i], b.pose_name[k]);
	const int look = pose_of(&b, "eyeBlinkLeft_down"), expression = pose_of(&b, "eyeBlinkLeft_down_too");
	assert_true(look >= 0 && expression >= 0);
	assert_int_equal(b.driven[look].and, glb_turned_look(0));
	assert_int_equal(b.driven[expression].and, GLB_POSES + 1);
	for (int k = 0; k < EXPRESS_LIDS; k++)
		m->on.rig.expression[1][k] = 0;
	glb_bake_free(&b);
}

/* An eye's targets move its own side of the face alone, however a clip ties both eyes to each other. */
static void each_eye_by_itself(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	const size_t size = (size_t)(RIG_COMPONENTS * (m->on.rig.n_inputs + 1)) * sizeof(double);
	double *slope = m->on.rig.W, *was = malloc(size), most[2] = { 0 };
	memcpy(was, slope, size);
	for (int k = 0; k < RIG_COMPONENTS; k++)  // what the left lids do, both do
		for (int i = 3; i < 5; i++) {
			slope[k * (m->on.rig.n_inputs + 1) + i] += slope[k * (m->on.rig.n_inputs + 1) + i + 5];
			slope[k * (m->on.rig.n_inputs + 1) + i + 5] = 0;
		}
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &m->conf, &err));
	for (int pose = 0; pose < GLB_POSES; pose++)
		for (int i = 0; i < b.n; i++) {
			const float *d = b.pose + 3 * ((long)pose * b.n + i), x = m->on.rig.rest[b.vertex[i]][0];  // the left eye at x > 0
			const bool own = (x > 0) == (pose % 2 == 0);
			if (fabsf(x) > 10)
				most[own] = fmax(most[own], sqrt((double)d[0] * d[0] + (double)d[1] * d[1] + (double)d[2] * d[2]));
		}
	print_message("an eye's targets move its own side by %.2f mm, the other by %.2f\n", most[1], most[0]);
	assert_true(most[1] > 0.5 && most[0] < 1e-6);
	memcpy(slope, was, size);
	free(was);
	glb_bake_free(&b);
}

/* A clip that hardly looks anywhere: the named gazes turn lids no further than it did, however steep its slopes; what was made of the same
 * slopes without end closes the eye. */
static void lids_go_no_further_than_they_are_known(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b[3];
	struct err err = { 0 };
	const double g[2][10] = { { -4, -3, 0, 0, 0, -4, -3 }, { 4, 3, 0, 0, 0, 4, 3 } };
	const struct known was = m->on.rig.known;
	double most[3] = { 0 }, *slope = m->on.rig.W;
	for (int eye = 0; eye < 2; eye++)
		slope[5 * eye] += 5;  // px a degree
	for (int k = 0; k < 3; k++) {
		if (k)
			known_of(&m->on.rig.known, 2, g[0], 10, k == 1 ? 0 : 0.3);
		assert_true(glb_bake_make(&b[k], &m->on.rig, &m->drive, &m->conf, &err));
		for (int pose = 2; pose < 10; pose++)
			for (int i = 0; i < b[k].n; i++) {
				const float *d = b[k].pose + (long)(pose * b[k].n + i) * 3;
				most[k] = fmax(most[k], sqrt((double)d[0] * d[0] + (double)d[1] * d[1] + (double)d[2] * d[2]));
			}
		glb_bake_free(&b[k]);
	}
	print_message("furthest of the named gazes: %.2f mm, held %.2f, and a little further %.2f\n", most[0], most[1], most[2]);
	assert_true(most[1] < 0.35 * most[0] && most[2] > most[1] && most[2] < 1.5 * most[1]);
	m->on.rig.known = was;
	for (int eye = 0; eye < 2; eye++)
		slope[5 * eye] -= 5;
}

/* A vertex of the bake with an eye's lids at the target's weight w, that of its half at q: its place; how far it is outside that eye. */
static double on_the_way(float x[3], const struct rig *rig, const struct glb_bake *b, int eye, int i, double w, double q)
{
	const float *blink = b->pose + 3 * ((long)eye * b->n + i), *half = b->pose + 3 * ((long)(b->n_poses - GLB_HALVES + eye) * b->n + i);
	double turn[3][3];
	rig_globe_rotation(turn, rig, (double[3]){ 0 });
	for (int c = 0; c < 3; c++)
		x[c] = (float)(rig->rest[b->vertex[i]][c] + w * blink[c] + q * half[c]);
	return rig_globe_distance(rig, rig->side[b->vertex[i]], (const double(*)[3])turn, x);
}

/* Between open and shut, lids come no nearer to the eye than they are at either end, and go where the pose itself has them; the blink's target alone
 * leads straight on (here lids are 2 mm before the eye). */
static void blinks_go_round_the_eye(void **state)
{
	struct wandering *m = *state;
	struct rig shuts, *rig = &shuts;
	struct rig_conf shutting = face_conf();
	struct glb_bake b;
	struct err err = { 0 };
	double deep[2] = { 0 }, off[2] = { 0 };
	shutting.map_step = 4;
	shutting.lid = 6;
	shutting.seal = 0.15;  // else this face's lids stay wide open
	assert_true(face_rig(rig, 0, &m->on.face, &shutting, &err));
	float (*pose)[3] = calloc((size_t)rig->n, sizeof *pose), x[3];
	struct deform *deform = deform_new(rig);
	struct deform_near near = deform_near_of(rig);
	assert_true(glb_bake_make(&b, rig, &m->drive, &m->conf, &err));
	for (int step = 1; step < 20; step++)
		for (int eye = 0; eye < 2; eye++) {
			const double w = step / 20.0;
			double e[RIG_COMPONENTS], c[12], turn[2][3][3];
			drive_look(c, rig, 0, 0, 0);
			rig_components(e, rig, c);
			rig_globes_turned(turn, rig, c);
			for (int k = 0; k < RIG_COMPONENTS; k++)
				e[k] = (1 - w) * rig->rest_e[k] + w * e[k];
			deform_rest(deform, pose, 0);
			deform_pose(deform, e, (const double(*)[3][3])turn, pose, 0);
			deform_settle(pose, rig, &near, (const double(*)[3][3])turn, 0);
			for (int i = 0; i < b.n; i++) {
				if (rig->side[b.vertex[i]] != eye)
					continue;
				const double ends = fmin(on_the_way(x, rig, &b, eye, i, 0, 0), on_the_way(x, rig, &b, eye, i, 1, 0));
				for (int with = 0; with < 2; with++) {
					deep[with] = fmax(deep[with], ends - on_the_way(x, rig, &b, eye, i, w, with ? glb_half_weight(w) : 0));
					double d[3];
					for (int k = 0; k < 3; k++)
						d[k] = (double)x[k] - (double)pose[b.vertex[i]][k];
					off[with] = fmax(off[with], vec_norm(d));
				}
			}
		}
	print_message("lids on their way: %.3f mm nearer to the eye and %.3f off with the blink's target alone, %.3f and %.3f with both\n", deep[0], off[0], deep[1], off[1]);
	assert_true(deep[0] > 1 && deep[1] < 0.1 * deep[0] && off[1] < 0.1 * off[0]);  // a parabola for an arc
	free(pose);
	deform_free(deform);
	deform_near_free(&near);
	glb_bake_free(&b);
	rig_free(rig);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(expressions_have_targets),
		cmocka_unit_test(named_poses_add_up),
		cmocka_unit_test(lids_go_no_further_than_they_are_known),
		cmocka_unit_test(blinks_go_round_the_eye),
		cmocka_unit_test(each_eye_by_itself),
		cmocka_unit_test(turned_blinks_add_up),
		cmocka_unit_test(blinks_in_expressions_add_up),
		cmocka_unit_test(no_name_twice),
	};
	return cmocka_run_group_tests(tests, wandering_setup, wandering_teardown);
}
