/* COLMAP's model files: a model made here in both formats, texts that break a rule, and the program itself where it is installed. */
#include <sys/wait.h>

#include "base/file.h"
#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "sfm/colmap/colmap.h"
#include "tests/lib/scenes/sfm_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

/* What stands in memory comes back bit for bit from both formats. */
static void test_round_trip(void **state)
{
	(void)state;
	struct colmap_model made, read;
	struct err err = { 0 };
	for (int format = 0; format < 2; format++) {
		sfm_scene(&made, 7, 60, 3);
		const char *dir = scratch_path("trip%d", format);
		assert_true(colmap_save(&made, dir, (enum colmap_format)format, &err));
		if (!colmap_load(&read, dir, &err))
			fail_msg("%s", err.msg);
		assert_true(sfm_same(&made, &read, 0));
		assert_true(colmap_check_errors(&read, dir, &err));
		colmap_free(&made);
		colmap_free(&read);
	}
}

static void test_refused(void **state)
{
	(void)state;
	static const char *const stems[3] = { "cameras", "images", "points3D" };
	static const char points[] = "1 0 0 5 1 2 3 -1 1 0 2 0\n";
	static const char images[] = "1 1 0 0 0 0 0 0 1 a b.jpg\n10 10 1\n2 1 0 0 0 1 0 0 1 b.jpg\n20 10 1\n";
	static const struct {
		const char *cameras, *images, *points, *says;
	} bad[] = {
		{ "1 PINHOLE 100 80 90 90 50 40\n", images, points, 0 },
		{ "# comment\n1 SIMPLE_RADIAL 100 80 90 50 40 0.1\r\n", images, points, 0 },
		{ "1 PINHOLE 100 80 90 90 50\n", images, points, "cameras:1: a number is missing" },
		{ "1 PINHOLE 100 80 90 90 50 40 1\n", images, points, "more on the line" },
		{ "1 HOLE 100 80 90 90 50 40\n", images, points, "no such camera model" },
		{ "1 PINHOLE 100 0 90 90 50 40\n", images, points, "100 x 0 pixels" },
		{ "1 PINHOLE 100 80 -90 90 50 40\n", images, points, "a parameter is out of range" },
		{ "1 PINHOLE 100 80 nan 90 50 40\n", images, points, "a parameter is out of range" },
		{ "2 PINHOLE 100 80 90 90 50 40\n", images, points, "camera 1 does not exist" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", "1 1 1 0 0 0 0 0 1 a.jpg\n\n", "", "its quaternion has length" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", "1 1 0 0 0 0 0 0 1 a.jpg\n", "", "ends before the image's observations" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", "1 1 0 0 0 0 0 0 1\n\n", "", "the image has no name" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", "1 1 0 0 0 0 0 0 1 a\n\n1 1 0 0 0 0 0 0 1 b\n\n", "", "image 1 stands there twice" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", "1 1 0 0 0 0 0 0 1 a\n1 1 7\n", "", "point 7 does not exist" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", images, "1 0 0 5 1 2 3 -1 1 0\n", "1 observations, the images have 2" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", images, "1 0 0 5 1 2 3 -1 1 0 1 0\n", "is its alone" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", images, "1 0 0 5 1 2 3 -1 1 0 2 9\n", "is its alone" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", images, "1 0 0 inf 1 2 3 -1 1 0 2 0\n", "is out of range" },
		{ "1 PINHOLE 100 80 90 90 50 40\n", images, "1 0 0 5 1 2 333 -1 1 0 2 0\n", "a whole number is missing" },
	};
	for (int i = 0; i < COUNT(bad); i++) {
		const char *const data[] = { bad[i].cameras, bad[i].images, bad[i].points };
		const size_t size[] = { strlen(data[0]), strlen(data[1]), strlen(data[2]) };
		struct colmap_model m;
		struct err err = { 0 };
		bool ok = colmap_parse(&m, COLMAP_TEXT, data, size, stems, &err);
		if (ok != !bad[i].says)
			fail_msg("case %d: %s", i, err.msg);
		if (bad[i].says)
			ERR_HAS(err, bad[i].says);
		else
			assert_string_equal(m.images[0].name, "a b.jpg");
		colmap_free(&m);
	}
}

/* The scene is projected through colmap_to_camera's camera model by its own formula: noise of 0.3 px comes back. */
static void test_residual(void **state)
{
	(void)state;
	struct colmap_model m;
	sfm_scene(&m, 9, 400, 2);
	double mean = 0;
	long n = 0;
	for (int i = 0; i < m.n_points; i++) {
		mean += m.points[i].error * m.points[i].n_track;
		n += m.points[i].n_track;
	}
	NEAR(colmap_residual(&m, -1), mean / (double)n, 1e-9);
	// Normal noise of sigma 0.3 px in x and y lies 0.3 sqrt(pi / 2) away on average; 3600 observations: 1 % of it.
	NEAR(colmap_residual(&m, -1), 0.3 * sqrt(M_PI / 2), 0.015);
	colmap_free(&m);
}

static void test_rotations(void **state)
{
	(void)state;
	struct rng rng = { 5 };
	for (int i = 0; i < 2000; i++) {
		double q[4], back[4], R[3][3], n = 0, I[3][3], T[3][3];
		for (int k = 0; k < 4; k++) {
			// Half turns, where one formula alone would divide by nothing, come up often.
			q[k] = i % 3 == 0 && k == 0 ? 0 : rng_normal(&rng);
			n += q[k] * q[k];
		}
		for (int k = 0; k < 4; k++)
			q[k] /= sqrt(n);
		if (q[0] < 0)
			for (int k = 0; k < 4; k++)
				q[k] = -q[k];
		colmap_rotation(R, q);
		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++)
				T[a][b] = R[b][a];
		mat_mul(I, R, T);
		for (int a = 0; a < 9; a++)
			NEAR(I[a / 3][a % 3], a % 4 == 0, 1e-14);
		sfm_quaternion(back, R);
		double dot = 0;
		for (int k = 0; k < 4; k++)
			dot += q[k] * back[k];
		NEAR(fabs(dot), 1, 1e-14);
	}
}

