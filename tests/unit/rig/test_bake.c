/* What an animation's morph targets reproduce: skin, hairs, tears, the eyeballs' turns. */
#include "math/vec.h"
#include "rig/glb/bake.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/unit.h"

/* Rest plus weighted targets is the evaluated frame, within what is reported; the quaternions turn the eyeballs likewise. */
static void targets_give_the_frames_back(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &m->conf, &err));
	assert_true(b.n_targets >= 3 && b.n_targets <= m->conf.targets);
	struct deform *deform = deform_new(&m->on.rig);
	float (*x)[3] = calloc((size_t)m->on.rig.n, sizeof *x);
	double worst = 0;
	deform_rest(deform, x, 0);
	for (int f = 0; f < WANDERING_FRAMES; f++) {
		double e[RIG_COMPONENTS], turn[2][3][3], *c = drive_at(&m->drive, f);
		rig_components(e, &m->on.rig, c);
		for (int s = 0; s < 2; s++)
			rig_globe_rotation(turn[s], &m->on.rig, (double[]){ c[5 * s] * M_PI / 180, c[5 * s + 1] * M_PI / 180, 0 });
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		for (int i = 0; i < b.n; i++) {
			double d[3];
			for (int k = 0; k < 3; k++) {
				d[k] = m->on.rig.rest[b.vertex[i]][k] - x[b.vertex[i]][k];
				for (int t = 0; t < b.n_targets; t++)
					d[k] += b.weight[f * b.n_targets + t] * b.target[(t * b.n + i) * 3 + k];
			}
			worst = fmax(worst, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
		}
		for (int t = 0; t < b.n_targets; t++)
			assert_true(fabsf(b.weight[f * b.n_targets + t]) <= 1);
		// The line of sight, (0, 0, 1) at rest, through the quaternion and by Fick's formula (lib/README.md).
		const float *q = b.turn[0] + 4 * f;
		double h = c[0] * M_PI / 180, v = c[1] * M_PI / 180;
		NEAR(2 * (q[0] * q[2] + q[1] * q[3]), sin(h) * cos(v), 1e-5);
		NEAR(2 * (q[1] * q[2] - q[0] * q[3]), sin(v), 1e-5);
	}
	NEAR(worst, b.worst, 1e-3);
	assert_true(b.worst <= m->conf.tolerance + 1e-3 || b.n_targets == m->conf.targets);
	free(x);
	deform_free(deform);
	glb_bake_free(&b);
}

/* Lashes, brows and tears go where their roots go: with the animation's weights, and with a named pose. */
static void hairs_follow(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &m->conf, &err));
	const int strands = strands_count(&m->on.hairs), n = strands + tears_count(&m->on.hairs);
	assert_int_equal(b.n_hair, n);
	struct deform *deform = deform_new(&m->on.rig);
	float (*x)[3] = calloc((size_t)m->on.rig.n, sizeof *x), (*rest)[3] = calloc((size_t)n, sizeof *rest), (*now)[3] = calloc((size_t)n, sizeof *now);
	double turn[2][3][3], worst[2] = { 0 }, most[2] = { 0 }, blink[2] = { 0 };
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(turn[s], &m->on.rig, (double[3]){ 0 });
	strands_place(rest, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])m->on.rig.rest);
	tears_place(rest + strands, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])m->on.rig.rest, (const double(*)[3][3])turn, m->conf.tear_mm, 0);
	deform_rest(deform, x, 0);
	for (int f = 0; f < WANDERING_FRAMES; f++) {
		double e[RIG_COMPONENTS], *c = drive_at(&m->drive, f);
		rig_components(e, &m->on.rig, c);
		rig_globes_turned(turn, &m->on.rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		strands_place(now, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])x);
		tears_place(now + strands, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])x, (const double(*)[3][3])turn, m->conf.tear_mm, 0);
		for (int i = 0; i < n; i++) {
			double d[3], far[3];
			for (int k = 0; k < 3; k++) {
				d[k] = far[k] = rest[i][k] - now[i][k];
				for (int t = 0; t < b.n_targets; t++)
					d[k] += b.weight[f * b.n_targets + t] * b.hair_target[(t * n + i) * 3 + k];
			}
			worst[i >= strands] = fmax(worst[i >= strands], vec_norm(d));
			most[i >= strands] = fmax(most[i >= strands], vec_norm(far));
		}
	}
	for (int i = 0; i < 3 * n; i++)
		blink[i >= 3 * strands] = fmax(blink[i >= 3 * strands], fabs((double)b.hair_pose[i]));
	print_message("hairs move by %.2f mm, %.2f off at worst, by %.2f in a blink; tears by %.2f, %.2f off, %.2f\n", most[0], worst[0], blink[0], most[1], worst[1], blink[1]);
	assert_true(most[0] > 0.5 && worst[0] < 0.05 * most[0] && blink[0] > 0.1);
	assert_true(most[1] > 0.1 && worst[1] < 0.1);
	free(x);
	free(rest);
	free(now);
	deform_free(deform);
	glb_bake_free(&b);
}

static void more_targets_are_closer(void **state)
{
	struct wandering *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	double before = INFINITY;
	for (int n = 1; n <= 9; n += 4) {
		struct glb_conf few = m->conf;
		few.targets = n;
		few.tolerance = 0;
		assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &few, &err));
		assert_true(b.worst < before);
		before = b.worst;
		glb_bake_free(&b);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(targets_give_the_frames_back),
		cmocka_unit_test(hairs_follow),
		cmocka_unit_test(more_targets_are_closer),
	};
	return cmocka_run_group_tests(tests, wandering_setup, wandering_teardown);
}
