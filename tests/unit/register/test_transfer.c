/* Transfer against closed forms: B's rows, known affine maps, the same topology, units, shut eyes, holes, strays, polygons,
 * and meshes that have nothing in common. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "base/npy/npy.h"
#include "image/picture.h"
#include "register/transfer_file.h"
#include "register/transfer_picture.h"
#include "register/transfer_unit.h"
#include "tests/lib/scratch.h"
#include "tests/lib/scenes/sheet.h"
#include "tests/lib/conf/transfer_conf.h"

/* Rows of B: rising columns of the subject, weights that sum to one and make the point that distance is counted from. */
static void check_rows(const struct transfer *t, const struct mesh *subject)
{
	for (int i = 0; i < t->n; i++) {
		double sum = 0, d2 = 0;
		for (int k = 0; k < 3; k++) {
			assert_true(t->weight[i][k] >= 0 && t->column[i][k] >= 0 && t->column[i][k] < subject->n_vertices);
			assert_true(!k || t->column[i][k] > t->column[i][k - 1]);
			sum += t->weight[i][k];
		}
		NEAR(sum, 1, 1e-12);
		for (int c = 0; c < 3; c++) {
			double at = 0;
			for (int k = 0; k < 3; k++)
				at += t->weight[i][k] * (double)subject->vertices[t->column[i][k]][c];
			d2 += pow(at - (double)t->registered[i][c], 2);
		}
		NEAR(t->distance[i], sqrt(d2), 1e-4);
		assert_true(t->confidence[i] >= 0 && t->confidence[i] <= 1);
	}
}

static void run(struct transfer *out, const struct mesh *target, const struct mesh *subject)
{
	struct err err = { 0 };
	if (!transfer_run(out, target, subject, 0, &transfer_defaults, &err))
		fail_msg("%s", err.msg);
	check_rows(out, subject);
}

/* Mean distance, mm, of the snapped points from where the target's vertices lie on the sheet. n x m: the target's. */
static double astray(const struct transfer *t, const struct mesh *subject, int n, int m)
{
	double sum = 0;
	int count = 0;
	for (int j = 3; j < m - 3; j++)
		for (int i = 3; i < n - 3; i++) {
			double x = -60 + 120.0 * i / (n - 1), y = -60 + 120.0 * j / (m - 1), want[3] = { x, y, sheet_height(x, y) }, d2 = 0;
			int row = j * n + i;
			if (!(t->confidence[row] > 0.2f))
				continue;
			for (int c = 0; c < 3; c++) {
				double at = 0;
				for (int k = 0; k < 3; k++)
					at += t->weight[row][k] * (double)subject->vertices[t->column[row][k]][c];
				d2 += pow(at - want[c], 2);
			}
			sum += sqrt(d2);
			count++;
		}
	return count > n * m / 2 ? sum / count : INFINITY;
}

/* The subject's own faces: B is the identity, and the similarity is what the vertices say. */
static void test_same_topology(void **state)
{
	(void)state;
	struct mesh subject = sheet_make(50, 40, true), target = sheet_make(50, 40, true);
	double shift[3] = { 300, -20, 5 };
	sheet_move(&target, 1.5, 1.1, shift);
	struct transfer t;
	run(&t, &target, &subject);
	assert_true(t.same_topology);
	NEAR(t.scale, 1 / 1.5, 1e-5);
	for (int f = 0; f < subject.n_faces; f++) {
		int i = subject.faces[f][f % 3];
		for (int k = 0; k < 3; k++)
			NEAR(t.weight[i][k], t.column[i][k] == i, 0);
		assert_memory_equal(t.registered[i], subject.vertices[i], sizeof *t.registered);
	}
	transfer_free(&t);
	target.n_faces--;
	assert_false(transfer_same_topology(&target, &subject));
	mesh_free(&subject);
	mesh_free(&target);
}

/* Another tessellation of the same surface, moved by a known similarity. */
static void test_similar(void **state)
{
	(void)state;
	struct mesh subject = sheet_make(80, 72, true), target = sheet_make(61, 57, true);
	double shift[3] = { 6, 9, -4 };
	sheet_move(&target, 1.1, 0.3, shift);
	struct transfer t;
	run(&t, &target, &subject);
	NEAR(t.scale, 1 / 1.1, 0.004);
	assert_true(astray(&t, &subject, 61, 57) < 0.4);  // vertices are 1.6 mm apart
	// Loose vertices in the slits follow, and are not trusted.
	int loose = 37 * 61 + 16;
	NEAR(t.confidence[loose], 0, 0);
	transfer_free(&t);
	mesh_free(&subject);
	mesh_free(&target);
}

