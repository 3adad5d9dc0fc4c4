/* Registration against closed forms: similarities recovered, graphs that do not strain under affine maps, surfaces found
 * from another tessellation, and meshes with everything wrong. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "math/spd.h"
#include "mesh/closest.h"
#include "mesh/mesh_part.h"
#include "mesh/topology.h"
#include "register/nricp/energy.h"
#include "register/nricp/unfold.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/pair.h"
#include "tests/lib/scenes/sheet.h"
#include "tests/lib/conf/transfer_conf.h"

static const double same[4][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } };

/* Second differences, held at one end: x_i = i (2 n - i + 1) / 2 solves it for ones. */
static void test_spd(void **state)
{
	(void)state;
	enum { N = 50 };
	int32_t start[N + 1], column[3 * N], at = 0;
	double value[3 * N], b[N];
	for (int i = 0; i < N; i++) {
		start[i] = at;
		for (int j = i - 1; j <= i + 1; j++)
			if (j >= 0 && j < N) {
				column[at] = j;
				value[at++] = i == j ? (i == N - 1 ? 1 : 2) : -1;
			}
		b[i] = 1;
	}
	start[N] = at;
	struct spd *spd = spd_new(N, start, column);
	assert_true(spd_factor(spd, value));
	spd_solve(spd, b, b);
	for (int i = 0; i < N; i++)
		NEAR(b[i], (i + 1) * (2.0 * N - i) / 2, 1e-9 * N * N);
	value[0] = -1;
	assert_false(spd_factor(spd, value));
	spd_free(spd);
}

/* No vertex and no point of a face is closer than the closest point, wherever the mesh lies, and a guess changes nothing. */
static void closest_on(float far)
{
	static const double inside[][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0.5, 0.5, 0 }, { 0, 0.5, 0.5 },
		                            { 0.5, 0, 0.5 }, { 0.6, 0.2, 0.2 }, { 0.2, 0.6, 0.2 }, { 0.2, 0.2, 0.6 } };
	struct mesh m = sheet_make(40, 30, true);
	for (int i = 0; i < m.n_vertices; i++)
		m.vertices[i][0] += far;
	double rounding = 4e-7 * (double)far;  // of the coordinates
	struct closest_scene *scene = closest_new(&m, 0);
	for (int i = 0; i < 50; i++) {
		float at[3] = { far + (float)(-70 + 3 * i), (float)(65 - 2.6 * i), (float)(-20 + i) };
		struct closest_point got = closest_find(scene, at, 0, 0, INFINITY, -1);
		double best = INFINITY;
		for (int k = 0; k < m.n_faces * 9; k++) {
			double d2 = 0;
			for (int c = 0; c < 3; c++) {
				double p = -(double)at[c];
				for (int v = 0; v < 3; v++)
					p += inside[k % 9][v] * (double)m.vertices[m.faces[k / 9][v]][c];
				d2 += p * p;
			}
			best = fmin(best, sqrt(d2));
		}
		assert_true(got.face >= 0 && (double)got.distance <= best * (1 + 1e-5) + rounding);
		NEAR(got.bary[0] + got.bary[1] + got.bary[2], 1, 1e-5);
		for (int guess = 0; guess < m.n_faces; guess += 97)  // a guess changes nothing
			NEAR(closest_find(scene, at, 0, 0, INFINITY, guess).distance, got.distance, 1e-5 + rounding);
	}
	float nan[3] = { NAN, 0, 0 };
	assert_int_equal(closest_find(scene, nan, 0, 0, INFINITY, -1).face, -1);
	closest_free(scene);
	mesh_free(&m);
}

static void test_closest(void **state)
{
	(void)state;
	closest_on(0);
	closest_on(1e4f);
}

/* 40 x 30 vertices: an Euler count, one rim without slits, three with; a piece each that is joined on. */
static void test_topology(void **state)
{
	(void)state;
	struct mesh a = sheet_make(40, 30, false), b = sheet_make(10, 10, false), both = sheet_joined(&a, &b);
	struct topology t;
	topology_make(&t, &both);
	assert_int_equal(t.n_pieces, 2);
	assert_int_equal(t.piece[0], 0);
	assert_int_equal(t.piece[a.n_vertices], 1);
	assert_int_equal(t.n_rim, 2 * (39 + 29) + 4 * 9);
	assert_int_equal(t.n_tangled, 0);
	topology_free(&t);
	struct mesh_part part;
	mesh_part_make(&part, &both, 0, 0);
	assert_int_equal(part.doubled, 8);  // at x = -60, -20, 20, 60 and y = -60, 60 both have a vertex
	assert_int_equal(part.mesh.n_vertices, a.n_vertices + b.n_vertices - 8);
	mesh_part_free(&part);
	mesh_free(&a);
	mesh_free(&b);
	mesh_free(&both);
}

static struct nricp_graph graph_of(const struct mesh *m)
{
	struct topology t;
	struct nricp_graph g;
	topology_make(&t, m);
	double (*place)[4] = mem_new((size_t)t.n, sizeof *place), *area = mesh_vertex_areas(m);
	for (int i = 0; i < t.n; i++)
		for (int k = 0; k < 3; k++)
			place[i][k] = m->vertices[i][k];
	nricp_graph_make(&g, t.n, (const double(*)[4])place, area, t.start, t.neighbour, 6);
	free(place);
	free(area);
	topology_free(&t);
	return g;
}

