/* Rigs of a made face: the whole chain against closed forms. */
#include "base/file.h"
#include "math/rng.h"
#include "math/vec.h"
#include "rig/deform/deform.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static void rig_of(struct rig *rig, struct rig_report *report, const struct face *face, const struct rig_conf *conf)
{
	struct err err = { 0 };
	if (!face_rig(rig, report, face, conf, &err))
		fail_msg("%s", err.msg);
}

static void random_controls(double *c, int n, struct rng *rng)
{
	for (int i = 0; i < n; i++)
		c[i] = i < SKIN_EYE_INPUTS && i % 5 < 3 ? rng_range(rng, -20, 20) : rng_uniform(rng);
}

static void globes_at(double turn[2][3][3], const struct rig *rig, const double *c)
{
	for (int s = 0; s < 2; s++) {
		double gaze[3];
		for (int k = 0; k < 3; k++)
			gaze[k] = c[5 * s + k] * M_PI / 180;
		rig_globe_rotation(turn[s], rig, gaze);
	}
}

/* The folded rig, evaluated by vector code in single precision, against the model's general path in double precision and
 * the plane's own projection. */
static void affine_through_the_whole_chain(void **state)
{
	(void)state;
	struct face face;
	struct rig rig;
	struct rig_report report;
	struct rng rng = { 11 };
	face_make(&face, true);
	struct rig_conf conf = face_conf();
	rig_of(&rig, &report, &face, &conf);
	assert_int_equal(report.tracked, face.skin.n_vertices);
	struct deform *deform = deform_new(&rig);
	int n = face.model.n_vertices;
	double *u = calloc(2 * (size_t)n, sizeof *u), *u_rest = calloc(2 * (size_t)n, sizeof *u), c[12], e[RIG_COMPONENTS], turn[2][3][3];
	float (*x)[3] = calloc((size_t)rig.n, sizeof *x), (*normal)[3] = calloc((size_t)rig.n, sizeof *normal);
	deform_rest(deform, x, normal);
	skin_model_predict(u_rest, 0, &face.model, face.model.rest_controls);
	for (int round = 0; round < 20; round++) {
		random_controls(c, 12, &rng);
		skin_model_predict(u, 0, &face.model, c);
		rig_components(e, &rig, c);
		globes_at(turn, &rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, normal);
		for (int i = 0; i < n; i++) {
			double px = rig.home[i][0] + u[2 * i] - u_rest[2 * i], py = rig.home[i][1] + u[2 * i + 1] - u_rest[2 * i + 1];
			// A thousandth of a millimetre: single precision of px near 1000 and of the map.
			NEAR(x[i][0], (px - 640) * 588 / 5000, 1e-3);
			NEAR(x[i][1], -(py - 360) * 588 / 5000, 1e-3);
			NEAR(x[i][2], 12, 1e-3);
			NEAR(normal[i][2], 1, 1e-4);
		}
	}
	free(u);
	free(u_rest);
	free(x);
	free(normal);
	deform_free(deform);
	rig_free(&rig);
	face_free(&face);
}

static void at_rest_nothing_moves(void **state)
{
	(void)state;
	struct face face;
	struct rig rig;
	struct rig_report report;
	face_make(&face, false);
	struct rig_conf conf = face_conf();
	rig_of(&rig, &report, &face, &conf);
	struct deform *deform = deform_new(&rig);
	double e[RIG_COMPONENTS], turn[2][3][3];
	float (*x)[3] = calloc((size_t)rig.n, sizeof *x), (*normal)[3] = calloc((size_t)rig.n, sizeof *normal);
	deform_rest(deform, x, normal);
	rig_components(e, &rig, face.model.rest_controls);
	globes_at(turn, &rig, (double[10]){ 0 });
	deform_pose(deform, e, (const double(*)[3][3])turn, x, normal);
	for (int i = 0; i < rig.n; i++)
		for (int c = 0; c < 3 && rig.gap[i] > 0.06; c++) {
			NEAR(x[i][c], rig.rest[i][c], 2e-3);
			NEAR(normal[i][c], rig.normal[i][c], 2e-3);
		}
	free(x);
	free(normal);
	deform_free(deform);
	rig_free(&rig);
	face_free(&face);
}

