/* The pose of a head at rest by its shading: a face of bumps, drawn by casting rays, lit by lamps with shadows, its skin blotched: no part of the model
 * that is fitted (nine harmonics, one colour). A mark at each eye tells where it is, and not whether it nods. */
#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "mesh/ray.h"
#include "track/head/shade_lens.h"
#include "tests/lib/unit.h"
#include "image/image.h"

enum { WIDE = 320, HIGH = 240, GRID = 90, LAMPS = 3, RAYS = 16 };
static const double DEGREE = M_PI / 180;
static const struct head_shade_conf shade = { .reach = 90, .away = 18, .blur = 0.8, .patch = 22 };  // as config/track.conf
static const double eye[2][3] = { { 31, 0, -10 }, { -31, 0, -10 } };
static const struct camera camera = { .focal_px = 1000, .center_px = { WIDE / 2.0, HIGH / 2.0 } };

static double bump(double x, double y, double cx, double cy, double wide, double high) { return exp(-pow((x - cx) / wide, 2) - pow((y - cy) / high, 2)); }

/* mm: forehead and cheeks round a cylinder, brow, nose, sockets. */
static double depth(double x, double y)
{
	return -x * x / 150 - y * y / 500 + 24 * bump(x, y, 0, -28, 9, 16) + 10 * bump(x, y, 0, -10, 8, 22) + 6 * bump(x, y, 28, 20, 26, 9) + 6 * bump(x, y, -28, 20, 26, 9)
	       - 7 * bump(x, y, 31, 0, 16, 12) - 7 * bump(x, y, -31, 0, 16, 12) + 5 * bump(x, y, 45, -32, 18, 14) + 5 * bump(x, y, -45, -32, 18, 14);
}

static struct mesh face(void)
{
	struct mesh m = { .vertices = mem_array((GRID + 1) * (GRID + 1), sizeof *m.vertices), .faces = mem_array(2 * GRID * GRID, sizeof *m.faces) };
	for (int j = 0; j <= GRID; j++)
		for (int i = 0; i <= GRID; i++) {
			const double x = 150.0 * i / GRID - 75, y = 130.0 * j / GRID - 65;
			float *v = m.vertices[m.n_vertices++];
			v[0] = (float)x, v[1] = (float)y, v[2] = (float)depth(x, y);
		}
	for (int j = 0; j < GRID; j++)
		for (int i = 0; i < GRID; i++) {
			const int32_t a = j * (GRID + 1) + i, b = a + 1, c = a + GRID + 1, d = c + 1;
			memcpy(m.faces[m.n_faces++], (int32_t[]){ a, b, d }, sizeof *m.faces);
			memcpy(m.faces[m.n_faces++], (int32_t[]){ a, d, c }, sizeof *m.faces);
		}
	return m;
}

/* Lamps a fifth of a radian wide, and a weak light from everywhere. */
struct lamp { double to[3], strength; };

static double lit(const struct ray_scene *rays, const double at[3], const double n[3], const struct lamp *lamps, struct rng *rng)
{
	float from[3], dir[3];
	double sum = 0;
	for (int k = 0; k < 3; k++)
		from[k] = (float)(at[k] + 0.3 * n[k]);
	for (int i = 0; i < RAYS * (LAMPS + 1); i++) {
		double d[3], random[3] = { rng_normal(rng), rng_normal(rng), rng_normal(rng) };
		const bool lamp = i < RAYS * LAMPS;
		vec_add(d, lamp ? lamps[i / RAYS].to : (double[3]){ 0 }, lamp ? 0.1 : 1, random);
		vec_unit(d, d);
		const double c = vec_dot(d, n);
		for (int k = 0; k < 3; k++)
			dir[k] = (float)d[k];
		if (c > 0 && !ray_blocked(rays, from, dir, 0, INFINITY))
			sum += c * (lamp ? lamps[i / RAYS].strength : 0.5) / RAYS;
	}
	return sum;
}

/* Blotches: waves of 8 to 40 mm. */
static double skin(const double at[3], uint64_t seed)
{
	struct rng rng = { seed };
	double ln = 0;
	for (int i = 0; i < 24; i++) {
		const double k = 2 * M_PI / exp(rng_range(&rng, log(8), log(40))), turn = rng_range(&rng, 0, 2 * M_PI);
		ln += 0.02 * sin(k * (cos(turn) * at[0] + sin(turn) * at[1]) + rng_range(&rng, 0, 2 * M_PI));
	}
	return 0.35 * exp(ln);
}

