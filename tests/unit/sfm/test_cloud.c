/* The dense cloud of a ball whose pictures are painted by closed form: points lie on it, normals point out of it. */
#include "base/mem.h"
#include "bridge/cv_marker.h"
#include "math/stats.h"
#include "math/vec.h"
#include "sfm/cloud/cloud.h"
#include "sfm/cloud/surface.h"
#include "sfm/cloud/surface_colour.h"
#include "tests/lib/scenes/sfm_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

/* Brightness of a point of space: many frequencies, none that repeats over the ball. */
static double paint(const double p[3])
{
	double sum = 0;
	for (int k = 1; k <= 12; k++)
		sum += sin(k * 2.3 * (p[0] * cos(k) + p[1] * sin(2.1 * k)) + k * k) * sin(k * 1.9 * (p[2] + p[1] * cos(k)) + 0.7 * k);
	return 128 + 22 * sum;
}

/* The ball of radius 1 at the origin as image i sees it. */
static struct cloud_picture render(const struct colmap_model *m, int i)
{
	const struct colmap_camera *c = &m->cameras[0];
	struct cloud_picture out = { mem_new((size_t)c->width * (size_t)c->height, 1), c->width, c->height };
	struct camera camera;
	struct err err = { 0 };
	double focal[2], R[3][3], o[3];
	assert_true(colmap_to_camera(&camera, focal, c, &err));
	colmap_rotation(R, m->images[i].q);
	colmap_center(o, &m->images[i]);
	for (int y = 0; y < c->height; y++)
		for (int x = 0; x < c->width; x++) {
			double px[2] = { x + 0.5, y + 0.5 }, ray[3], d[3], p[3];
			camera_ray(ray, &camera, px);
			mat_tvec(d, R, ray);
			double b = vec_dot(o, d), disc = b * b - vec_dot(o, o) + 1;
			// Behind the ball a wall far away, as any room has one.
			vec_add(p, o, disc > 0 ? -b - sqrt(disc) : 30, d);
			out.grey[(long)y * c->width + x] = (uint8_t)fmax(0, fmin(255, paint(p)));
		}
	return out;
}

/* Points of the model onto the ball, so that the ball is what the cameras see. */
static void onto_ball(struct colmap_model *m)
{
	for (int i = 0; i < m->n_points; i++)
		vec_unit(m->points[i].xyz, m->points[i].xyz);
}

static const struct cloud_conf conf = { .neighbours = 2, .best_angle = 12 * M_PI / 180, .size_px = 400, .max_range = 160,
	                                    .voxel = 0.02, .min_pairs = 2, .max_slant = 1.2, .stereo = { 5, 5, 1, 100 } };

static void test_ball(void **state)
{
	(void)state;
	enum { VIEWS = 24, USED = 4 };
	struct colmap_model m;
	struct err err = { 0 };
	struct sfm_subject s = { { 0, 0, 0 }, 1.3 };
	struct cloud_picture pictures[USED];
	sfm_scene(&m, VIEWS, 400, 9);
	onto_ball(&m);
	for (int i = 0; i < USED; i++)
		pictures[i] = render(&m, i);
	struct cloud_grid *grid = cloud_grid_new(&s, &conf);
	for (int k = 0; k < USED - 1; k++) {
		struct cloud_points points = { 0 };
		const struct cloud_pair pair = { k, k + 1, 1 };
		assert_true(cloud_stereo(&points, &m, &pair, &pictures[k], &pictures[k + 1], &s, &conf, &err));
		assert_true(points.n > 10000);
		cloud_grid_add(grid, &points);
		cloud_points_free(&points);
	}
	struct cloud_points all;
	cloud_grid_points(&all, grid, &conf);
	assert_true(all.n > 1000);
	long near = 0;
	double facing = 0;
	double *off = mem_array((size_t)all.n, sizeof *off);
	for (long i = 0; i < all.n; i++) {
		const float *p = all.xyz[i], *q = all.normal[i];
		double d[3] = { (double)p[0], (double)p[1], (double)p[2] }, n[3] = { (double)q[0], (double)q[1], (double)q[2] };
		double r = vec_norm(d);
		near += fabs(r - 1) < 0.02;
		off[i] = r - 1;
		facing += vec_dot(d, n) / r / (double)all.n;
	}
	// A quarter of a pixel of disparity at focal 1200 * 400 / 500, base 1.3 and distance 4 is 0.4 % of the radius; cells have
	// an edge of 2.6 %. A shift of half a pixel between the pictures would move the whole ball by 0.8 %.
	double middle = stats_quantile((int)all.n, off, 0.5);
	free(off);
	print_message("%.1f %% within 2 %% of the ball, middle %.4f, normals %.4f\n", 100.0 * (double)near / (double)all.n, middle, facing);
	assert_true((double)near > 0.95 * (double)all.n);
	NEAR(middle, 0, 0.004);
	assert_true(facing > 0.97);
	// Kept between runs, to the bit.
	const char *path = scratch_path("grid");
	struct cloud_grid *back = 0;
	struct cloud_points again;
	char *tag = 0;
	assert_true(cloud_grid_save(grid, path, "what\n", &err) && cloud_grid_load(&back, &tag, path));
	assert_string_equal(tag, "what\n");
	cloud_grid_points(&again, back, &conf);
	assert_int_equal(again.n, all.n);
	assert_memory_equal(again.xyz, all.xyz, (size_t)all.n * sizeof *all.xyz);
	free(tag);
	struct cloud_grid *none;
	assert_false(cloud_grid_load(&none, &tag, scratch_text("no", "EWCLOUD but not really")));
	cloud_points_free(&all);
	cloud_points_free(&again);
	cloud_grid_free(grid);
	cloud_grid_free(back);
	for (int i = 0; i < USED; i++)
		free(pictures[i].grey);
	colmap_free(&m);
}