/* Runs `colmap model_converter`; false where the program is not there. */
static bool convert(const char *from, const char *to, const char *type)
{
	struct err err = { 0 };
	assert_true(file_mkdirs(to, &err));
	fflush(stdout);
	pid_t pid = fork();
	if (!pid) {
		setenv("QT_QPA_PLATFORM", "offscreen", 1);
		if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
			_exit(1);
		execlp("colmap", "colmap", "model_converter", "--input_path", from, "--output_path", to, "--output_type", type, (char *)0);
		_exit(127);
	}
	int status;
	waitpid(pid, &status, 0);
	if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
		return false;
	assert_true(WIFEXITED(status) && !WEXITSTATUS(status));
	return true;
}

/* What we write the program reads, and what it writes of that we read: binary to text to binary. */
static void test_against_program(void **state)
{
	(void)state;
	struct colmap_model made, text, binary;
	struct err err = { 0 };
	sfm_scene(&made, 8, 150, 4);
	const char *a = scratch_path("a"), *b = scratch_path("b"), *c = scratch_path("c");
	assert_true(colmap_save(&made, a, COLMAP_BINARY, &err));
	if (!convert(a, b, "TXT")) {
		colmap_free(&made);
		print_message("colmap is not installed\n");
		skip();
	}
	assert_true(convert(b, c, "BIN"));
	if (!colmap_load(&text, b, &err) || !colmap_load(&binary, c, &err))
		fail_msg("%s", err.msg);
	// The program renumbers nothing; its text has 17 digits, but it normalises the quaternions again.
	assert_true(sfm_same(&made, &text, 1e-12));
	assert_true(sfm_same(&made, &binary, 1e-12));
	assert_true(colmap_check_errors(&binary, c, &err));
	assert_true(colmap_save(&made, a, COLMAP_TEXT, &err));
	const char *d = scratch_path("d"), *only_text = scratch_path("e");
	assert_true(colmap_save(&made, only_text, COLMAP_TEXT, &err) && convert(only_text, d, "BIN"));
	colmap_free(&binary);
	assert_true(colmap_load(&binary, d, &err));
	assert_true(sfm_same(&made, &binary, 1e-12));
	colmap_free(&made);
	colmap_free(&text);
	colmap_free(&binary);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_round_trip), cmocka_unit_test(test_refused), cmocka_unit_test(test_residual),
		cmocka_unit_test(test_rotations),  cmocka_unit_test(test_against_program),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
