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

/* A made character at rest, its eyes straight. */
struct scene {
	struct face face;
	struct rig rig;
	struct deform_near near;
	float (*x)[3];
	double turn[2][3][3];
};

static int setup(void **state)
{
	struct scene *s = calloc(1, sizeof *s);
	struct rig_conf conf = face_conf();
	struct err err = { 0 };
	face_make(&s->face, false);
	conf.map_step = 4;
	if (!face_rig(&s->rig, 0, &s->face, &conf, &err))
		return 1;
	s->near = deform_near_of(&s->rig);
	s->x = calloc((size_t)s->rig.n, sizeof *s->x);
	for (int e = 0; e < 2; e++)
		rig_globe_rotation(s->turn[e], &s->rig, straight);
	*state = s;
	return 0;
}

static int teardown(void **state)
{
	struct scene *s = *state;
	free(s->x);
	deform_near_free(&s->near);
	rig_free(&s->rig);
	face_free(&s->face);
	free(s);
	return 0;
}

static void edges_are_lifted_off_the_eye(void **state)
{
	struct scene *s = *state;
	const struct rig *rig = &s->rig;
	float (*x)[3] = s->x;
	int tried = 0;
	assert_true(s->near.n > 0);
	for (int i = 0; i < s->near.n && tried < 6; i++) {
		const int32_t *v = rig->faces[s->near.face[i]];
		if (!s->near.moves[v[0]] || !s->near.moves[v[1]] || !s->near.moves[v[2]])
			continue;
		// As it is, outside of a lid; turned round, what lines one.
		int32_t turned[3] = { v[0], v[tried % 2 ? 2 : 1], v[tried % 2 ? 1 : 2] };
		memcpy(rig->faces[s->near.face[i]], turned, sizeof turned);
		struct deform_near one = { .n = 1, .face = &s->near.face[i], .moves = s->near.moves, .rooms = s->near.rooms };
		memcpy(x, rig->rest, (size_t)rig->n * sizeof *x);
		put_on_globe(x, rig, v, 0.4);
		assert_true(least_of(rig, (const float(*)[3])x, v) < -0.1);
		deform_clear(x, rig, &one, (const double(*)[3][3])s->turn);
		assert_true(least_of(rig, (const float(*)[3])x, v) > 0);
		NEAR(least_of(rig, (const float(*)[3])x, v), DEFORM_CLEAR_MM, 0.1);  // and no further than that takes
		for (int k = 0; k < rig->n; k++)
			if (k != v[0] && k != v[1] && k != v[2])
				assert_memory_equal(x[k], rig->rest[k], sizeof x[k]);
		tried++;
	}
	assert_int_equal(tried, 6);
}

/* What lines a lid goes no further than half of the way to its outside, however deep it lies: a face far in the eye, another 0.6 mm over it. */
static void linings_stay_below_lids(void **state)
{
	struct scene *s = *state;
	const struct rig *rig = &s->rig;
	float (*x)[3] = s->x;
	int pair[2] = { -1, -1 };
	for (int i = 0; i < s->near.n && pair[1] < 0; i++) {
		const int32_t *v = rig->faces[s->near.face[i]], *w = pair[0] < 0 ? 0 : rig->faces[s->near.face[pair[0]]];
		bool apart = s->near.moves[v[0]] && s->near.moves[v[1]] && s->near.moves[v[2]];
		for (int k = 0; k < 9 && w; k++)
			apart = apart && v[k / 3] != w[k % 3] && rig->side[v[0]] == rig->side[w[0]];
		if (apart)
			pair[w != 0] = i;
	}
	assert_true(pair[1] >= 0);
	const int32_t *v = rig->faces[s->near.face[pair[0]]], *over = rig->faces[s->near.face[pair[1]]];
	const double *center = rig->globe[rig->side[v[0]]].center;
	memcpy(x, rig->rest, (size_t)rig->n * sizeof *x);
	put_on_globe(x, rig, v, 0.7);
	put_on_globe(x, rig, over, 1.2);  // wide, over all of it
	for (int k = 0; k < 3; k++) {
		double d[3], far, lift;
		for (int c = 0; c < 3; c++)
			d[c] = x[over[k]][c] - center[c];
		far = vec_norm(d);
		lift = 5;
		for (int c = 0; c < 3; c++)
			x[over[k]][c] += (float)(lift * d[c] / far);
	}
	int faces[2] = { s->near.face[pair[0]], s->near.face[pair[1]] };
	struct deform_near both = { .n = 2, .face = faces, .moves = s->near.moves, .rooms = s->near.rooms };
	float was[3][3];
	double room[3];
	for (int k = 0; k < 3; k++) {  // along each corner's way off, to the plane of the face over it
		double a[3], b[3], n[3], d[3], o[3];
		memcpy(was[k], x[v[k]], sizeof was[k]);
		for (int c = 0; c < 3; c++) {
			a[c] = (double)x[over[1]][c] - (double)x[over[0]][c];
			b[c] = (double)x[over[2]][c] - (double)x[over[0]][c];
			d[c] = (double)was[k][c] - center[c];
			o[c] = (double)x[over[0]][c] - (double)was[k][c];
		}
		vec_cross(n, a, b);
		vec_unit(d, d);
		room[k] = vec_dot(o, n) / vec_dot(d, n);
		assert_true(room[k] > 0);
	}
	memcpy(rig->faces[faces[0]], (int32_t[]){ v[0], v[2], v[1] }, sizeof *rig->faces);
	for (int k = 0; k < 9; k++)
		rig->normal[v[k / 3]][k % 3] = (float)((center[k % 3] - (double)rig->rest[v[k / 3]][k % 3]) / rig->globe[0].radius);
	deform_clear(x, rig, &both, (const double(*)[3][3])s->turn);
	for (int k = 0; k < 3; k++) {
		double by[3];
		for (int c = 0; c < 3; c++)
			by[c] = (double)x[rig->faces[faces[0]][k]][c] - (double)was[k == 0 ? 0 : 3 - k][c];
		print_message("moved by %.3f mm of %.3f\n", vec_norm(by), room[k == 0 ? 0 : 3 - k]);
		assert_true(vec_norm(by) > 0.2 && vec_norm(by) < fmin(0.5 * room[k == 0 ? 0 : 3 - k], 0.5 * rig->globe[0].radius / 12) + 0.01);  // the other one gives way, too
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(edges_are_lifted_off_the_eye, setup, teardown),
		cmocka_unit_test_setup_teardown(linings_stay_below_lids, setup, teardown),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
