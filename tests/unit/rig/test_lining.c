/* lining: a made face, whose skin ends at its lids' edges, gets a lining and caruncles: the surface is whole there, rays find no way in beside the eyeball
 * at any gaze and opening, nothing of it is in the eyeball, what was there stays as it was; caruncles are seen in open eyes alone. */
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/ray.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/unit.h"

struct both {
	struct face face;
	struct rig with, without;
};

static int setup(void **state)
{
	struct both *b = calloc(1, sizeof *b);
	struct rig_conf conf = face_conf();
	struct err err = { 0 };
	*state = b;
	face_make(&b->face, false);
	conf.lid = 6;
	conf.seal = 0.15;
	bool ok = face_rig(&b->without, 0, &b->face, &conf, &err);
	conf.lining = 3;
	conf.caruncle = 2.6;
	return ok && face_rig(&b->with, 0, &b->face, &conf, &err) ? 0 : 1;
}

static int teardown(void **state)
{
	struct both *b = *state;
	rig_free(&b->with);
	rig_free(&b->without);
	face_free(&b->face);
	free(b);
	return 0;
}

static void what_was_there_stays(void **state)
{
	const struct both *b = *state;
	const struct rig *p = &b->with, *q = &b->without;
	assert_int_equal(rig_own_vertices(p), q->n);
	assert_int_equal(rig_own_faces(p), q->n_faces);
	assert_int_equal(rig_own_vertices(q), q->n);
	assert_true(p->n > q->n + 200 && p->n_faces > q->n_faces + 300);
	assert_memory_equal(p->rest, q->rest, (size_t)q->n * sizeof *q->rest);
	assert_memory_equal(p->basis, q->basis, (size_t)q->n * sizeof *q->basis);
	assert_memory_equal(p->gap, q->gap, (size_t)q->n * sizeof *q->gap);
	assert_memory_equal(p->faces, q->faces, (size_t)q->n_faces * sizeof *q->faces);
	for (int i = q->n; i < p->n; i++) {
		double sum = 0;
		for (int j = p->bplus.start[i]; j < p->bplus.start[i + 1]; j++) {
			assert_true(p->bplus.column[j] < q->n && p->part[p->bplus.column[j]] == RIG_SKIN && p->side[p->bplus.column[j]] == p->side[i]);
			sum += (double)p->bplus.weight[j];
		}
		NEAR(sum, 1, 1e-5);  // sums of floats
	}
}

/* No edge of the skin's surface is left near an eye, and each way along an edge is taken by one face: all look to the same side. */
static void the_surface_is_whole(void **state)
{
	const struct both *b = *state;
	for (int with = 0; with < 2; with++) {
		const struct rig *rig = with ? &b->with : &b->without;
		int open = 0, twice = 0;
		for (int f = 0; f < 3 * rig->n_faces; f++) {
			const int32_t *v = rig->faces[f / 3], from = v[f % 3], to = v[(f + 1) % 3];
			int same = 0, back = 0;
			if (rig->part[from] != RIG_SKIN || rig->part[to] != RIG_SKIN || rig->gap[from] > 4)
				continue;
			for (int g = 0; g < 3 * rig->n_faces; g++) {
				const int32_t p = rig->faces[g / 3][g % 3], q = rig->faces[g / 3][(g + 1) % 3];
				same += p == from && q == to;
				back += p == to && q == from;
			}
			open += !back;
			twice += same != 1;
		}
		assert_int_equal(twice, 0);
		if (with)
			assert_int_equal(open, 0);
		else
			assert_true(open > 40);
	}
}

/* Of rays from all about the front through places round an eye, those that meet nothing, or the inner side of skin. shut: lids overlap, and that side of
 * theirs is seen from below: the first alone. */
static int ways_in(const struct rig *rig, const struct ray_scene *scene, int side, const float (*x)[3], bool shut)
{
	enum { PLACES = 40, TURNS = 5 };
	int in = 0;
	for (int turn = 0; turn < TURNS * TURNS; turn++) {
		const double yaw = 0.35 * (turn % TURNS - TURNS / 2), pitch = 0.3 * (turn / TURNS - TURNS / 2);
		const double way[3] = { -sin(yaw) * cos(pitch), -sin(pitch), -cos(yaw) * cos(pitch) };
		for (int k = 0; k < PLACES * PLACES; k++) {
			const double place[3] = { 14 * (2 * (k % PLACES + 0.5) / PLACES - 1), 8 * (2 * (k / PLACES + 0.5) / PLACES - 1), 10 };
			float from[3], dir[3];
			double normal[3], a[3], c[3];
			for (int i = 0; i < 3; i++) {
				from[i] = (float)(rig->globe[side].center[i] + place[i] - 60 * way[i]);
				dir[i] = (float)way[i];
			}
			const struct ray_hit hit = ray_first(scene, from, dir, 0, 200);
			if (hit.face < 0) {
				in++;
				continue;
			}
			const int32_t *v = rig->faces[hit.face];
			for (int i = 0; i < 3; i++) {
				a[i] = (double)x[v[1]][i] - (double)x[v[0]][i];
				c[i] = (double)x[v[2]][i] - (double)x[v[0]][i];
			}
			vec_cross(normal, a, c);
			in += !shut && rig->part[v[0]] == RIG_SKIN && vec_dot(normal, way) > 0;
		}
	}
	return in;
}

