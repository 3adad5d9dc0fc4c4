/* Heads found in rendered clips by the openings of their eyes, and poses from points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "bridge/om_mesh.h"
#include "image/video/video.h"
#include "math/rng.h"
#include "track/gaze/globe.h"
#include "track/head/refine.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/unit.h"

/* Angle between two poses' orientations, radians: half the chord between the rotations, in Frobenius' norm, is sqrt(2) sin(angle / 2). */
static double head_angle(const double a[4][4], const double b[4][4])
{
	double square = 0;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			square += pow(a[i][k] - b[i][k], 2);
	return 2 * asin(fmin(1, sqrt(square / 8)));
}

static const struct head_find_conf conf = { .width = { 0.05, 0.6 }, .roll = 20, .turn_sigma = 3, .yaw_sigma = 3, .min_score = 1, .edge = 40 };

struct clip {
	struct mesh mesh;
	double center[2][3], radius;
	struct camera camera;
	double pose[4][4];          // true, of the first frame
	int width, height;
	uint8_t *rgb;
};

static bool load(struct clip *c, const char *name)
{
	struct err err = { 0 };
	char *path = mem_printf("video/%s/subject.ply", name);
	const char *at = bench_data(path);
	free(path);
	*c = (struct clip){ .width = 1280, .height = 720 };
	if (!at)
		return false;
	char *dir = mem_printf("%.*s", (int)(strlen(at) - strlen("/subject.ply")), at);
	char *files[3] = { mem_printf("%s/truth.json", dir), mem_printf("%s/truth.npz", dir), mem_printf("%s/video.mp4", dir) };
	assert_true(om_mesh_load(&c->mesh, at, 1000000, &err));
	json_t *j = json_read(files[0], 1 << 24, &err);
	const json_t *centers = json_object_get(j, "eye_centre_head_cm");
	assert_true(json_get_array(c->center[0], 3, centers, "left", "", &err) && json_get_array(c->center[1], 3, centers, "right", "", &err)
	            && json_get(&c->radius, j, "eye_radius_cm", "", &err));
	c->camera = (struct camera){ .focal_px = json_number_value(json_array_get(json_array_get(json_object_get(j, "K"), 0), 0)),
		                         .center_px = { 640, 360 }, .source = CAMERA_CONF };
	json_decref(j);
	struct npy R, t;
	assert_true(npz_read(&R, files[1], "head_R", NPY_LIMIT, &err) && npz_read(&t, files[1], "head_t", NPY_LIMIT, &err));
	double *r = npy_doubles(&R), *s = npy_doubles(&t);
	for (int i = 0; i < 3; i++) {
		memcpy(c->pose[i], r + 3 * i, 3 * sizeof *r);
		c->pose[i][3] = 10 * s[i];
	}
	c->pose[3][3] = 1;
	for (int i = 0; i < c->mesh.n_vertices; i++)
		for (int k = 0; k < 3; k++)
			c->mesh.vertices[i][k] *= 10;
	for (int k = 0; k < 6; k++)
		c->center[k / 3][k % 3] *= 10;
	c->radius *= 10;
	struct video_info info;
	struct video_frame frame;
	bool got;
	struct video *video = video_open(&info, files[2], &(struct video_conf){ 40, 100000, 1, 0 }, &err);
	assert_true(video && video_next(&frame, &got, video, &err) && got);
	c->rgb = mem_new(3 * 1280 * 720, 1);
	video_frame_rgb(c->rgb, 3 * 1280, &frame, 0, 0, 1280, 720);
	video_frame_free(&frame);
	video_close(video);
	npy_free(&R);
	npy_free(&t);
	free(r);
	free(s);
	for (int i = 0; i < 3; i++)
		free(files[i]);
	free(dir);
	return true;
}