static uint8_t *shoot(const struct mesh *mesh, const double m[4][4], uint64_t seed)
{
	struct rng rng = { seed };
	struct lamp lamps[LAMPS];
	struct ray_scene *rays = ray_scene_new(mesh->n_vertices, (const float(*)[3])mesh->vertices, mesh->n_faces, (const int32_t(*)[3])mesh->faces);
	float (*normals)[3] = mesh_normals(mesh), origin[3];
	uint8_t *rgb = mem_new((size_t)3 * WIDE * HIGH, 1);
	double camera_at[3];
	for (int i = 0; i < LAMPS; i++) {
		const double h = rng_range(&rng, -1.2, 1.2), v = rng_range(&rng, -0.3, 1);
		lamps[i] = (struct lamp){ { sin(h) * cos(v), sin(v), cos(h) * cos(v) }, rng_range(&rng, 0.2, 1) };
	}
	head_to(camera_at, m, (const double[3]){ 0 });
	for (int k = 0; k < 3; k++)
		origin[k] = (float)camera_at[k];
	for (int p = 0; p < WIDE * HIGH; p++) {
		const double px[2] = { p % WIDE + 0.5, p / WIDE + 0.5 };
		double ray[3], n[3] = { 0 }, at[3];
		float dir[3];
		camera_ray(ray, &camera, px);
		for (int k = 0; k < 3; k++)
			dir[k] = (float)(m[0][k] * ray[0] + m[1][k] * ray[1] + m[2][k] * ray[2]);
		struct ray_hit hit = ray_first(rays, origin, dir, 1, 1e4F);
		double value = 0.05;
		if (hit.face >= 0) {
			const int32_t *f = mesh->faces[hit.face];
			const float w[3] = { 1 - hit.u - hit.v, hit.u, hit.v };
			for (int k = 0; k < 3; k++) {
				at[k] = (double)(origin[k] + hit.t * dir[k]);
				for (int c = 0; c < 3; c++)
					n[k] += (double)(w[c] * normals[f[c]][k]);
			}
			vec_unit(n, n);
			value = skin(at, seed) * lit(rays, at, n, lamps, &rng);
		}
		const float coded = srgb_from_linear((float)fmin(1, value)) * 255 + 0.5F;
		for (int c = 0; c < 3; c++)
			rgb[3 * p + c] = (uint8_t)coded;
	}
	ray_scene_free(rays);
	free(normals);
	return rgb;
}

static int marks(struct head_sight s[2], const double m[4][4], struct rng *rng)
{
	for (int i = 0; i < 2; i++) {
		const double x = i ? -31 : 31;
		s[i] = (struct head_sight){ .head = { x, 0, depth(x, 0) }, .weight = 1 / (0.4 * 0.4), .sure = true };
		head_project(s[i].px, &camera, m, s[i].head);
		for (int k = 0; k < 2; k++)
			s[i].px[k] += 0.4 * rng_normal(rng);
	}
	return 2;
}

static double turned(const double a[4][4], const double b[4][4])
{
	const double none[3] = { 0 };
	double d[6];
	head_motion(d, a, b, none);
	return vec_norm(d) / DEGREE;
}

static const double facing[4][4] = { { 1, 0, 0, 2 }, { 0, -1, 0, -4 }, { 0, 0, -1, 560 }, { 0, 0, 0, 1 } };

