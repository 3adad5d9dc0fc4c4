/* The glTF of a driven face: its container, the eyes in it, and what Khronos's own validator says. */
#include "base/file.h"
#include "export/eye_glb.h"
#include "image/picture.h"
#include "rig/glb/glb.h"
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

static struct glb_conf conf;

static int setup(void **state)
{
	struct made *m = calloc(1, sizeof *m);
	struct err err = { 0 };
	bool ok = driven_make(&m->on, &(struct hair_conf){ .lash_mm = 9, .brow_mm = 8, .lashes = 40, .brow_hairs = 60, .margin_mm = 1.1 }, &err) && eye_make(m, 0, &err) && eye_make(m, 1, &err);
	m->drive = driven_wanders(&m->on, FRAMES);
	conf = driven_glb(&m->on);
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

/* The blink of its own moves skin, lashes, brows and tears, each by the blink's targets and by what goes with those: 4 w (1 - w). */
static void a_blink_of_its_own(void **state)
{
	struct made *m = *state;
	struct err err = { 0 };
	char *data;
	size_t size;
	uint32_t text;
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(put(m, path, 0, 0, &err));
	assert_true(file_read(&data, &size, path, 1 << 28, &err));
	memcpy(&text, data + 12, sizeof text);
	json_t *root = json_of(path), *blink = json_array_get(json_object_get(root, "animations"), 1), *accessors = json_object_get(root, "accessors");
	assert_string_equal(json_string_value(json_object_get(blink, "name")), "blink");
	assert_int_equal(count(blink, "channels"), 4);
	for (size_t i = 0; i < 4; i++) {
		json_t *mesh = json_array_get(json_object_get(root, "meshes"), i), *extras = json_object_get(mesh, "extras"), *names = json_object_get(extras, "targetNames");
		json_t *driven = json_array_get(json_object_get(extras, "drivenTargets"), 1);
		assert_string_equal(json_string_value(json_object_get(driven, "target")), "eyeBlinkRight_half");
		assert_string_equal(json_string_value(json_object_get(driven, "by")), "eyeBlinkRight");
		json_t *out = json_array_get(accessors, (size_t)json_integer_value(json_object_get(json_array_get(json_object_get(blink, "samplers"), i), "output")));
		json_t *view = json_array_get(json_object_get(root, "bufferViews"), (size_t)json_integer_value(json_object_get(out, "bufferView")));
		const size_t all = json_array_size(names), keys = (size_t)json_integer_value(json_object_get(out, "count")) / all;
		const char *from = data + 28 + text + json_integer_value(json_object_get(view, "byteOffset"));
		double most = 0;
		for (size_t key = 0; key < keys; key++)
			for (size_t k = 0; k < all; k++) {
				const char *name = json_string_value(json_array_get(names, k));
				int16_t share[2] = { 0 };
				memcpy(&share[0], from + 2 * (key * all + k), sizeof *share);
				if (strcmp(name, "eyeBlinkLeft"))
					continue;
				for (size_t j = 0; j < all; j++)
					if (!strcmp(json_string_value(json_array_get(names, j)), "eyeBlinkLeft_half"))
						memcpy(&share[1], from + 2 * (key * all + j), sizeof *share);
				const double w = share[0] / 32767.0;
				NEAR(share[1] / 32767.0, 4 * w * (1 - w), 2e-4);
				most = fmax(most, w);
			}
		NEAR(most, 1, 1e-6);
	}
	json_decref(root);
	free(data);
	scratch_close();
}

/* What a blink lacks in an expression is a target of every mesh, and says whose weights it goes with. */
static void blinks_in_expressions_are_listed(void **state)
{
	struct made *m = *state;
	struct err err = { 0 };
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(put(m, path, 0, 0, &err));
	json_t *root = json_of(path);
	for (size_t i = 0; i < 4; i++) {
		json_t *extras = json_object_get(json_array_get(json_object_get(root, "meshes"), i), "extras"), *names = json_object_get(extras, "targetNames"), *target;
		size_t k, found = 0;
		json_array_foreach(json_object_get(extras, "drivenTargets"), k, target) {
			const char *name = json_string_value(json_object_get(target, "target"));
			bool there = false;
			for (size_t j = 0; j < json_array_size(names); j++)
				there = there || !strcmp(json_string_value(json_array_get(names, j)), name);
			assert_true(there);
			if (strcmp(name, "eyeBlinkRight_squint"))
				continue;
			assert_string_equal(json_string_value(json_object_get(target, "by")), "eyeBlinkRight");
			assert_string_equal(json_string_value(json_object_get(target, "and")), "squint");
			assert_string_equal(json_string_value(json_object_get(target, "weight")), "w v");
			found++;
		}
		assert_int_equal(found, 1);
	}
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(container),
		cmocka_unit_test(a_blink_of_its_own),
		cmocka_unit_test(blinks_in_expressions_are_listed),
		cmocka_unit_test(khronos_validator_finds_nothing),
		cmocka_unit_test(eyes_in_their_sockets),
		cmocka_unit_test(no_eye_no_file),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