/* Of an orbit of equal steps, each picture's best partner is the one that stands nearest to the best angle. */
static void test_pairs(void **state)
{
	(void)state;
	struct colmap_model m;
	struct cloud_conf c = conf;
	int n;
	sfm_scene(&m, 36, 300, 4);
	c.neighbours = 2;
	c.best_angle = 20 * M_PI / 180;
	struct cloud_pair *pairs = cloud_pairs(&n, &m, 0, &c);
	int near = 0;
	for (int i = 0; i < n; i++) {
		int step = pairs[i].b - pairs[i].a;
		step = step > 18 ? 36 - step : step;
		near += step >= 1 && step <= 3;  // steps of 10 degrees, and of height
		assert_true(pairs[i].a < pairs[i].b);
	}
	assert_true(n >= 36 && n <= 72 && near >= n * 9 / 10);
	free(pairs);
	bool is_new[36] = { [7] = true };
	pairs = cloud_pairs(&n, &m, is_new, &c);
	assert_int_equal(n, 2);
	for (int i = 0; i < n; i++)
		assert_true(pairs[i].a == 7 || pairs[i].b == 7);
	free(pairs);
	colmap_free(&m);
}

/* Two pieces: the larger stays, with its colours. */
static void test_largest(void **state)
{
	(void)state;
	static const float v[][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 5, 0, 0 }, { 9, 0, 0 }, { 5, 4, 0 }, { 9, 4, 0 }, { 7, 7, 7 } };
	static const int32_t f[][3] = { { 0, 1, 2 }, { 3, 4, 5 }, { 4, 6, 5 } };
	struct mesh m = { COUNT(v), COUNT(f), mem_new(COUNT(v), sizeof *v), mem_new(COUNT(f), sizeof *f), mem_new(COUNT(v), sizeof *v) };
	memcpy(m.vertices, v, sizeof v);
	memcpy(m.faces, f, sizeof f);
	for (int i = 0; i < m.n_vertices; i++)
		m.colours[i][0] = (float)i;
	surface_largest(&m, 0);
	assert_int_equal(m.n_faces, 2);
	assert_int_equal(m.n_vertices, 4);
	for (int i = 0; i < 4; i++) {
		NEAR(m.colours[i][0], i + 3, 0);
		NEAR(m.vertices[i][0], v[i + 3][0], 0);
	}
	mesh_free(&m);
}

/* A printed marker is found, its corners where they were drawn. */
static void test_marker(void **state)
{
	(void)state;
	enum { SIZE = 160, W = 400, H = 300 };
	uint8_t *marker = mem_array(SIZE * SIZE, 1), *picture = mem_array(W * H, 1);
	struct cv_marker found[8];
	struct err err = { 0 };
	int n;
	memset(picture, 180, W * H);
	assert_true(cv_marker_draw(marker, SIZE, 2, 17, &err));
	for (int y = 0; y < SIZE; y++)
		memcpy(picture + (60 + y) * W + 100, marker + y * SIZE, SIZE);
	assert_true(cv_markers(&n, found, 8, picture, W, H, &err));
	int hits = 0;
	for (int i = 0; i < n; i++)
		if (found[i].family == 2 && found[i].id == 17) {
			hits++;
			// The black square begins a margin of 20 px inside; corners are edges of pixels.
			NEAR(found[i].corner[0][0], 120, 0.75);
			NEAR(found[i].corner[0][1], 80, 0.75);
			NEAR(found[i].corner[2][0], 240, 0.75);
			NEAR(found[i].corner[2][1], 200, 0.75);
		}
	assert_int_equal(hits, 1);
	free(marker);
	free(picture);
}

/* A burnt-out wall beside noise of +-2 levels: the wall goes, but for what lies within reach of the noise. */
static void test_plain(void **state)
{
	(void)state;
	enum { W = 60, H = 40, REACH = 5 };
	uint8_t grey[W * H], mask[W * H];
	for (int i = 0; i < W * H; i++) {
		grey[i] = i % W < 30 ? 255 : (uint8_t)(126 + (i * 7919 + i / W * 104729) % 5);
		mask[i] = i % 11 ? 255 : 0;
	}
	struct err err = { 0 };
	assert_true(cv_mask_plain(mask, grey, W, H, REACH, 3, &err));
	for (int i = 0; i < W * H; i++)
		assert_int_equal(mask[i], i % 11 && i % W >= 30 - REACH ? 255 : 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_ball),    cmocka_unit_test(test_pairs),
		cmocka_unit_test(test_largest), cmocka_unit_test(test_marker),
		cmocka_unit_test(test_plain),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