static void no_vertex_inside_a_globe(void **state)
{
	(void)state;
	struct face face;
	struct rig rig;
	struct rig_report report;
	struct rng rng = { 12 };
	face_make(&face, false);
	// Some skin is made to lie in the globe, as sloppy characters have it.
	for (int i = 0; i < face.skin.n_vertices; i += 7)
		face.character.vertices[i][2] -= 2.5f;
	struct rig_conf conf = face_conf();
	rig_of(&rig, &report, &face, &conf);
	assert_true(report.inside_at_rest > 10);
	assert_true(rig.globe[0].own && rig.globe[1].own);
	NEAR(rig.globe[0].radius, 12, 0.05);
	NEAR(rig.globe[1].center[0], -31, 0.05);
	struct deform *deform = deform_new(&rig);
	float (*x)[3] = calloc((size_t)rig.n, sizeof *x);
	deform_rest(deform, x, 0);
	for (int round = 0; round < 40; round++) {
		double c[12], e[RIG_COMPONENTS], turn[2][3][3], least = 1e9;
		random_controls(c, 12, &rng);
		rig_components(e, &rig, c);
		for (int k = 0; k < RIG_COMPONENTS; k++)  // wilder than any model
			e[k] += rng_range(&rng, -60, 60);
		globes_at(turn, &rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		for (int i = 0; i < face.skin.n_vertices; i++)
			for (int s = 0; s < 2; s++)
				least = fmin(least, rig_globe_distance(&rig, s, (const double(*)[3])turn[s], x[i]));
		assert_true(least > 0.05 - 1e-3);  // least_mm, less single precision
	}
	free(x);
	deform_free(deform);
	rig_free(&rig);
	face_free(&face);
}

static void weights_sum_to_one_and_motion_fades(void **state)
{
	(void)state;
	struct face face;
	struct rig rig;
	struct rig_report report;
	face_make(&face, false);
	int far = 0, near = 0;
	for (int i = 0; i < face.model.n_vertices; i++) {
		const float *v = face.skin.vertices[i];
		bool near_eye = hypot(fabs(v[0]) - 31, v[1]) < 18;
		if (!near_eye || i % 5 == 0)  // beyond 18 mm of an eye, and here and there
			face.model.vertex_rms[i] = NAN;
	}
	struct rig_conf conf = face_conf();
	rig_of(&rig, &report, &face, &conf);
	assert_true(report.extrapolated > 500 && report.still > 20);
	for (int i = 0; i < rig.n; i++) {
		double sum = 0;
		for (int k = rig.bplus.start[i]; k < rig.bplus.start[i + 1]; k++) {
			sum += rig.bplus.weight[k];
			assert_true(rig.bplus.weight[k] >= 0);
			assert_true(rig.source[rig.bplus.column[k]] != RIG_EXTRAPOLATED || rig.part[i] != RIG_SKIN);
		}
		NEAR(sum, 1, 1e-6);
		if (rig.part[i] != RIG_SKIN || rig.source[i] != RIG_EXTRAPOLATED)
			continue;
		// The first component translates all that is tracked by 1 px: an extrapolated vertex moves by its fade.
		const float *v = rig.rest[i];
		double d = hypot(fabs(v[0]) - 31, v[1]);
		NEAR(rig.basis[i][0], rig.fade[i], 1e-5);
		if (d > 18 + 22)
			assert_true(rig.fade[i] == 0), far++;
		if (d < 17 && d > 15)
			assert_true(rig.fade[i] > 0.9), near++;
	}
	assert_true(near > 10);
	assert_true(far > 3);
	rig_free(&rig);
	face_free(&face);
}

/* a/rig.npz as it was before rigs knew what expressions do to lids, or how much of her iris the person's own lower lids cover: that array under another name. */
static void without(const char *array)
{
	char name[64];
	snprintf(name, sizeof name, "%s.npy", array);
	char *bytes;
	size_t size;
	int renamed = 0;
	struct err err = { 0 };
	assert_true(file_read(&bytes, &size, scratch_path("a/rig.npz"), 1 << 30, &err));
	for (size_t i = 0; i + strlen(name) < size; i++)
		if (!memcmp(bytes + i, name, strlen(name))) {
			bytes[i] = 'E';
			renamed++;
		}
	assert_int_equal(renamed, 2);  // before the array, and in the directory
	scratch_text("d/rig.npz", "");
	assert_true(file_write(scratch_path("d/rig.npz"), bytes, size, &err));
	free(bytes);
}

static void file_brings_back_the_same_rig(void **state)
{
	(void)state;
	struct face face;
	struct rig rig, back;
	struct rig_report report;
	struct err err = { 0 };
	char first[33], second[33];
	face_make(&face, false);
	struct rig_conf conf = face_conf();
	conf.map_step = 8;
	rig_of(&rig, &report, &face, &conf);
	scratch_open();
	rig.expression[1][3] = -0.9;
	rig.own_low.share[1][2][3] = 0.25f;
	assert_true(rig_save(&rig, scratch_path("a/rig.npz"), "{}", &err));
	if (!rig_load(&back, scratch_path("a/rig.npz"), &err))
		fail_msg("%s", err.msg);
	assert_true(rig_save(&back, scratch_path("b/rig.npz"), "{}", &err));
	assert_true(file_hash(first, scratch_path("a/rig.npz"), 1 << 30, &err) && file_hash(second, scratch_path("b/rig.npz"), 1 << 30, &err));
	assert_string_equal(first, second);
	assert_true(back.expression[1][3] == -0.9 && back.expression[0][3] == 0 && back.aperture_px[0] == 70);
	assert_true(back.own_low.share[1][2][3] == 0.25f);
	rig_free(&back);
	without("expression_lids");
	if (!rig_load(&back, scratch_path("d/rig.npz"), &err))
		fail_msg("%s", err.msg);
	assert_true(back.expression[1][3] == 0 && back.W[3] == rig.W[3]);
	rig_free(&back);
	without("own_lower_lids");
	if (!rig_load(&back, scratch_path("d/rig.npz"), &err))
		fail_msg("%s", err.msg);
	assert_true(back.own_low.share[1][2][3] == 1 && back.expression[1][3] == -0.9);
	rig_free(&back);
	rig.expression[1][3] = 1e6;
	assert_true(rig_save(&rig, scratch_path("a/rig.npz"), "{}", &err));
	assert_false(rig_load(&back, scratch_path("a/rig.npz"), &err));
	ERR_HAS(err, "expression_lids: 1e+06: must be in [-100, 100]");
	err = (struct err){ 0 };
	back.n = 5;
	scratch_text("c/rig.npz", "no zip");
	assert_false(rig_load(&back, scratch_path("c/rig.npz"), &err));
	ERR_HAS(err, "rig.npz");
	scratch_close();
	rig_free(&rig);
	face_free(&face);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(affine_through_the_whole_chain),
		cmocka_unit_test(at_rest_nothing_moves),
		cmocka_unit_test(no_vertex_inside_a_globe),
		cmocka_unit_test(weights_sum_to_one_and_motion_fades),
		cmocka_unit_test(file_brings_back_the_same_rig),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
