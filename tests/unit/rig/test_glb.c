/* The glTF of a driven face: what its morph targets reproduce, its container, and what Khronos's own validator says. */
#include "base/file.h"
#include "export/eye_glb.h"
#include "image/picture.h"
#include "math/rng.h"
#include "math/vec.h"
#include "rig/deform/clear.h"
#include "rig/glb/bake.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"
#include "tests/lib/gltf.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/scenes/plain_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

#include <jansson.h>

enum { FRAMES = 60 };

struct made {
	struct driven on;
	struct drive drive;
	char *eye[2];  // two eyes as files: the second with a wider limbus
	size_t size[2];
	double apex[2];  // distance of the corneal apex from the centre, mm
};

static double flat(double x, double y)
{
	(void)x;
	(void)y;
	return 0;
}

static bool eye_make(struct made *m, int k, struct err *err)
{
	const struct scene_conf scene_conf = conf_of(4);
	const struct export_mesh_conf mesh = { .iris_rings = 16, .around = 24 };
	struct eye eye = plain_eye;
	struct scene s;
	struct export_part parts[EXPORT_PARTS];
	struct export_png one, png[EXPORT_PICTURES];
	eye.limbus_radius += 0.3 * k;
	scene_of(&s, &eye, &scene_conf, even, flat, 1.5);
	m->apex[k] = s.sclera_z;
	export_eye_meshes(parts, &s, &mesh);
	bool ok = picture_png_encode(&one.data, &one.size, (uint8_t[12]){ 0 }, 2, 2, 3, err);
	for (int i = 0; i < EXPORT_PICTURES; i++)
		png[i] = one;
	ok = ok && export_eye_pack(&m->eye[k], &m->size[k], &(struct export_eye){ parts, png, 1.336, 4, "eye", 0, 3, 0, { 0 } }, err);
	free(one.data);
	for (int i = 0; i < EXPORT_PARTS; i++)
		export_part_free(&parts[i]);
	scene_free(&s);
	return ok;
}

/* A gaze that wanders, with a blink in the middle. */
static const char *const expressions[] = { "brows_up", "squint" };
static struct glb_conf conf = { .targets = 20, .tolerance = 0.02, .poses = true, .skin_rgb = { 0.5, 0.3, 0.2 }, .tear_mm = 0.3, .n_expressions = 2, .expression = expressions };

static int setup(void **state)
{
	struct made *m = calloc(1, sizeof *m);
	struct err err = { 0 };
	bool ok = driven_make(&m->on, &(struct hair_conf){ 9, 8, 40, 60, 1.1 }, &err) && eye_make(m, 0, &err) && eye_make(m, 1, &err);
	m->drive = (struct drive){ FRAMES, 12, calloc(FRAMES, sizeof(double)), calloc(12 * FRAMES, sizeof(double)), 0 };
	for (int f = 0; f < FRAMES; f++) {
		m->drive.time[f] = f / 30.0;
		drive_look(drive_at(&m->drive, f), &m->on.rig, 15 * sin(f / 7.0), 10 * cos(f / 11.0), f > 25 && f < 32 ? 0 : 1);
	}
	conf.hairs = &m->on.hairs;
	*state = m;
	return ok ? 0 : 1;
}

static int teardown(void **state)
{
	struct made *m = *state;
	drive_free(&m->drive);
	driven_free(&m->on);
	free(m->eye[0]);
	free(m->eye[1]);
	free(m);
	return 0;
}

/* Rest plus weighted targets is the evaluated frame, within what is reported; the quaternions turn the eyeballs likewise. */
static void targets_give_the_frames_back(void **state)
{
	struct made *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &conf, &err));
	assert_true(b.n_targets >= 3 && b.n_targets <= conf.targets);
	struct deform *deform = deform_new(&m->on.rig);
	float (*x)[3] = calloc((size_t)m->on.rig.n, sizeof *x);
	double worst = 0;
	deform_rest(deform, x, 0);
	for (int f = 0; f < FRAMES; f++) {
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
	assert_true(b.worst <= conf.tolerance + 1e-3 || b.n_targets == conf.targets);
	free(x);
	deform_free(deform);
	glb_bake_free(&b);
}