static void tells_the_turn(void **state)
{
	static const double turns[][3] = { { 0, 0, 0 }, { 6, 0, 1 }, { -5, 5, 0 }, { 3, -9, -3 }, { 0, 14, 2 }, { -8, 0, 0 } };
	struct mesh mesh = face();
	struct head_shape *shape = head_shape_new(&mesh, eye, &shade);
	double worst = 0, square = 0, before = 0;
	(void)state;
	assert_non_null(shape);
	for (size_t i = 0; i < COUNT(turns); i++) {
		struct rng rng = { 77 + i };
		double m[4][4], pose[4][4], d[6] = { 0 }, sigma[3], off[6];
		const double middle[3] = { 0, 0, 560 }, none[3] = { 0 };
		for (int k = 0; k < 3; k++)
			d[k] = turns[i][k] * DEGREE;
		head_moved(m, facing, d, middle);
		uint8_t *rgb = shoot(&mesh, (const double(*)[4])m, 500 + i);
		struct head_picture picture;
		struct head_sight s[2];
		struct head_prior prior = { .sigma = { 0.1, 0.15, INFINITY, INFINITY, INFINITY, INFINITY } };
		const int n = marks(s, (const double(*)[4])m, &rng);
		memcpy(prior.cam_from_head, facing, sizeof facing);
		memcpy(pose, facing, sizeof facing);
		head_pose_fit(pose, n, s, &camera, INFINITY, &prior);
		before = fmax(before, turned((const double(*)[4])pose, (const double(*)[4])m));
		assert_true(head_picture_make(&picture, rgb, WIDE, HIGH, shade.blur * camera.focal_px / 560));
		for (int round = 0; round < 40; round++) {
			struct head_form form;
			assert_true(head_shade(&form, shape, &picture, &camera, (const double(*)[4])pose, &shade));
			prior.form = &form;
			head_pose_fit(pose, n, s, &camera, INFINITY, &prior);
			assert_true(head_pose_sigma(sigma, (const double(*)[4])pose, n, s, &camera, INFINITY, &prior));
		}
		head_motion(off, (const double(*)[4])pose, (const double(*)[4])m, none);
		print_message("turned by %g, %g, %g: off by %.2f, %.2f, %.2f +- %.2f, %.2f, %.2f degrees\n", turns[i][0], turns[i][1], turns[i][2], off[0] / DEGREE, off[1] / DEGREE,
		              off[2] / DEGREE, sigma[0] / DEGREE, sigma[1] / DEGREE, sigma[2] / DEGREE);
		worst = fmax(worst, vec_norm(off) / DEGREE);
		square = fmax(square, fmax(fabs(off[0] / sigma[0]), fabs(off[1] / sigma[1])));
		free(picture.ln);
		free(rgb);
	}
	print_message("by the marks alone %.1f degrees at worst\n", before);
	assert_true(worst < 3 && worst < before / 3);
	assert_true(square < 3);
	head_shape_free(shape);
	mesh_free(&mesh);
}

/* A lens told as half or right: the share of its perspective that is seen is half, or all. One told as twice as long makes so little of it that there is little to miss. */
static void tells_the_lens(void **state)
{
	static const double told[] = { 0.5, 1, 2 };
	struct mesh mesh = face();
	struct head_shape *shape = head_shape_new(&mesh, eye, &shade);
	struct head_picture picture;
	struct head_sight s[2];
	struct rng rng = { 5 };
	uint8_t *rgb = shoot(&mesh, facing, 900);
	const int n = marks(s, facing, &rng);
	(void)state;
	assert_true(head_picture_make(&picture, rgb, WIDE, HIGH, shade.blur * camera.focal_px / 560));
	for (size_t i = 0; i < COUNT(told); i++) {
		struct camera other = camera;
		struct head_prior prior = { .sigma = { 0.1, 0.15, INFINITY, INFINITY, INFINITY, INFINITY } };
		struct head_lens lens = { 0 };
		memcpy(prior.cam_from_head, facing, sizeof facing);
		other.focal_px *= told[i];
		prior.cam_from_head[2][3] *= told[i];
		const bool tells = head_shade_lens(&lens, shape, &picture, &other, (const double(*)[4])prior.cam_from_head, n, s, INFINITY, &prior, &shade);
		print_message("told as %g: share %.2f +- %.2f\n", told[i], lens.share, lens.sigma);
		assert_true(tells || told[i] == 2);
		assert_true(!tells || fabs(lens.share - told[i]) < 2.5 * lens.sigma);
		assert_true(told[i] != 0.5 || lens.share < 0.9);
	}
	free(picture.ln);
	free(rgb);
	head_shape_free(shape);
	mesh_free(&mesh);
}

/* A picture without shading tells nothing, or says how little it tells; a face that is out of sight is none. */
static void tells_nothing(void **state)
{
	struct mesh mesh = face();
	struct head_shape *shape = head_shape_new(&mesh, eye, &shade);
	struct head_picture picture;
	struct head_form form;
	double away[4][4];
	uint8_t *rgb = mem_new((size_t)3 * WIDE * HIGH, 1);
	(void)state;
	memset(rgb, 128, (size_t)3 * WIDE * HIGH);
	assert_true(head_picture_make(&picture, rgb, WIDE, HIGH, 3));
	assert_false(head_shade(&form, shape, &picture, &camera, facing, &shade));
	memcpy(away, facing, sizeof away);
	away[0][3] = 4000;
	assert_false(head_shade(&form, shape, &picture, &camera, (const double(*)[4])away, &shade));
	free(picture.ln);
	free(rgb);
	head_shape_free(shape);
	assert_null(head_shape_new(&mesh, (const double[2][3]){ { NAN, NAN, NAN }, { NAN, NAN, NAN } }, &shade));
	mesh_free(&mesh);
	struct mesh none = { 0 };
	assert_null(head_shape_new(&none, eye, &shade));
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(tells_the_turn), cmocka_unit_test(tells_the_lens), cmocka_unit_test(tells_nothing) };
	return cmocka_run_group_tests(tests, 0, 0);
}
