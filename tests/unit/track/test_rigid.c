/* The mesh laid on a picture by how its skin moves: a relief whose points turn before a camera, seen with noise; the pose in the reference must come out from
 * a start that is wrong by many degrees. And motions of a head as the inverse of each other. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "tests/lib/unit.h"
#include "track/head/rigid.h"

enum { SIDE = 41, POINTS = 120, FRAMES = 12 };

static const struct camera camera = { .focal_px = 3000, .center_px = { 640, 360 } };

/* A nose between two hollows on a curved cheek, mm. */
static double relief(double x, double y)
{
	return 30 * exp(-(x * x / 120 + y * y / 700)) - 9 * exp(-(pow(fabs(x) - 30, 2) + pow(y - 20, 2)) / 160) - 0.006 * x * x - 0.003 * y * y;
}

static struct mesh make_relief(void)
{
	struct mesh m = { .n_vertices = SIDE * SIDE, .n_faces = 2 * (SIDE - 1) * (SIDE - 1) };
	m.vertices = mem_new((size_t)m.n_vertices, sizeof *m.vertices);
	m.faces = mem_new((size_t)m.n_faces, sizeof *m.faces);
	for (int i = 0; i < m.n_vertices; i++) {
		double x = 4.0 * (i % SIDE - SIDE / 2), y = 4.0 * (i / SIDE - SIDE / 2);
		m.vertices[i][0] = (float)x;
		m.vertices[i][1] = (float)y;
		m.vertices[i][2] = (float)relief(x, y);
	}
	for (int i = 0, f = 0; i < (SIDE - 1) * (SIDE - 1); i++) {
		const int32_t a = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
		const int32_t two[2][3] = { { a, a + 1, a + SIDE + 1 }, { a, a + SIDE + 1, a + SIDE } };
		memcpy(m.faces[f++], two[0], sizeof two[0]);
		memcpy(m.faces[f++], two[1], sizeof two[1]);
	}
	return m;
}

static void pose_of(double m[4][4], double yaw, double pitch, double x, double z)
{
	const double facing[4][4] = { { 1, 0, 0, x }, { 0, -1, 0, 0 }, { 0, 0, -1, z }, { 0, 0, 0, 1 } }, d[6] = { pitch, yaw }, at[3] = { x, 0, z };
	head_moved(m, facing, d, at);
}

struct film {
	double at[POINTS][2], weight[POINTS], pose[4][4];
	float px[FRAMES][POINTS][2], seen[FRAMES][POINTS];
};

/* Points of the relief, seen from `amount` times a talking head's turns; noise in px. */
static void make_film(struct film *f, double amount, double noise)
{
	struct rng rng = { 11 };
	pose_of(f->pose, 0.15, -0.1, 5, 600);
	for (int i = 0; i < POINTS; i++) {
		double x = 100 * (rng_uniform(&rng) - 0.5), y = 100 * (rng_uniform(&rng) - 0.5), head[3] = { x, y, relief(x, y) }, px[2];
		f->weight[i] = 1;
		head_project(f->at[i], &camera, (const double(*)[4])f->pose, head);
		for (int k = 0; k < FRAMES; k++) {
			double m[4][4];
			pose_of(m, 0.15 + amount * 0.2 * sin(k), -0.1 + amount * 0.1 * sin(1.7 * k), 5 + 8 * sin(k), 600 + 10 * cos(k));
			head_project(px, &camera, (const double(*)[4])m, head);
			f->seen[k][i] = 1;
			for (int c = 0; c < 2; c++)
				f->px[k][i][c] = (float)(px[c] + noise * (rng_uniform(&rng) - 0.5));
		}
	}
}

static bool fit(double pose[4][4], struct rigid_fit *fit, const struct film *f, const struct mesh *mesh)
{
	const struct rigid_film film = { POINTS, FRAMES, f->at, f->weight, &f->px[0][0], &f->seen[0][0] };
	struct rigid_anchor anchor[2];
	for (int e = 0; e < 2; e++) {
		anchor[e] = (struct rigid_anchor){ .head = { e ? -30 : 30, 20, relief(30, 20) }, .sigma_px = 25 };
		head_project(anchor[e].px, &camera, f->pose, anchor[e].head);
		anchor[e].px[0] += 8;
	}
	pose_of(pose, 0, 0, 3, 640);
	return rigid_fit(pose, fit, &film, mesh, &camera, 2, anchor, (const double[2]){ 0.5, 0.3 }, 1.5);
}

static double degrees_off(const double a[4][4], const double b[4][4])
{
	double d[6], none[3] = { 0 };
	head_motion(d, a, b, none);
	return vec_norm(d) * 180 / M_PI;
}

static void a_head_that_turns_tells_its_pose(void **state)
{
	(void)state;
	struct mesh mesh = make_relief();
	struct film *f = mem_new(1, sizeof *f);
	struct rigid_fit got;
	double pose[4][4];
	make_film(f, 1, 1);
	assert_true(fit(pose, &got, f, &mesh));
	// faces of 4 mm stand for a smooth relief, and noise of 0.3 px
	NEAR(degrees_off((const double(*)[4])pose, (const double(*)[4])f->pose), 0, 0.3);
	assert_true(got.turned > 15 * M_PI / 180 && got.apart < 2 * M_PI / 180 && got.off_px < 0.7);
	free(f);
	mesh_free(&mesh);
}

static void a_head_at_rest_does_not(void **state)
{
	(void)state;
	struct mesh mesh = make_relief();
	struct film *f = mem_new(1, sizeof *f);
	struct rigid_fit got;
	double pose[4][4];
	make_film(f, 0, 1);
	assert_true(!fit(pose, &got, f, &mesh) || got.turned < 3 * M_PI / 180 || hypot(got.sigma[0], got.sigma[1]) > 0.5 * M_PI / 180);
	free(f);
	mesh_free(&mesh);
}

/* Another relief than the one that moved: its halves tell different poses, or it fits badly. */
static void another_mesh_is_told(void **state)
{
	(void)state;
	struct mesh mesh = make_relief();
	struct film *f = mem_new(1, sizeof *f);
	struct rigid_fit got;
	double pose[4][4];
	make_film(f, 1, 1);
	for (int i = 0; i < mesh.n_vertices; i++)
		mesh.vertices[i][2] = (float)(15 * sin((double)mesh.vertices[i][0] / 13 + 1) * cos((double)mesh.vertices[i][1] / 17));
	assert_true(!fit(pose, &got, f, &mesh) || got.apart > 4 * M_PI / 180 || got.off_px > 1);
	free(f);
	mesh_free(&mesh);
}

/* Large motions too: a path of poses written as motions since the reference comes back as it was. */
static void motions_are_inverse(void **state)
{
	(void)state;
	double from[4][4], to[4][4], again[4][4], d[6];
	const double pivot[3] = { 20, -15, 550 };
	pose_of(from, 0.1, -0.2, 5, 600);
	pose_of(to, -0.6, 0.3, -60, 480);
	head_motion(d, (const double(*)[4])to, (const double(*)[4])from, pivot);
	head_moved(again, (const double(*)[4])from, d, pivot);
	for (int i = 0; i < 16; i++)
		NEAR(again[i / 4][i % 4], to[i / 4][i % 4], 1e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_head_that_turns_tells_its_pose),
		cmocka_unit_test(a_head_at_rest_does_not),
		cmocka_unit_test(another_mesh_is_told),
		cmocka_unit_test(motions_are_inverse),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