/* Lashes, brows and tears go where their roots go: with the animation's weights, and with a named pose. */
static void hairs_follow(void **state)
{
	struct made *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &conf, &err));
	const int strands = strands_count(&m->on.hairs), n = strands + tears_count(&m->on.hairs);
	assert_int_equal(b.n_hair, n);
	struct deform *deform = deform_new(&m->on.rig);
	float (*x)[3] = calloc((size_t)m->on.rig.n, sizeof *x), (*rest)[3] = calloc((size_t)n, sizeof *rest), (*now)[3] = calloc((size_t)n, sizeof *now);
	double turn[2][3][3], worst[2] = { 0 }, most[2] = { 0 }, blink[2] = { 0 };
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(turn[s], &m->on.rig, (double[3]){ 0 });
	strands_place(rest, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])m->on.rig.rest);
	tears_place(rest + strands, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])m->on.rig.rest, (const double(*)[3][3])turn, conf.tear_mm, 0);
	deform_rest(deform, x, 0);
	for (int f = 0; f < FRAMES; f++) {
		double e[RIG_COMPONENTS], *c = drive_at(&m->drive, f);
		rig_components(e, &m->on.rig, c);
		rig_globes_turned(turn, &m->on.rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		strands_place(now, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])x);
		tears_place(now + strands, 0, &m->on.hairs, &m->on.rig, (const float(*)[3])x, (const double(*)[3][3])turn, conf.tear_mm, 0);
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

/* An expression's target is what it moves beside a look straight ahead. */
static void expressions_have_targets(void **state)
{
	struct made *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &conf, &err));
	assert_int_equal(b.n_poses, GLB_POSES + 2);
	float (*x[2])[3] = { calloc((size_t)m->on.rig.n, sizeof **x), calloc((size_t)m->on.rig.n, sizeof **x) };
	struct deform *deform = deform_new(&m->on.rig);
	struct deform_near near = deform_near_of(&m->on.rig);
	for (int k = 0; k < 2; k++) {
		double worst = 0, most = 0;
		for (int on = 0; on < 2; on++) {
			double c[12], e[RIG_COMPONENTS], turn[2][3][3];
			drive_look(c, &m->on.rig, 0, 0, 1);
			c[SKIN_EYE_INPUTS + k] = on;
			rig_components(e, &m->on.rig, c);
			rig_globes_turned(turn, &m->on.rig, c);
			deform_rest(deform, x[on], 0);
			deform_pose(deform, e, (const double(*)[3][3])turn, x[on], 0);
			deform_clear(x[on], &m->on.rig, &near, (const double(*)[3][3])turn);
		}
		assert_string_equal(b.pose_name[GLB_POSES + k], expressions[k]);
		for (int i = 0; i < b.n; i++)
			for (int c = 0; c < 3; c++) {
				const double want = (double)x[1][b.vertex[i]][c] - (double)x[0][b.vertex[i]][c];
				worst = fmax(worst, fabs(want - (double)b.pose[((GLB_POSES + k) * b.n + i) * 3 + c]));
				most = fmax(most, fabs(want));
			}
		assert_true(most > 0.1 && worst < 1e-4);
	}
	free(x[0]);
	free(x[1]);
	deform_free(deform);
	deform_near_free(&near);
	glb_bake_free(&b);
}