/* rms distance in the picture of the mesh's skin near the eyes, px. */
static double distance(const struct clip *c, const double pose[4][4])
{
	double sum = 0;
	int n = 0;
	for (int i = 0; i < c->mesh.n_vertices; i++) {
		double p[3] = { c->mesh.vertices[i][0], c->mesh.vertices[i][1], c->mesh.vertices[i][2] }, a[2], b[2];
		if (!head_project(a, &c->camera, c->pose, p) || !head_project(b, &c->camera, pose, p))
			continue;
		if (!(a[0] > 0 && a[1] > 0 && a[0] < c->width && a[1] < c->height))
			continue;
		sum += (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
		n++;
	}
	return sqrt(sum / n);
}

static void find(const char *name, bool two)
{
	struct clip c;
	struct head_found found;
	struct eye_opening opening[2];
	if (!load(&c, name))
		skip();
	struct ray_scene *rays = ray_scene_new(c.mesh.n_vertices, (const float(*)[3])c.mesh.vertices, c.mesh.n_faces, (const int32_t(*)[3])c.mesh.faces);
	for (int e = 0; e < 2; e++) {
		const double from[3] = { c.center[e][0], c.center[e][1], c.center[e][2] + 600 };
		eye_opening_find(&opening[e], rays, from, c.center[e], c.radius);
		assert_true(e == 1 || opening[e].open);
	}
	assert_true(head_find(&found, c.rgb, c.width, c.height, &c.camera, opening, false, &conf));
	assert_true(found.seen[0] && found.seen[1] == two);
	assert_true(head_find_refine(&found, c.rgb, c.width, c.height, &c.camera, opening, &conf));
	// lashes and the shade under them hide a lid's edge by up to half their width: 10 px here, less with both eyes
	assert_true(distance(&c, found.cam_from_head) < 10);
	assert_true(head_angle(found.cam_from_head, c.pose) < 3 * M_PI / 180);
	ray_scene_free(rays);
	mesh_free(&c.mesh);
	free(c.rgb);
}

static void finds_two_eyes(void **state)
{
	(void)state;
	find("clip_a", true);
}

static void finds_one_eye(void **state)
{
	(void)state;
	find("clip_b", false);
}

/* Nothing like an eye: skin-coloured noise. */
static void finds_none_where_there_is_none(void **state)
{
	(void)state;
	enum { W = 320, H = 180 };
	static uint8_t rgb[3 * W * H];
	struct rng rng = { 3 };
	struct eye_opening opening[2] = { 0 };
	struct head_found found;
	const struct camera camera = { .focal_px = 1600, .center_px = { W / 2, H / 2 } };
	for (int e = 0; e < 2; e++) {
		opening[e].open = true;
		for (int i = 0; i < OPENING_POINTS; i++) {
			double a = 2 * M_PI * i / OPENING_POINTS, x = (e ? -31 : 31);
			opening[e].center[0] = x;
			opening[e].edge[i][0] = x + 12 * cos(a);
			opening[e].edge[i][1] = 5 * sin(a);
		}
		opening[e].canthus[1][0] = opening[e].center[0] + 12;
		opening[e].canthus[0][0] = opening[e].center[0] - 12;
	}
	for (int i = 0; i < W * H; i++) {
		double light = 1 + 0.05 * rng_normal(&rng);
		for (int k = 0; k < 3; k++)
			rgb[3 * i + k] = (uint8_t)((k == 0 ? 190 : k == 1 ? 140 : 110) * fmax(0, light));
	}
	assert_false(head_find(&found, rgb, W, H, &camera, opening, false, &conf) || head_find(&found, rgb, W, H, &camera, opening, true, &conf));
}

/* Heads that face the camera, leaning any way: the eyes' places alone determine the pose; with one eye shut they do not. */
static void poses_from_two_eyes(void **state)
{
	(void)state;
	const struct camera camera = { .focal_px = 1600, .center_px = { 640, 360 } };
	struct rng rng = { 9 };
	for (int round = 0; round < 50; round++) {
		struct eye_opening opening[2] = { { .open = true, .center = { 30, 5, 9 } }, { .open = true, .center = { -32, 5, 9 } } };
		double roll = rng_range(&rng, -M_PI, M_PI), c = cos(roll), s = sin(roll), eye[2][2];
		const double truth[4][4] = { { c, s, 0, rng_range(&rng, -40, 40) }, { s, -c, 0, rng_range(&rng, -40, 40) }, { 0, 0, -1, rng_range(&rng, 300, 900) }, { 0, 0, 0, 1 } };
		struct head_found found;
		for (int e = 0; e < 2; e++)
			assert_true(head_project(eye[e], &camera, truth, opening[e].center));
		assert_true(head_find_from_eyes(&found, (const double(*)[2])eye, &camera, opening));
		for (int i = 0; i < 16; i++)
			NEAR(found.cam_from_head[i / 4][i % 4], truth[i / 4][i % 4], 1e-9);
		opening[round % 2].open = false;
		assert_false(head_find_from_eyes(&found, (const double(*)[2])eye, &camera, opening));
	}
}

/* A turned head from exact places, then with a tenth of them elsewhere. */
static void poses_from_points(void **state)
{
	(void)state;
	enum { N = 60 };
	struct head_sight s[N];
	struct rng rng = { 7 };
	const struct camera camera = { .focal_px = 6000, .center_px = { 640, 360 } };
	double c = cos(0.1), d = sin(0.1);
	const double truth[4][4] = { { c, 0, d, 3 }, { 0, -1, 0, -5 }, { d, 0, -c, 650 }, { 0, 0, 0, 1 } };
	for (int bad = 0; bad < 2; bad++) {
		double pose[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, 640 }, { 0, 0, 0, 1 } };
		for (int i = 0; i < N; i++) {
			s[i] = (struct head_sight){ .weight = 1, .line = i % 3 == 0 };
			for (int k = 0; k < 3; k++)
				s[i].head[k] = 20 * rng_normal(&rng);
			double a = 6.2831853 * i / N;
			s[i].normal[0] = cos(a);
			s[i].normal[1] = sin(a);
			assert_true(head_project(s[i].px, &camera, truth, s[i].head));
			if (bad && i % 10 == 0)
				s[i].px[0] += 300;
		}
		double rms = head_pose_fit(pose, N, s, &camera, bad ? 20 : INFINITY, 0);
		assert_true(isfinite(rms));
		// exact places: to where Gauss and Newton stop; outliers of 300 px at a scale of 20 keep (20/300)^4 of their weight
		assert_true(head_angle(pose, truth) < (bad ? 1e-3 : 1e-7));
		assert_true(fabs(pose[2][3] - truth[2][3]) < (bad ? 1 : 1e-4));
	}
}

/* Fick angles of heads made by gaze_rotation, which eyes are turned by. */
static void test_fick(void **state)
{
	(void)state;
	static const double turns[][3] = { { 0, 0, 0 }, { 0.5, 0.1, -0.3 }, { -1.2, -0.7, 2.5 }, { 0.2, 0.6, M_PI - 0.1 } };
	for (int i = 0; i < COUNT(turns); i++) {
		double r[3][3], m[4][4] = { [3] = { 0, 0, 0, 1 } }, got[3];
		gaze_rotation(r, turns[i]);
		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++)
				m[a][b] = a ? -r[a][b] : r[a][b];
		head_fick(got, (const double(*)[4])m);
		for (int k = 0; k < 3; k++)
			NEAR(got[k], turns[i][k], 1e-12);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_fick),
		cmocka_unit_test(finds_two_eyes),
		cmocka_unit_test(finds_one_eye),
		cmocka_unit_test(finds_none_where_there_is_none),
		cmocka_unit_test(poses_from_two_eyes),
		cmocka_unit_test(poses_from_points),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
