/* Faces of a posed character stay out of its eyeballs: vertices that lie on one, so far apart that the edges between them cut into it. */
#include "math/vec.h"
#include "rig/deform/arc.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/unit.h"

static const double straight[3] = { 0 };

/* Three vertices of a face on the front of the globe, `apart` radians from each other, counter-clockwise from outside. */
static void put_on_globe(float (*x)[3], const struct rig *rig, const int32_t v[3], double apart)
{
	const struct rig_globe *g = &rig->globe[rig->side[v[0]]];
	const double angle = apart / sqrt(3);
	for (int k = 0; k < 3; k++) {
		const double turn = 2 * M_PI * k / 3, head[3] = { sin(angle) * cos(turn), sin(angle) * sin(turn), cos(angle) };
		double d[3];
		mat_tvec(d, rig->head_from_target, head);
		for (int c = 0; c < 3; c++)
			x[v[k]][c] = (float)(g->center[c] + 1.3 * g->radius * d[c]);
		double R[3][3];
		rig_globe_rotation(R, rig, straight);
		const double far = rig_globe_distance(rig, rig->side[v[0]], (const double(*)[3])R, x[v[k]]) - 0.05;
		for (int c = 0; c < 3; c++)
			x[v[k]][c] -= (float)(far * d[c]);
	}
}

/* Least distance of the middles of a face and of its edges. */
static double least_of(const struct rig *rig, const float (*x)[3], const int32_t v[3])
{
	double R[3][3], least = INFINITY;
	rig_globe_rotation(R, rig, straight);
	for (int k = 0; k < 4; k++) {
		float at[3];
		for (int c = 0; c < 3; c++)
			at[c] = k < 3 ? 0.5f * (x[v[k]][c] + x[v[(k + 1) % 3]][c]) : (x[v[0]][c] + x[v[1]][c] + x[v[2]][c]) / 3;
		least = fmin(least, rig_globe_distance(rig, rig->side[v[0]], (const double(*)[3])R, at));
	}
	return least;
}

static void edges_are_lifted_off_the_eye(void **state)
{
	(void)state;
	struct face face;
	struct rig rig;
	struct rig_conf conf = face_conf();
	struct err err = { 0 };
	face_make(&face, false);
	conf.map_step = 4;
	assert_true(face_rig(&rig, 0, &face, &conf, &err));
	struct deform_near near = deform_near_of(&rig);
	float (*x)[3] = calloc((size_t)rig.n, sizeof *x);
	double turn[2][3][3];
	int tried = 0;
	assert_true(near.n > 0);
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(turn[s], &rig, straight);
	for (int i = 0; i < near.n && tried < 5; i++) {
		const int32_t *v = rig.faces[near.face[i]];
		if (!near.moves[v[0]] || !near.moves[v[1]] || !near.moves[v[2]])
			continue;
		struct deform_near one = { .n = 1, .face = &near.face[i], .moves = near.moves, .rooms = near.rooms };
		memcpy(x, rig.rest, (size_t)rig.n * sizeof *x);
		put_on_globe(x, &rig, v, 0.4);
		assert_true(least_of(&rig, (const float(*)[3])x, v) < -0.1);
		deform_clear(x, &rig, &one, (const double(*)[3][3])turn);
		assert_true(least_of(&rig, (const float(*)[3])x, v) > 0);
		NEAR(least_of(&rig, (const float(*)[3])x, v), DEFORM_CLEAR_MM, 0.1);  // and no further than that takes
		for (int k = 0; k < rig.n; k++)
			if (k != v[0] && k != v[1] && k != v[2])
				assert_memory_equal(x[k], rig.rest[k], sizeof x[k]);
		tried++;
	}
	assert_int_equal(tried, 5);
	free(x);
	deform_near_free(&near);
	rig_free(&rig);
	face_free(&face);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(edges_are_lifted_off_the_eye),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