/* Both eyes' targets together are the pose of both eyes, wherever mesh and globe disagree at rest: here all of the left lids' linings lie in it. */
static void named_poses_add_up(void **state)
{
	struct made *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	static const int pairs[][2] = { { 0, 1 }, { 2, 3 }, { 8, 7 } };
	static const double look[][3] = { { 0, 0, 0 }, { 0, 20, 1 }, { 25, 0, 1 } };
	float (*was)[3] = calloc((size_t)m->on.rig.n, sizeof *was), (*x)[3] = calloc((size_t)m->on.rig.n, sizeof *x);
	memcpy(was, m->on.rig.rest, (size_t)m->on.rig.n * sizeof *was);
	for (int i = 0; i < m->on.rig.n; i++)
		for (int c = 0; c < 3 && m->on.rig.part[i] == RIG_SKIN && m->on.rig.gap[i] < 2; c++)  // 3 mm deeper, towards the globe's centre
			m->on.rig.rest[i][c] -= 3.0f / 14 * (m->on.rig.rest[i][c] - (float)m->on.rig.globe[m->on.rig.side[i]].center[c]);
	assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &conf, &err));
	struct deform *deform = deform_new(&m->on.rig);
	struct deform_near near = deform_near_of(&m->on.rig);
	for (int k = 0; k < 3; k++) {
		double e[RIG_COMPONENTS], turn[2][3][3], c[12], worst = 0, most = 0;
		float (*from)[3] = calloc((size_t)m->on.rig.n, sizeof *from);
		for (int pass = 0; pass < 2; pass++) {  // what it is told against: rest for a blink, else a look straight ahead
			drive_look(c, &m->on.rig, pass ? look[k][0] : 0, pass ? look[k][1] : 0, pass ? look[k][2] : 1);
			rig_components(e, &m->on.rig, c);
			rig_globes_turned(turn, &m->on.rig, c);
			deform_rest(deform, x, 0);
			deform_pose(deform, !pass && k == 0 ? m->on.rig.rest_e : e, (const double(*)[3][3])turn, x, 0);
			deform_clear(x, &m->on.rig, &near, (const double(*)[3][3])turn);
			if (!pass)
				memcpy(from, x, (size_t)m->on.rig.n * sizeof *from);
		}
		for (int i = 0; i < b.n; i++)
			for (int d = 0; d < 3; d++) {
				const double sum = (double)b.pose[(pairs[k][0] * b.n + i) * 3 + d] + (double)b.pose[(pairs[k][1] * b.n + i) * 3 + d];
				const double want = (double)x[b.vertex[i]][d] - (double)from[b.vertex[i]][d];
				worst = fmax(worst, fabs(sum - want));
				most = fmax(most, fabs(want));
			}
		print_message("two targets: %.2f mm off where the pose moves by %.2f\n", worst, most);
		assert_true(worst < 0.3);
		free(from);
	}
	memcpy(m->on.rig.rest, was, (size_t)m->on.rig.n * sizeof *was);
	free(was);
	free(x);
	deform_free(deform);
	deform_near_free(&near);
	glb_bake_free(&b);
}

/* A clip that hardly looks anywhere: the named gazes turn lids no further than it did, however steep its slopes; what was made of the same
 * slopes without end closes the eye. */
static void lids_go_no_further_than_they_are_known(void **state)
{
	struct made *m = *state;
	struct glb_bake b[3];
	struct err err = { 0 };
	const double g[2][10] = { { -4, -3, 0, 0, 0, -4, -3 }, { 4, 3, 0, 0, 0, 4, 3 } };
	const struct known was = m->on.rig.known;
	double most[3] = { 0 }, *slope = m->on.rig.W;
	for (int eye = 0; eye < 2; eye++)
		slope[5 * eye] += 5;  // px a degree
	for (int k = 0; k < 3; k++) {
		if (k)
			known_of(&m->on.rig.known, 2, g[0], 10, k == 1 ? 0 : 0.3);
		assert_true(glb_bake_make(&b[k], &m->on.rig, &m->drive, &conf, &err));
		for (int pose = 2; pose < 10; pose++)
			for (int i = 0; i < b[k].n; i++) {
				const float *d = b[k].pose + (long)(pose * b[k].n + i) * 3;
				most[k] = fmax(most[k], sqrt((double)d[0] * d[0] + (double)d[1] * d[1] + (double)d[2] * d[2]));
			}
		glb_bake_free(&b[k]);
	}
	print_message("furthest of the named gazes: %.2f mm, held %.2f, and a little further %.2f\n", most[0], most[1], most[2]);
	assert_true(most[1] < 0.35 * most[0] && most[2] > most[1] && most[2] < 1.5 * most[1]);
	m->on.rig.known = was;
	for (int eye = 0; eye < 2; eye++)
		slope[5 * eye] -= 5;
}

static void more_targets_are_closer(void **state)
{
	struct made *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	double before = INFINITY;
	for (int n = 1; n <= 9; n += 4) {
		struct glb_conf few = conf;
		few.targets = n;
		few.tolerance = 0;
		assert_true(glb_bake_make(&b, &m->on.rig, &m->drive, &few, &err));
		assert_true(b.worst < before);
		before = b.worst;
		glb_bake_free(&b);
	}
}

/* Writes the face with these eyes. */
static bool put(const struct made *m, const char *path, int left, int right, struct err *err)
{
	const struct glb_eye eye[2] = { { m->eye[left], m->size[left], 11.8 }, { m->eye[right], m->size[right], 11.8 } };
	struct glb_report report;
	return glb_write(path, &report, &m->on.rig, &m->drive, eye, "face", 0, &conf, "{\"stage\": \"render\"}", err);
}