/* A rotation costs nothing once the turns are known: R t = pull; the turns found are the rotation. */
static void test_rotation_is_free(void **state)
{
	(void)state;
	struct mesh m = sheet_make(30, 25, true), turned = sheet_make(30, 25, true);
	double shift[3] = { 4, -3, 2 };
	sheet_move(&turned, 1, 0.6, shift);
	struct nricp_graph g = graph_of(&m);
	double (*t)[4] = mem_new((size_t)g.n, sizeof *t), (*pull)[4] = mem_new((size_t)g.n, sizeof *pull);
	double (*turn)[9] = mem_new((size_t)g.n, sizeof *turn);
	for (int i = 0; i < g.n; i++)
		for (int k = 0; k < 3; k++)
			t[i][k] = (double)turned.vertices[i][k] - (double)m.vertices[i][k];
	for (int pass = 0; pass < 600; pass++)  // each finds a rotation that the last one holds back
		nricp_graph_turns(turn, &g, (const double(*)[4])t, 0);
	nricp_graph_pull(pull, &g, (const double(*)[9])turn);
	double largest = 0, off = 0;
	for (int i = 0; i < g.n; i++) {
		if (!(g.spacing2[i] > 0))
			continue;
		NEAR(1 + turn[i][0], (1 + 2 * cos(0.6)) / 3, 1e-4);  // of the axis (1, 1, 1); vertices are floats
		for (int k = 0; k < 3; k++) {
			double rt = 0;
			for (int32_t e = g.r_start[i]; e < g.r_start[i + 1]; e++)
				rt += g.r_value[e] * t[g.r_column[e]][k];
			off = fmax(off, fabs(rt - pull[i][k]));
			largest = fmax(largest, fabs(pull[i][k]));
		}
	}
	assert_true(largest > 0 && off < 1e-3 * largest);
	nricp_graph_free(&g);
	free(t);
	free(pull);
	free(turn);
	mesh_free(&m);
	mesh_free(&turned);
}

/* Coarser graphs carry an affine map over exactly, where rigidity is left out. */
static void test_spread(void **state)
{
	(void)state;
	struct mesh m = sheet_make(60, 50, false);
	struct nricp_graph fine = graph_of(&m), coarse;
	nricp_graph_coarser(&coarse, &fine, 200, 1e6);
	assert_in_range(coarse.n, 100, 400);
	double (*t)[4] = mem_new((size_t)coarse.n, sizeof *t), (*to)[4] = mem_new((size_t)fine.n, sizeof *to);
	static const double a[3][4] = { { 0.1, 0.2, -0.1, 3 }, { -0.3, 0.05, 0.2, -1 }, { 0.15, -0.1, -0.2, 2 } };
	for (int i = 0; i < coarse.n; i++)
		for (int r = 0; r < 3; r++)
			t[i][r] = a[r][0] * coarse.place[i][0] + a[r][1] * coarse.place[i][1] + a[r][2] * coarse.place[i][2] + a[r][3];
	nricp_graph_spread(to, &fine, &coarse, (const double(*)[4])t);
	for (int i = 0; i < fine.n; i++)
		for (int r = 0; r < 3; r++)
			NEAR(to[i][r], a[r][0] * fine.place[i][0] + a[r][1] * fine.place[i][1] + a[r][2] * fine.place[i][2] + a[r][3], 0.1);  // of 20 mm; a planar star does not see the map across it
	free(t);
	free(to);
	nricp_graph_free(&fine);
	nricp_graph_free(&coarse);
	mesh_free(&m);
}

/* A known similarity of another tessellation is found from where the meshes lie. */
static void test_align(void **state)
{
	(void)state;
	struct mesh fixed = sheet_make(70, 60, true), moving = sheet_make(53, 47, true);
	double shift[3] = { 6, 9, -4 };
	sheet_move(&moving, 1.1, 0.3, shift);
	struct nricp_align_result pose;
	struct err err = { 0 };
	assert_true(nricp_align(&pose, &moving, &fixed, 0, &transfer_defaults.align, &err));
	NEAR(pose.scale, 1 / 1.1, 0.004);
	for (int i = 0; i < moving.n_vertices; i += 11) {
		double x = -60 + 120.0 * (i % 53) / 52, y = -60 + 120.0 * (double)(i / 53) / 46, want[3] = { x, y, sheet_height(x, y) };
		for (int r = 0; r < 3; r++) {
			double got = pose.fixed_from_moving[r][3];
			for (int c = 0; c < 3; c++)
				got += pose.fixed_from_moving[r][c] * (double)moving.vertices[i][c];
			NEAR(got, want[r], 0.6);  // chords of the coarser sheet lie up to 0.3 mm off the surface
		}
	}
	mesh_free(&moving);
	mesh_free(&fixed);
}