/* A known affine map that is no similarity: wider, flatter, sheared. A sheet in another shape tells no pose: landmarks do. */
static void test_affine(void **state)
{
	(void)state;
	static const int mine[] = { 6 * 61 + 6, 6 * 61 + 54, 50 * 61 + 6, 50 * 61 + 54 };  // of the target's 61 x 57
	int theirs[COUNT(mine)];
	struct mesh subject = sheet_make(80, 72, true), target = sheet_make(61, 57, true);
	for (int i = 0; i < target.n_vertices; i++) {
		float *v = target.vertices[i];
		v[0] = 1.06f * v[0] + 0.04f * v[1];
		v[1] *= 0.97f;
		v[2] = 0.94f * v[2] + 0.03f * v[0];
	}
	for (int i = 0; i < COUNT(mine); i++)
		theirs[i] = (int)lround(mine[i] / 61 * 71 / 56.0) * 80 + (int)lround(mine[i] % 61 * 79 / 60.0);
	struct nricp_landmarks landmarks = { COUNT(mine), mine, theirs };
	struct transfer t;
	struct err err = { 0 };
	assert_true(transfer_run(&t, &target, &subject, &landmarks, &transfer_defaults, &err));
	check_rows(&t, &subject);
	assert_true(astray(&t, &subject, 61, 57) < 0.8);  // up to 6 mm before
	transfer_free(&t);
	mesh_free(&subject);
	mesh_free(&target);
}

/* Shut eyes on one side, slits on the other; a hole; eyeballs and strays carried; quads. None goes into the slits. */
static void test_unlike(void **state)
{
	(void)state;
	struct mesh open = sheet_make(80, 72, true), shut = sheet_make(61, 57, false), stray = sheet_make(5, 5, false);
	struct transfer t;
	run(&t, &shut, &open);
	assert_true(astray(&t, &open, 61, 57) < 0.5);
	transfer_free(&t);
	run(&t, &open, &shut);
	assert_true(astray(&t, &shut, 80, 72) < 0.5);
	transfer_free(&t);
	const double shift[3] = { 0, 0, 10 };
	sheet_move(&stray, 0.1, 0, shift);
	struct mesh both = sheet_joined(&shut, &stray);
	run(&t, &both, &open);
	for (int i = shut.n_vertices; i < both.n_vertices; i++) {  // carried: they stay 10 mm before the skin
		NEAR(t.confidence[i], 0, 0);
		NEAR(t.registered[i][2], both.vertices[i][2], 1);
	}
	transfer_free(&t);
	mesh_free(&both);
	for (int f = 0; f < shut.n_faces; f++)  // a hole of a quarter of the sheet
		if (shut.vertices[shut.faces[f][0]][0] > 0 && shut.vertices[shut.faces[f][0]][1] < -10)
			memcpy(shut.faces[f], (int32_t[]){ 0, 0, 0 }, sizeof *shut.faces);
	run(&t, &shut, &open);
	assert_true(astray(&t, &open, 61, 57) < 0.6);
	transfer_free(&t);
	mesh_free(&stray);
	mesh_free(&open);
	mesh_free(&shut);
}

static void scaled(struct mesh *m, double by)
{
	for (int i = 0; i < 3 * m->n_vertices; i++)
		(&m->vertices[0][0])[i] *= (float)by;
}

/* Units guessed: the same face in mm, cm, dm, m. */
static void test_units(void **state)
{
	(void)state;
	struct mesh subject = sheet_make(60, 60, true);
	static const double units[] = { 1, 10, 100, 1000 };
	for (int i = 0; i < 4; i++) {
		struct mesh m = sheet_make(50, 48, true);
		scaled(&m, 1.3 / units[i]);
		NEAR(transfer_subject_unit(&m), units[i], 0);
		NEAR(transfer_target_unit(&m, &subject, 0, &transfer_defaults), units[i], 0);
		mesh_free(&m);
	}
	mesh_free(&subject);
}

/* A needle and a face have nothing in common; that is one line. */
static void test_nothing_in_common(void **state)
{
	(void)state;
	struct mesh subject = sheet_make(60, 60, true), needle = sheet_make(40, 40, false);
	for (int i = 0; i < needle.n_vertices; i++) {
		needle.vertices[i][0] *= 0.01f;
		needle.vertices[i][2] = 20 * sinf(needle.vertices[i][1]);
	}
	struct transfer t;
	struct err err = { 0 };
	assert_false(transfer_run(&t, &needle, &subject, 0, &transfer_defaults, &err));
	ERR_HAS(err, "% of the subject lies on it");
	assert_null(strchr(err.msg, '\n'));
	assert_null(t.registered);
	mesh_free(&subject);
	mesh_free(&needle);
}