static json_t *json_of(const char *path)
{
	char *data;
	size_t size;
	struct err err = { 0 };
	uint32_t head[5];
	assert_true(file_read(&data, &size, path, 1 << 28, &err));
	memcpy(head, data, sizeof head);
	assert_int_equal(head[0], 0x46546c67);
	assert_int_equal(head[2], size);
	json_t *root = json_loadb(data + 20, head[3], 0, 0);
	assert_non_null(root);
	free(data);
	return root;
}

static size_t count(const json_t *root, const char *key)
{
	return json_array_size(json_object_get(root, key));
}

static void container(void **state)
{
	struct made *m = *state;
	struct err err = { 0 };
	char first[33], second[33];
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(put(m, path, 0, 0, &err));
	assert_true(file_hash(first, path, 1 << 30, &err));
	assert_true(put(m, path, 0, 0, &err));
	assert_true(file_hash(second, path, 1 << 30, &err));
	assert_string_equal(first, second);
	json_t *root = json_of(path);
	assert_int_equal(count(root, "nodes"), 7 + 2 * EXPORT_PARTS);
	assert_int_equal(count(root, "meshes"), 4 + EXPORT_PARTS);  // one eye for both sides is there once
	assert_int_equal(count(root, "images"), EXPORT_PICTURES);
	assert_int_equal(count(json_array_get(json_object_get(root, "animations"), 0), "channels"), 6);
	json_decref(root);
	assert_true(put(m, path, 0, 1, &err));
	root = json_of(path);
	assert_int_equal(count(root, "meshes"), 4 + 2 * EXPORT_PARTS);
	assert_int_equal(count(root, "images"), 2 * EXPORT_PICTURES);
	json_decref(root);
	scratch_close();
}

/* The end of a node's name decides what it is. */
static json_t *named(json_t *nodes, const char *name)
{
	size_t i;
	json_t *node;
	json_array_foreach(nodes, i, node)
		if (!strcmp(json_string_value(json_object_get(node, "name")), name))
			return node;
	fail_msg("no node %s", name);
	return 0;
}

/* Each eye turns about the centre of its globe and is as large; its cornea is its own: the apex is where the eye that went in has it. */
static void eyes_in_their_sockets(void **state)
{
	struct made *m = *state;
	struct err err = { 0 };
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(put(m, path, 0, 1, &err));
	json_t *root = json_of(path), *all = json_object_get(root, "nodes");
	for (int s = 0; s < 2; s++) {
		json_t *node = named(all, s ? "eye_right" : "eye_left"), *cornea = named(all, s ? "eye_right_cornea" : "eye_left_cornea");
		const double scale = json_real_value(json_array_get(json_object_get(node, "scale"), 0));
		NEAR(scale, m->on.rig.globe[s].radius / 11.8, 1e-6);
		for (int c = 0; c < 3; c++)
			NEAR(json_real_value(json_array_get(json_object_get(node, "translation"), (size_t)c)), 1e-3 * m->on.rig.globe[s].center[c], 1e-8);
		json_t *mesh = json_array_get(json_object_get(root, "meshes"), (size_t)json_integer_value(json_object_get(cornea, "mesh")));
		json_t *primitive = json_array_get(json_object_get(mesh, "primitives"), 0);
		const json_int_t position = json_integer_value(json_object_get(json_object_get(primitive, "attributes"), "POSITION"));
		json_t *most = json_object_get(json_array_get(json_object_get(root, "accessors"), (size_t)position), "max");
		NEAR(json_real_value(json_array_get(most, 2)), 1e-3 * m->apex[s], 1e-7);
		json_t *material = json_array_get(json_object_get(root, "materials"), (size_t)json_integer_value(json_object_get(primitive, "material")));
		assert_string_equal(json_string_value(json_object_get(material, "name")), "cornea");
	}
	json_decref(root);
	assert_true(fabs(m->apex[0] - m->apex[1]) > 0.05);
	scratch_close();
}

static void no_eye_no_file(void **state)
{
	struct made *m = *state;
	struct err err = { 0 };
	struct glb_report report;
	const struct glb_eye cut[2] = { { m->eye[0], m->size[0], 11.8 }, { m->eye[1], m->size[1] / 2, 11.8 } };
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_false(glb_write(path, &report, &m->on.rig, &m->drive, cut, "face", 0, &conf, 0, &err));
	ERR_HAS(err, "eye_right: no binary glTF");
	assert_false(file_exists(path));
	scratch_close();
}

