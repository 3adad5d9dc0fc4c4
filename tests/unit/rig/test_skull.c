/* Natural neighbours, the skull map and the globe map against closed forms. */
#include "math/natural.h"
#include "math/rng.h"
#include "rig/globe_map.h"
#include "rig/skull_map.h"
#include "tests/lib/unit.h"

enum { SITES = 600 };

static void scatter(double (*site)[2], int n, uint64_t seed)
{
	struct rng rng = { seed };
	for (int i = 0; i < n; i++) {
		site[i][0] = rng_range(&rng, 0, 100);
		site[i][1] = rng_range(&rng, 0, 60);
	}
}

static void natural_is_exact_on_affine_maps(void **state)
{
	(void)state;
	double site[SITES][2], worst = 0;
	struct err err = { 0 };
	struct rng rng = { 3 };
	int id[NATURAL_MAX], hint = 0, inside = 0;
	double w[NATURAL_MAX];
	scatter(site, SITES, 1);
	for (int i = 0; i < SITES; i += 3)  // a lattice among them: four on a circle, many on a line
		site[i][0] = 5 * (i / 3 % 20), site[i][1] = 5 * (i / 60);
	struct natural *nat = natural_new(SITES, (const double(*)[2])site, &err);
	assert_non_null(nat);
	for (int k = 0; k < 20000; k++) {
		double at[2] = { rng_range(&rng, 0, 100), rng_range(&rng, 0, 60) }, sum = 0, x = 0, y = 0;
		if (k % 2)  // on lines of the lattice, too
			at[0] = 5 * rng_below(&rng, 20);
		int n = natural_weights(id, w, nat, at, &hint);
		for (int i = 0; i < n; i++) {
			assert_true(w[i] >= 0);
			sum += w[i];
			x += w[i] * site[id[i]][0];
			y += w[i] * site[id[i]][1];
		}
		if (!n)
			continue;
		inside++;
		NEAR(sum, 1, 1e-12);
		worst = fmax(worst, hypot(x - at[0], y - at[1]));
	}
	natural_free(nat);
	assert_true(inside > 19000);
	NEAR(worst, 0, 1e-8);  // rounding of circumcentres of slivers
}

static void natural_at_a_site_is_that_site(void **state)
{
	(void)state;
	double site[SITES][2], w[NATURAL_MAX];
	struct err err = { 0 };
	int id[NATURAL_MAX], hint = 0;
	scatter(site, SITES, 2);
	struct natural *nat = natural_new(SITES, (const double(*)[2])site, &err);
	for (int i = 0; i < SITES; i++) {
		int n = natural_weights(id, w, nat, site[i], &hint);
		double own = 0;
		for (int k = 0; k < n; k++)
			own += id[k] == i ? w[k] : 0;
		if (n)  // rounding may put a site of the hull outside of it
			NEAR(own, 1, 1e-9);
	}
	assert_int_equal(natural_weights(id, w, nat, (double[]){ 300, 30 }, &hint), 0);
	natural_free(nat);
}

static void natural_refuses_a_line(void **state)
{
	(void)state;
	double site[9][2];
	struct err err = { 0 };
	for (int i = 0; i < 9; i++)
		site[i][0] = site[i][1] = i;
	assert_null(natural_new(9, (const double(*)[2])site, &err));
	ERR_HAS(err, "span no area");
	assert_null(natural_new(0, (const double(*)[2])site, &(struct err){ 0 }));
}

static void skull_map_of_a_plane_is_the_plane(void **state)
{
	(void)state;
	double site[SITES][2], box[4] = { -10, -10, 110, 70 };
	float position[SITES][3], normal[SITES][3];
	struct skull_map map;
	struct err err = { 0 };
	scatter(site, SITES, 4);
	for (int i = 0; i < SITES; i++)
		for (int c = 0; c < 3; c++) {
			position[i][c] = (float)((c + 1) * site[i][0] - 2 * c * site[i][1] + 5);
			normal[i][c] = c == 2;
		}
	assert_true(skull_map_make(&map, SITES, (const double(*)[2])site, (const float(*)[3])position, (const float(*)[3])normal, box,
	                           1.5, &err));
	struct rng rng = { 5 };
	for (int k = 0; k < 2000; k++) {  // beyond the sites, too: there the frame continues them
		float px[2] = { (float)rng_range(&rng, box[0], box[2]), (float)rng_range(&rng, box[1], box[3]) }, p[3], n[3];
		skull_map_at(p, n, &map, px);
		for (int c = 0; c < 3; c++)
			NEAR(p[c], (c + 1) * px[0] - 2 * c * px[1] + 5, 2e-3);  // single precision at values of 500
		NEAR(n[2], 1, 1e-5);
	}
	skull_map_free(&map);
}

