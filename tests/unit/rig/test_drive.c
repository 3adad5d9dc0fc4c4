/* Controls over time from a table: columns, gaps, nonsense. */
#include "rig/drive.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static int setup(void **state)
{
	struct face *face = calloc(1, sizeof *face);
	face_make(face, false);
	*state = face;
	return 0;
}

static int teardown(void **state)
{
	face_free(*state);
	free(*state);
	return 0;
}

static void driving_file(void **state)
{
	const struct face *face = *state;
	struct drive d;
	struct err err = { 0 };
	scratch_open();
	const char *path = scratch_text("gaze.csv", "frame,time_s,g1_deg,g2_deg,g3_deg,g4_px,g5_px,g6_deg,g7_deg,g8_deg,g9_px,g10_px,au1\n"
	                                            "0,0.1,10,-5,1,10,2,8,-5,0,-60,0,0.5\n"
	                                            "1,0.2,,,,-25,1,,,,,,\n"
	                                            "2,0.3,20,5,3,-60,0,18,5,0,10,2,1\n");
	if (!drive_load(&d, &face->model, path, &err))
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
	assert_true(drive_load(&d, &face->model, path, &err));
	NEAR(drive_at(&d, 0)[3], 0.25, 1e-12);
	NEAR(drive_at(&d, 0)[10], 0.5, 1e-12);
	drive_free(&d);
	path = scratch_text("bad.csv", "time_s,g1_deg\n0.2,1\n0.1,1\n");
	assert_false(drive_load(&d, &face->model, path, &err));
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
		assert_false(drive_load(&d, &face->model, scratch_text("bad.csv", text), &err));
		ERR_HAS(err, nonsense[i].says);
	}
	scratch_close();
}

/* What an expression does to lids is added where they are ours to set, shut eyes stay so. */
static void expressions_take_lids(void **state)
{
	const struct face *face = *state;
	struct rig rig;
	struct err err = { 0 };
	double by[EXPRESS_LIDS] = { -0.2, -0.9, -0.3, 0.5 }, look[12], c[12];
	struct rig_conf conf = face_conf();
	assert_true(face_rig(&rig, 0, face, &conf, &err));
	memcpy(rig.expression[1], by, sizeof by);
	drive_look(look, &rig, 5, -3, 1);
	memcpy(c, look, sizeof c);
	drive_express(c, &rig, 1, 0.5, 1);
	for (int i = 0; i < 12; i++)
		NEAR(c[i] - look[i], i == 11 ? 0.5 : i == 3 ? -0.1 : i == 4 ? -0.45 : i == 8 ? -0.15 : i == 9 ? 0.25 : 0, 1e-12);
	NEAR(drive_opened(&rig, c, 0), 1, 1e-12);
	drive_look(c, &rig, 5, -3, 0.3);
	drive_express(c, &rig, 1, 1, 0.3);
	NEAR(drive_opened(&rig, c, 0), 0.3, 1e-12);
	drive_look(c, &rig, 5, -3, 0);
	drive_express(c, &rig, 1, 1, 0);
	assert_true(drive_opened(&rig, c, 1) == 0);
	assert_true(c[3] == 0 && c[4] == 0 && c[8] == 0 && c[9] == 0 && c[11] == 1);
	rig_free(&rig);
}

/* A table that says nothing of lids leaves them to the expressions; one that does is meant so. */
static void tables_mean_their_lids(void **state)
{
	struct face *face = *state;
	struct drive d;
	struct err err = { 0 };
	scratch_open();
	memcpy(face->model.expression[1], (double[]){ -0.2, -0.3, -0.4, 0 }, sizeof face->model.expression[1]);
	assert_true(drive_load(&d, &face->model, scratch_text("a.csv", "time_s,squint\n0,0.5\n1,1\n"), &err));
	NEAR(drive_at(&d, 0)[3], 0.8 - 0.1, 1e-12);
	NEAR(drive_at(&d, 1)[4], 0.8 - 0.3, 1e-12);
	NEAR(drive_at(&d, 1)[8], 0.8 - 0.4, 1e-12);
	drive_free(&d);
	assert_true(drive_load(&d, &face->model, scratch_text("b.csv", "time_s,squint,a4\n0,0.5,0.6\n1,1,0.7\n"), &err));
	NEAR(drive_at(&d, 0)[3], 0.6, 1e-12);
	NEAR(drive_at(&d, 1)[3], 0.7, 1e-12);
	NEAR(drive_at(&d, 1)[8], 0.8 - 0.4, 1e-12);  // the other eye's are not told
	drive_free(&d);
	memset(face->model.expression[1], 0, sizeof face->model.expression[1]);
	scratch_close();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(driving_file), cmocka_unit_test(expressions_take_lids), cmocka_unit_test(tables_mean_their_lids),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