static void khronos_validator_finds_nothing(void **state)
{
	struct made *m = *state;
	struct err err = { 0 };
	if (!gltf_validator_there()) {
		print_message("skipped: no node, or npm could not install gltf-validator\n");
		skip();
	}
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(put(m, path, 0, 1, &err));
	assert_true(gltf_is_valid(path));
	scratch_close();
}

static void driving_file(void **state)
{
	struct made *m = *state;
	struct drive d;
	struct err err = { 0 };
	scratch_open();
	const char *path = scratch_text("gaze.csv", "frame,time_s,g1_deg,g2_deg,g3_deg,g4_px,g5_px,g6_deg,g7_deg,g8_deg,g9_px,g10_px,au1\n"
	                                            "0,0.1,10,-5,1,10,2,8,-5,0,-60,0,0.5\n"
	                                            "1,0.2,,,,-25,1,,,,,,\n"
	                                            "2,0.3,20,5,3,-60,0,18,5,0,10,2,1\n");
	if (!drive_load(&d, &m->on.face.model, path, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(d.n, 3);
	NEAR(drive_at(&d, 0)[3], 1, 1e-12);   // 10 px is as open as it gets
	NEAR(drive_at(&d, 1)[3], 0.5, 1e-12); // half way from -60 to 10
	NEAR(drive_at(&d, 1)[0], 15, 1e-9);   // hidden by the lid: half way in time
	NEAR(drive_at(&d, 2)[8], 1, 1e-12);
	NEAR(drive_at(&d, 1)[10], 0.75, 1e-12);
	NEAR(drive_at(&d, 2)[11], 0, 1e-12);  // an action unit the file lacks: at rest
	drive_free(&d);
	path = scratch_text("animation.csv", "time_s,g1_deg,g2_deg,g3_deg,a4,a5,g6_deg,g7_deg,g8_deg,a9,a10,brow\n0,1,2,3,0.25,1,4,5,6,0.5,1,0.5\n");
	assert_true(drive_load(&d, &m->on.face.model, path, &err));
	NEAR(drive_at(&d, 0)[3], 0.25, 1e-12);
	NEAR(drive_at(&d, 0)[10], 0.5, 1e-12);
	drive_free(&d);
	path = scratch_text("bad.csv", "time_s,g1_deg\n0.2,1\n0.1,1\n");
	assert_false(drive_load(&d, &m->on.face.model, path, &err));
	ERR_HAS(err, "bad.csv:3: time_s = 0.1");
	static const struct {
		const char *field, *says;
	} nonsense[] = {
		{ "g1_deg\n0,nan", "bad.csv:2: g1_deg = nan: must be a finite number" }, { "g7_deg\n0,1e300", "bad.csv:2: g7_deg = 1e+300: must be in [-180, 180]" },
		{ "g9_px\n0,-1e9", "bad.csv:2: g9_px = -1e+09" },                         { "a4\n0,1e6", "bad.csv:2: a4 = 1e+06" },
		{ "au1\n0,1e6", "bad.csv:2: au1 = 1e+06" },                               { "confidence_left\n0,2", "bad.csv:2: confidence_left = 2" },
	};
	for (int i = 0; i < (int)(sizeof nonsense / sizeof *nonsense); i++) {
		char text[80];
		snprintf(text, sizeof text, "time_s,%s\n", nonsense[i].field);
		err = (struct err){ 0 };
		assert_false(drive_load(&d, &m->on.face.model, scratch_text("bad.csv", text), &err));
		ERR_HAS(err, nonsense[i].says);
	}
	scratch_close();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(targets_give_the_frames_back), cmocka_unit_test(hairs_follow), cmocka_unit_test(expressions_have_targets), cmocka_unit_test(named_poses_add_up), cmocka_unit_test(lids_go_no_further_than_they_are_known),
		cmocka_unit_test(more_targets_are_closer),
		cmocka_unit_test(container),                        cmocka_unit_test(khronos_validator_finds_nothing),
		cmocka_unit_test(eyes_in_their_sockets),            cmocka_unit_test(no_eye_no_file),
		cmocka_unit_test(driving_file),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