static void globe_map_of_a_sphere_is_its_radius(void **state)
{
	(void)state;
	struct rng rng = { 6 };
	struct globe_map map = globe_map_round(64, 12, 7.8, 13.1), ball = globe_map_round(64, 12, 7.8, 0);
	for (int k = 0; k < 5000; k++) {
		float d[3] = { (float)rng_normal(&rng), (float)rng_normal(&rng), (float)rng_normal(&rng) };
		NEAR(globe_map_at(&ball, d), 12, 1e-5);
		double z = d[2] / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), shift = 13.1 - 7.8;
		double disc = 7.8 * 7.8 - shift * shift * (1 - z * z), cap = z > 0 ? shift * z + sqrt(fmax(disc, 0)) : 0;
		// Cells of 2.8 degrees cut the corner where the cornea begins by up to 0.1 mm; the cap itself is smooth.
		NEAR(globe_map_at(&map, d), fmax(12, cap), fabs(cap - 12) < 0.35 ? 0.06 : 0.01);
	}
	NEAR(globe_map_at(&map, (float[]){ 0, 0, 5 }), 13.1, 1e-5);
	globe_map_free(&map);
	globe_map_free(&ball);
}

/* A sphere of triangles about the origin, without what lies beyond z < cut. mesh_free. */
static struct mesh ball_mesh(double radius, double cut)
{
	enum { R = 40, S = 80 };
	struct mesh m = { .vertices = calloc((R + 1) * S, sizeof *m.vertices), .faces = calloc(2 * R * S, sizeof *m.faces) };
	m.n_vertices = (R + 1) * S;
	for (int j = 0; j <= R; j++)
		for (int i = 0; i < S; i++) {
			double a = M_PI * j / R, b = 2 * M_PI * i / S;
			float *v = m.vertices[j * S + i];
			v[0] = (float)(radius * sin(a) * cos(b));
			v[1] = (float)(radius * sin(a) * sin(b));
			v[2] = (float)(radius * cos(a));
		}
	for (int j = 0; j < R; j++)
		for (int i = 0; i < S; i++) {
			int a = j * S + i, b = j * S + (i + 1) % S;
			if (m.vertices[a][2] < cut || m.vertices[a + S][2] < cut)
				continue;
			memcpy(m.faces[m.n_faces++], (int32_t[]){ a, a + S, b + S }, sizeof *m.faces);
			memcpy(m.faces[m.n_faces++], (int32_t[]){ a, b + S, b }, sizeof *m.faces);
		}
	return m;
}

static void globe_map_of_a_mesh(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct globe_map map;
	struct rng rng = { 8 };
	double sag = 12 * (1 - cos(M_PI / 80) * cos(M_PI / 80));  // of triangles that have their corners on the sphere
	struct mesh whole = ball_mesh(12, -99), open = ball_mesh(12, -4), half = ball_mesh(12, 1);
	assert_true(globe_map_from_mesh(&map, 48, &whole, &err));
	for (int k = 0; k < 2000; k++)
		NEAR(globe_map_at(&map, (float[]){ (float)rng_normal(&rng), (float)rng_normal(&rng), (float)rng_normal(&rng) }),
		     12 - sag / 2, sag / 2 + 1e-4);
	globe_map_free(&map);
	assert_true(globe_map_from_mesh(&map, 48, &open, &err));
	for (int i = 0; i < 49 * 49; i++)  // the hole behind is closed by what its rim gives
		NEAR(map.radius[i], 12, 0.3);
	globe_map_free(&map);
	assert_false(globe_map_from_mesh(&map, 48, &half, &err));
	ERR_HAS(err, "surrounds its centre");
	mesh_free(&whole);
	mesh_free(&open);
	mesh_free(&half);
}

static void polar_chart_is_the_papers(void **state)
{
	(void)state;
	struct globe_map map = globe_map_round(96, 12, 7.8, 13.1);
	struct image polar = globe_map_polar(&map, 64);
	// The apex is at atan2(x, z) = 0, acos(y / r) = pi / 2: the chart's middle.
	NEAR(*image_at(&polar, 64, 32), 13.1, 0.02);
	NEAR(*image_at(&polar, 0, 32), 12, 1e-5);
	NEAR(*image_at(&polar, 64, 2), 12, 1e-5);
	image_free(&polar);
	globe_map_free(&map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(natural_is_exact_on_affine_maps),
		cmocka_unit_test(natural_at_a_site_is_that_site),
		cmocka_unit_test(natural_refuses_a_line),
		cmocka_unit_test(skull_map_of_a_plane_is_the_plane),
		cmocka_unit_test(globe_map_of_a_sphere_is_its_radius),
		cmocka_unit_test(globe_map_of_a_mesh),
		cmocka_unit_test(polar_chart_is_the_papers),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