/* Coordinates whose squares are no numbers in float are refused, wherever they stand. */
static void test_far_away(void **state)
{
	(void)state;
	static const float far[] = { 1e38f, -3e38f, 2e9f, INFINITY, NAN };
	for (int i = 0; i < 10; i++) {
		struct mesh mesh[2] = { sheet_make(40, 40, true), sheet_make(31, 33, true) };
		struct transfer t;
		struct err err = { 0 };
		mesh[i % 2].vertices[7 + 100 * i][i % 3] = far[i / 2];
		assert_false(transfer_run(&t, &mesh[1], &mesh[0], 0, &transfer_defaults, &err));
		ERR_HAS(err, far[i / 2] < INFINITY ? "must be within 1e+09 of 0" : "no number");
		assert_int_equal(strncmp(err.msg, "the subject: ", 13) == 0, i % 2 == 0);
		assert_null(t.registered);
		mesh_free(&mesh[0]);
		mesh_free(&mesh[1]);
	}
}

/* The picture's second panel: near is blue, far is red, what was not matched is plain; beyond the mesh is nothing. */
static void test_picture(void **state)
{
	(void)state;
	struct mesh subject = sheet_make(60, 60, false), target = sheet_make(51, 53, false);
	struct transfer t;
	struct err err = { 0 };
	run(&t, &target, &subject);
	for (int i = 0; i < t.n; i++) {
		t.distance[i] = target.vertices[i][0] > 50 ? 3 : 0.001f;  // less than 95 in 100 are near: the scale ends beyond
		t.confidence[i] = target.vertices[i][1] < 0;
	}
	const char *path = scratch_path("registration.png");
	assert_true(transfer_save_picture(&t, &target, &subject, path, &err));
	uint8_t *px;
	int width, height;
	assert_true(picture_read(&px, &width, &height, path, 1e7, &err));
	assert_true(width > 3 * 500 && height > 600);
	static const struct {
		double x, y;
		bool red, blue, nothing;
	} at[] = { { 55, -30, true, false, false }, { -20, -30, false, true, false }, { -20, 50, false, false, false }, { 0, 64, false, false, true } };
	for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
		double mm = 120 * 1.12 / 620;  // a pixel: the panel is 620 high with 6 in 100 free on either side
		const uint8_t *p = px + 3 * ((size_t)(34 + 310 - at[i].y / mm) * (size_t)width + (size_t)(width / 2.0 + at[i].x / mm));
		assert_int_equal(p[0] > p[2] + 60, at[i].red);
		assert_int_equal(p[2] > p[0] + 60, at[i].blue);
		assert_int_equal(p[0] + p[1] + p[2] < 120, at[i].nothing);
	}
	free(px);
	transfer_free(&t);
	mesh_free(&subject);
	mesh_free(&target);
}

/* What is written reads back as B. */
static void test_file(void **state)
{
	(void)state;
	struct mesh subject = sheet_make(40, 40, true), target = sheet_make(31, 33, true);
	struct transfer t;
	struct err err = { 0 };
	run(&t, &target, &subject);
	const char *path = scratch_path("b.npz");
	assert_true(transfer_save_matrix(&t, subject.n_vertices, path, 0, &err));
	struct npy indptr, data, confidence;
	assert_true(npz_read(&indptr, path, "indptr", 1 << 20, &err) && npz_read(&data, path, "data", 1 << 20, &err)
	            && npz_read(&confidence, path, "confidence", 1 << 20, &err));
	assert_int_equal(indptr.shape[0], t.n + 1);
	assert_int_equal(confidence.shape[0], t.n);
	const int32_t *p = indptr.data;
	const float *v = data.data;
	for (int i = 0; i < t.n; i++) {
		double sum = 0;
		for (int32_t k = p[i]; k < p[i + 1]; k++)
			sum += (double)v[k];
		NEAR(sum, 1, 1e-6);
	}
	npy_free(&indptr);
	npy_free(&data);
	npy_free(&confidence);
	transfer_free(&t);
	mesh_free(&subject);
	mesh_free(&target);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_same_topology), cmocka_unit_test(test_similar),           cmocka_unit_test(test_affine), cmocka_unit_test(test_unlike),
		cmocka_unit_test(test_units),         cmocka_unit_test(test_nothing_in_common), cmocka_unit_test(test_file), cmocka_unit_test(test_far_away), cmocka_unit_test(test_picture),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
