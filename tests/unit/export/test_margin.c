/* What stands on the lids round an eye that leaves alone: where it is, in the eye's own frame and size, and the file. */
#include "export/eye_glb.h"
#include "image/picture.h"
#include "math/vec.h"
#include "rig/glb/tears.h"
#include "tests/lib/gltf.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/scenes/plain_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const struct export_mesh_conf mesh = { .iris_rings = 16, .around = 24 };

struct made {
	struct driven on;
	struct scene scene;
};

static int setup(void **state)
{
	struct made *m = calloc(1, sizeof *m);
	struct scene_conf conf = conf_of(4);
	struct err err = { 0 };
	scene_of(&m->scene, &plain_eye, &conf, even, 0, 1.5);
	*state = m;
	return driven_make(&m->on, &(struct hair_conf){ .lash_mm = 9, .brow_mm = 8, .lashes = 40, .brow_hairs = 60, .margin_mm = 1.1 }, &err) ? 0 : 1;
}

static int teardown(void **state)
{
	struct made *m = *state;
	driven_free(&m->on);
	scene_free(&m->scene);
	free(m);
	return 0;
}

static void margin_free(struct export_part margin[EXPORT_MARGIN_PARTS])
{
	for (int i = 0; i < EXPORT_MARGIN_PARTS; i++)
		export_part_free(&margin[i]);
}

/* The fissure is an ellipse of 10 by 4.5 mm on a globe of 12 mm; the eye's sphere is smaller, and so is what stands on its lids. */
static void stands_round_the_eye(void **state)
{
	const struct made *m = *state;
	const double scale = m->scene.conf.sclera_radius / m->on.rig.globe[0].radius;
	for (int side = 0; side < 2; side++) {
		struct export_part margin[EXPORT_MARGIN_PARTS], *lashes = &margin[EXPORT_LASHES], *tears = &margin[EXPORT_TEARS];
		export_margin(margin, &m->scene, &m->on.rig, &m->on.hairs, side, 0.3, 0);
		assert_true(tears->n > (HAIR_RIMS - 10) * TEARS_SECTION && tears->n <= HAIR_RIMS * TEARS_SECTION);
		double low = INFINITY, high = -INFINITY;
		for (int i = 0; i < lashes->n; i++) {
			const double x = (double)lashes->x[i][0], y = (double)lashes->x[i][1], z = (double)lashes->x[i][2];
			low = fmin(low, y);
			high = fmax(high, y);
			assert_true(fabs(x) < 22 && fabs(y) < 16 && z > 0 && z < 26);
		}
		assert_true(low < -4 && high > 4 && lashes->n_corners > 1000);
		for (int i = 0; i < tears->n; i++) {
			const double y = (double)tears->x[i][1], x[3] = { (double)tears->x[i][0], y, (double)tears->x[i][2] };
			const float at[3] = { (float)x[0], (float)x[1], (float)x[2] };
			const double off = vec_norm(x) - scale * (double)globe_map_at(&m->on.rig.globe[side].map, at);
			assert_true(y < 1 && off > 0 && off < scale * 0.33);
			NEAR(vec_norm((double[]){ (double)tears->normal[i][0], (double)tears->normal[i][1], (double)tears->normal[i][2] }), 1, 1e-4);
		}
		margin_free(margin);
	}
}

static void nothing_of_the_other_side(void **state)
{
	const struct made *m = *state;
	struct export_part margin[EXPORT_MARGIN_PARTS];
	struct hairs left = m->on.hairs;
	left.n = left.n_rims = 0;
	while (m->on.hairs.hair[left.n].side == 0)
		left.n++;
	while (m->on.hairs.rim[left.n_rims].side == 0)
		left.n_rims++;
	export_margin(margin, &m->scene, &m->on.rig, &left, 1, 0.3, 0);
	assert_int_equal(margin[EXPORT_LASHES].n_corners, 0);
	assert_int_equal(margin[EXPORT_TEARS].n_corners, 0);
	margin_free(margin);
	export_margin(margin, &m->scene, &m->on.rig, &left, 0, 0, 0);
	assert_true(margin[EXPORT_LASHES].n_corners > 0);
	assert_int_equal(margin[EXPORT_TEARS].n_corners, 0);  // no height, no tears
	margin_free(margin);
}

static void khronos_validator_finds_nothing(void **state)
{
	struct made *m = *state;
	if (!gltf_validator_there()) {
		print_message("skipped: no node, or npm could not install gltf-validator\n");
		skip();
	}
	struct export_part parts[EXPORT_PARTS], margin[EXPORT_MARGIN_PARTS];
	struct export_png one, png[EXPORT_PICTURES];
	struct err err = { 0 };
	long bytes;
	scratch_open();
	export_eye_meshes(parts, &m->scene, &mesh);
	export_margin(margin, &m->scene, &m->on.rig, &m->on.hairs, 0, 0.3, 0);
	assert_true(picture_png_encode(&one.data, &one.size, (uint8_t[12]){ 0 }, 2, 2, 3, &err));
	for (int i = 0; i < EXPORT_PICTURES; i++)
		png[i] = one;
	const struct export_eye eye = { parts, png, 1.336, 4, "eye", 0, 3, margin, { 0.02, 0.015, 0.01 } };
	const char *path = scratch_path("eye.glb");
	assert_true(export_eye_glb(path, &eye, &bytes, &err));
	assert_true(gltf_is_valid(path));
	free(one.data);
	for (int i = 0; i < EXPORT_PARTS; i++)
		export_part_free(&parts[i]);
	margin_free(margin);
	scratch_close();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stands_round_the_eye),
		cmocka_unit_test(nothing_of_the_other_side),
		cmocka_unit_test(khronos_validator_finds_nothing),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
