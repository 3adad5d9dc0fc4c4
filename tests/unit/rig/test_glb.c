/* The glTF of a driven face: what its morph targets reproduce, its container, and what Khronos's own validator says. */
#include "base/file.h"
#include "math/rng.h"
#include "rig/glb/bake.h"
#include "tests/lib/gltf.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

#include <jansson.h>

enum { FRAMES = 60 };

struct made {
	struct face face;
	struct rig rig;
	struct drive drive;
};

/* A gaze that wanders, with a blink in the middle. */
static int setup(void **state)
{
	struct made *m = calloc(1, sizeof *m);
	struct err err = { 0 };
	struct rig_conf conf = face_conf();
	face_make(&m->face, false);
	conf.map_step = 4;
	bool ok = face_rig(&m->rig, 0, &m->face, &conf, &err);
	m->drive = (struct drive){ FRAMES, 12, calloc(FRAMES, sizeof(double)), calloc(12 * FRAMES, sizeof(double)), 0 };
	for (int f = 0; f < FRAMES; f++) {
		m->drive.time[f] = f / 30.0;
		drive_look(drive_at(&m->drive, f), &m->rig, 15 * sin(f / 7.0), 10 * cos(f / 11.0), f > 25 && f < 32 ? 0 : 1);
	}
	*state = m;
	return ok ? 0 : 1;
}

static int teardown(void **state)
{
	struct made *m = *state;
	rig_free(&m->rig);
	drive_free(&m->drive);
	face_free(&m->face);
	free(m);
	return 0;
}

static const struct glb_conf conf = { .targets = 20, .tolerance = 0.02, .poses = true, .skin_rgb = { 0.5, 0.3, 0.2 },
	                                  .iris_rgb = { 0.1, 0.1, 0.2 }, .sclera_rgb = { 0.7, 0.6, 0.6 } };

/* Rest plus weighted targets is the evaluated frame, within what is reported; the quaternions turn the eyeballs likewise. */
static void targets_give_the_frames_back(void **state)
{
	struct made *m = *state;
	struct glb_bake b;
	struct err err = { 0 };
	assert_true(glb_bake_make(&b, &m->rig, &m->drive, &conf, &err));
	assert_true(b.n_targets >= 3 && b.n_targets <= conf.targets);
	struct deform *deform = deform_new(&m->rig);
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x);
	double worst = 0;
	deform_rest(deform, x, 0);
	for (int f = 0; f < FRAMES; f++) {
		double e[RIG_COMPONENTS], turn[2][3][3], *c = drive_at(&m->drive, f);
		rig_components(e, &m->rig, c);
		for (int s = 0; s < 2; s++)
			rig_globe_rotation(turn[s], &m->rig, (double[]){ c[5 * s] * M_PI / 180, c[5 * s + 1] * M_PI / 180, 0 });
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		for (int i = 0; i < b.n; i++) {
			double d[3];
			for (int k = 0; k < 3; k++) {
				d[k] = m->rig.rest[b.vertex[i]][k] - x[b.vertex[i]][k];
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
		assert_true(glb_bake_make(&b, &m->rig, &m->drive, &few, &err));
		assert_true(b.worst < before);
		before = b.worst;
		glb_bake_free(&b);
	}
}

static void container(void **state)
{
	struct made *m = *state;
	struct glb_report report;
	struct err err = { 0 };
	char *data, first[33], second[33];
	size_t size;
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(glb_write(path, &report, &m->rig, &m->drive, "face", 0, &conf, "{\"stage\": \"render\"}", &err));
	assert_true(file_hash(first, path, 1 << 30, &err));
	assert_true(glb_write(path, &report, &m->rig, &m->drive, "face", 0, &conf, "{\"stage\": \"render\"}", &err));
	assert_true(file_hash(second, path, 1 << 30, &err));
	assert_string_equal(first, second);
	assert_true(file_read(&data, &size, path, 1 << 28, &err));
	uint32_t head[5];
	memcpy(head, data, sizeof head);
	assert_int_equal(head[0], 0x46546c67);
	assert_int_equal(head[2], size);
	json_t *root = json_loadb(data + 20, head[3], 0, 0);
	assert_non_null(root);
	assert_int_equal(json_array_size(json_object_get(root, "nodes")), 4);
	assert_int_equal(json_array_size(json_object_get(json_array_get(json_object_get(root, "animations"), 0), "channels")), 3);
	json_decref(root);
	free(data);
	scratch_close();
}

static void khronos_validator_finds_nothing(void **state)
{
	struct made *m = *state;
	struct glb_report report;
	struct err err = { 0 };
	if (!gltf_validator_there()) {
		print_message("skipped: no node, or npm could not install gltf-validator\n");
		skip();
	}
	scratch_open();
	const char *path = scratch_path("face.glb");
	assert_true(glb_write(path, &report, &m->rig, &m->drive, "face", 0, &conf, 0, &err));
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
	if (!drive_load(&d, &m->face.model, path, &err))
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
	assert_true(drive_load(&d, &m->face.model, path, &err));
	NEAR(drive_at(&d, 0)[3], 0.25, 1e-12);
	NEAR(drive_at(&d, 0)[10], 0.5, 1e-12);
	drive_free(&d);
	path = scratch_text("bad.csv", "time_s,g1_deg\n0.2,1\n0.1,1\n");
	assert_false(drive_load(&d, &m->face.model, path, &err));
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
		assert_false(drive_load(&d, &m->face.model, scratch_text("bad.csv", text), &err));
		ERR_HAS(err, nonsense[i].says);
	}
	scratch_close();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(targets_give_the_frames_back), cmocka_unit_test(more_targets_are_closer),
		cmocka_unit_test(container),                    cmocka_unit_test(khronos_validator_finds_nothing),
		cmocka_unit_test(driving_file),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