/* Pose, and least distance of what is not the eyeball's from it. */
static double posed(float (*x)[3], const struct rig *rig, const struct deform *deform, const struct deform_near *near, double h, double v, double open)
{
	double c[12], e[RIG_COMPONENTS], turn[2][3][3], least = INFINITY;
	drive_look(c, rig, h, v, open);
	rig_components(e, rig, c);
	rig_globes_turned(turn, rig, c);
	deform_rest(deform, x, 0);
	deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
	deform_settle(x, rig, near, (const double(*)[3][3])turn, 0);
	for (int i = 0; i < rig->n; i++)
		if (rig->part[i] == RIG_LINING)
			least = fmin(least, rig_globe_distance(rig, rig->side[i], (const double(*)[3])turn[rig->side[i]], x[i]));
	return least;
}

static void no_way_in_at_any_gaze(void **state)
{
	const struct both *b = *state;
	static const double across[] = { -20, 0, 20 }, up[] = { 15, 0, -25 }, open[] = { 1, 0.5, 0 };
	int in[2] = { 0, 0 };
	double least = INFINITY;
	for (int with = 0; with < 2; with++) {
		const struct rig *rig = with ? &b->with : &b->without;
		struct deform *deform = deform_new(rig);
		struct deform_near near = deform_near_of(rig);
		float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x);
		struct ray_scene *scene = ray_scene_new(rig->n, (const float(*)[3])rig->rest, rig->n_faces, (const int32_t(*)[3])rig->faces);
		for (int k = 0; k < 27; k++) {
			const double off = posed(x, rig, deform, &near, across[k % 3], up[k / 3 % 3], open[k / 9]);
			least = with ? fmin(least, off) : least;
			ray_scene_move(scene, (const float(*)[3])x);
			for (int side = 0; side < 2; side++)
				in[with] += ways_in(rig, scene, side, (const float(*)[3])x, open[k / 9] == 0);
		}
		ray_scene_free(scene);
		deform_near_free(&near);
		deform_free(deform);
		free(x);
	}
	print_message("of 2160000 rays %d find a way in without lining, %d with it; the nearest of it is %.3f mm off\n", in[0], in[1], least);
	assert_true(in[0] > 1000);
	assert_int_equal(in[1], 0);
	assert_true(least > 0);
}

/* What the front sees of caruncle and plica, which stand higher over the eyeball than the feet of the lining: mm^2 of the inner and outer half of an opening. */
static void seen_of(double area[2], const struct rig *rig, const struct ray_scene *scene, int side)
{
	area[0] = area[1] = 0;
	for (int k = 0; k < 300 * 200; k++) {
		const double x = 0.1 * (k % 300 - 150), y = 0.1 * (k / 300 - 100);
		float from[3] = { (float)(rig->globe[side].center[0] + x), (float)(rig->globe[side].center[1] + y), (float)rig->globe[side].center[2] + 60 };
		const struct ray_hit hit = ray_first(scene, from, (float[]){ 0, 0, -1 }, 0, 200);
		bool high = hit.face >= 0;
		for (int i = 0; i < 3 && high; i++)
			high = rig->part[rig->faces[hit.face][i]] == RIG_LINING && rig->gap[rig->faces[hit.face][i]] > 0.1f;
		if (high)
			area[side ? x < 0 : x > 0] += 0.01;
	}
}

static void caruncles_are_seen_in_open_eyes(void **state)
{
	const struct both *b = *state;
	const struct rig *rig = &b->with;
	struct deform *deform = deform_new(rig);
	struct deform_near near = deform_near_of(rig);
	float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x);
	struct ray_scene *scene = ray_scene_new(rig->n, (const float(*)[3])rig->rest, rig->n_faces, (const int32_t(*)[3])rig->faces);
	for (int shut = 0; shut < 2; shut++) {
		posed(x, rig, deform, &near, 0, 0, !shut);
		ray_scene_move(scene, (const float(*)[3])x);
		for (int side = 0; side < 2; side++) {
			double area[2];
			seen_of(area, rig, scene, side);
			print_message("%s, %d: %.2f mm^2 of the inner corner, %.2f of the outer one\n", shut ? "shut" : "open", side, area[0], area[1]);
			if (shut)
				assert_true(area[0] + area[1] < 0.1);
			else
				assert_true(area[0] > 1 && area[0] < 20 && area[1] == 0);
		}
	}
	ray_scene_free(scene);
	deform_near_free(&near);
	deform_free(deform);
	free(x);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(what_was_there_stays), cmocka_unit_test(the_surface_is_whole), cmocka_unit_test(no_way_in_at_any_gaze),
		                                cmocka_unit_test(caruncles_are_seen_in_open_eyes) };
	return cmocka_run_group_tests(tests, setup, teardown);
}