static double off_surface(const struct nricp_result *r, int n)
{
	double sum = 0;
	int inside = 0;
	for (int i = 0; i < n; i++)
		if (fabsf(r->place[i][0]) < 58 && fabsf(r->place[i][1]) < 58) {
			sum += fabs(sheet_height((double)r->place[i][0], (double)r->place[i][1]) - (double)r->place[i][2]);
			inside++;
		}
	return inside ? sum / inside : INFINITY;
}

static bool is_finite(const struct nricp_result *r, int n)
{
	for (int i = 0; i < n; i++)
		for (int k = 0; k < 3; k++)
			if (!isfinite(r->place[i][k]) || !(r->confidence[i] >= 0 && r->confidence[i] <= 1))
				return false;
	return true;
}

/* A smooth bend of the sheet is undone. */
static void test_bend(void **state)
{
	(void)state;
	struct mesh fixed = sheet_make(90, 80, true), moving = sheet_make(70, 64, true);
	for (int i = 0; i < moving.n_vertices; i++) {
		float *v = moving.vertices[i];
		v[2] += 4 * sinf(v[0] / 30) * cosf(v[1] / 40);
		v[0] *= 1.04f;
	}
	struct nricp_result r;
	struct err err = { 0 };
	assert_true(nricp_run(&r, &moving, &fixed, same, &transfer_defaults.nricp, &err));
	assert_true(off_surface(&r, moving.n_vertices) < 0.1);  // 4 mm were off; chords are up to 0.1
	assert_true(is_finite(&r, moving.n_vertices) && r.covered > 0.9);
	nricp_result_free(&r);
	mesh_free(&moving);
	mesh_free(&fixed);
}

/* What a mesh of unknown origin may hold: no surface, needles, points on each other, loose points, three faces at an edge. */
static void test_hostile(void **state)
{
	(void)state;
	struct mesh fixed = sheet_make(40, 40, false), moving = sheet_make(33, 31, false), none = { 0 };
	struct nricp_result r;
	struct err err = { 0 };
	assert_false(nricp_run(&r, &none, &fixed, same, &transfer_defaults.nricp, &err));
	ERR_HAS(err, "no surface");
	err = (struct err){ 0 };
	assert_false(nricp_run(&r, &moving, &none, same, &transfer_defaults.nricp, &err));
	ERR_HAS(err, "no surface");
	err = (struct err){ 0 };
	memcpy(moving.vertices[100], moving.vertices[101], sizeof *moving.vertices);
	memcpy(moving.faces[0], (int32_t[]){ 5, 5, 9 }, sizeof *moving.faces);
	memcpy(moving.faces[40], (int32_t[]){ 200, 201, 700 }, sizeof *moving.faces);
	memcpy(moving.faces[41], (int32_t[]){ 200, 201, 800 }, sizeof *moving.faces);
	moving.vertices[500][2] += 4000;
	memset(fixed.vertices[77], 0, sizeof *fixed.vertices);
	moving.n_faces -= 20;  // the last row of vertices is loose
	assert_true(nricp_run(&r, &moving, &fixed, same, &transfer_defaults.nricp, &err));
	assert_true(is_finite(&r, moving.n_vertices));
	nricp_result_free(&r);
	mesh_free(&moving);
	mesh_free(&fixed);
}

/* Triangles folded by hand lie flat again, and what is far from them stays. */
static void test_unfold(void **state)
{
	(void)state;
	struct mesh m = sheet_make(40, 40, false);
	struct nricp_graph g = graph_of(&m);
	struct nricp_point *p = mem_new((size_t)m.n_vertices, sizeof *p);
	for (int i = 0; i < m.n_vertices; i++)
		memcpy(p[i].at, m.vertices[i], sizeof p[i].at);
	p[815].at[0] += 8;
	p[816].at[1] -= 9;
	assert_int_equal(nricp_unfold(p, &m, &g), 0);
	for (int i = 0; i < 400; i++)
		assert_memory_equal(p[i].at, m.vertices[i], sizeof p[i].at);
	free(p);
	nricp_graph_free(&g);
	mesh_free(&m);
}

/* A pair with truth: better than every published figure for it, and nothing folded. */
static void test_pair(void **state)
{
	(void)state;
	struct pair pair;
	struct err err = { 0 };
	if (!pair_load(&pair, "ict_id_rot20", &err)) {
		print_message("%s: skipped\n", err.msg);
		skip();
	}
	struct transfer t;
	assert_true(transfer_run(&t, &pair.source, &pair.target, 0, &transfer_defaults, &err));
	struct pair_error e = pair_measure(&pair, (const float(*)[3])t.registered);
	assert_true(e.surface < 0.0256 && e.truth < 0.213);
	assert_int_equal(e.flipped, 0);
	transfer_free(&t);
	pair_free(&pair);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_spd),   cmocka_unit_test(test_closest), cmocka_unit_test(test_topology), cmocka_unit_test(test_rotation_is_free),
		cmocka_unit_test(test_spread), cmocka_unit_test(test_align),  cmocka_unit_test(test_bend),     cmocka_unit_test(test_hostile),
		cmocka_unit_test(test_unfold), cmocka_unit_test(test_pair),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
