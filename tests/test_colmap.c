/* COLMAP's model files: a model made here in both formats, every cut and every flipped bit of it, and the program itself
 * where it is installed. */
#include <sys/wait.h>

#include "base/file.h"
#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "optics/colmap.h"
#include "tests/lib/scratch.h"
#include "tests/lib/sfm_scene.h"
#include "tests/lib/unit.h"

static const char *const stems[3] = { "cameras", "images", "points3D" };

static bool same_model(const struct colmap_model *a, const struct colmap_model *b, double slack)
{
	if (a->n_cameras != b->n_cameras || a->n_images != b->n_images || a->n_points != b->n_points)
		return false;
	bool ok = true;
	for (int i = 0; i < a->n_cameras; i++)
		ok &= a->cameras[i].id == b->cameras[i].id && a->cameras[i].kind == b->cameras[i].kind
		      && a->cameras[i].width == b->cameras[i].width && a->cameras[i].height == b->cameras[i].height
		      && !memcmp(a->cameras[i].params, b->cameras[i].params, sizeof a->cameras[i].params);
	for (int i = 0; i < a->n_images; i++) {
		const struct colmap_image *p = &a->images[i], *q = &b->images[i];
		ok &= p->id == q->id && !strcmp(p->name, q->name) && p->camera == q->camera && p->n_seen == q->n_seen;
		for (int k = 0; k < 4; k++)
			ok &= fabs(p->q[k] - q->q[k]) <= slack;
		for (int k = 0; k < 3; k++)
			ok &= fabs(p->t[k] - q->t[k]) <= slack;
		for (int k = 0; ok && k < p->n_seen; k++)
			ok &= p->seen[k].point == q->seen[k].point && fabs(p->seen[k].px[0] - q->seen[k].px[0]) <= 1e3 * slack
			      && fabs(p->seen[k].px[1] - q->seen[k].px[1]) <= 1e3 * slack;
	}
	for (int i = 0; ok && i < a->n_points; i++) {
		const struct colmap_point *p = &a->points[i], *q = &b->points[i];
		ok &= p->id == q->id && p->n_track == q->n_track && !memcmp(p->rgb, q->rgb, 3) && fabs(p->error - q->error) <= slack;
		for (int k = 0; k < 3; k++)
			ok &= fabs(p->xyz[k] - q->xyz[k]) <= slack;
		for (int k = 0; ok && k < p->n_track; k++)
			ok &= p->track[k].image == q->track[k].image && p->track[k].seen == q->track[k].seen;
	}
	return ok;
}

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
		assert_true(same_model(&made, &read, 0));
		assert_true(colmap_check_errors(&read, dir, &err));
		colmap_free(&made);
		colmap_free(&read);
	}
}

static void load_files(char *data[3], size_t size[3], const char *dir, bool text)
{
	struct err err = { 0 };
	for (int i = 0; i < 3; i++) {
		char *path = mem_printf("%s/%s.%s", dir, stems[i], text ? "txt" : "bin");
		assert_true(file_read(&data[i], &size[i], path, 1 << 20, &err));
		free(path);
	}
}

static bool parses(enum colmap_format format, char *data[3], const size_t size[3], bool whole, struct err *err)
{
	struct colmap_model m;
	const char *const view[3] = { data[0], data[1], data[2] };
	if (!colmap_parse(&m, format, view, size, stems, err))
		return false;
	bool ok = !whole || colmap_check_errors(&m, "model", err);
	colmap_free(&m);
	return ok;
}

/* A binary file cut anywhere is refused; so is a text cut before its last line. */
static void test_cut(void **state)
{
	(void)state;
	struct colmap_model made;
	struct err err = { 0 };
	sfm_scene(&made, 4, 12, 1);
	for (int format = 0; format < 2; format++) {
		const char *dir = scratch_path("cut%d", format);
		char *data[3];
		size_t size[3];
		assert_true(colmap_save(&made, dir, (enum colmap_format)format, &err));
		load_files(data, size, dir, format == COLMAP_TEXT);
		for (int f = 0; f < 3; f++) {
			size_t was = size[f], stop = was;
			while (format == COLMAP_TEXT && stop > 1 && data[f][stop - 2] != '\n')
				stop--;
			// A text may lose its last newline, or digits of its very last number: that is no cut anyone could see here.
			for (size_t n = 0; n < (format == COLMAP_TEXT ? stop - 1 : was); n++) {
				char *cut = mem_array(n + 1, 1), *keep = data[f];
				memcpy(cut, keep, n);
				cut[n] = 0;
				size[f] = n;
				data[f] = cut;
				struct err why = { 0 };
				if (parses((enum colmap_format)format, data, size, true, &why))
					fail_msg("%s cut after %zu of %zu bytes is taken", stems[f], n, was);
				assert_true(err_is(&why));
				free(cut);
				data[f] = keep;
			}
			size[f] = was;
		}
		for (int f = 0; f < 3; f++)
			free(data[f]);
	}
	colmap_free(&made);
}

/* Every single flipped bit of a sealed model is refused. Without the seal nothing crashes, and the stored errors give
 * away most of what the ranges let pass. */
static void test_flipped(void **state)
{
	(void)state;
	struct colmap_model made, read;
	struct err err = { 0 };
	const char *dir = scratch_path("flipped");
	char *data[3];
	size_t size[3];
	long bits = 0, let_pass = 0;
	sfm_scene(&made, 4, 12, 1);
	assert_true(colmap_save(&made, dir, COLMAP_BINARY, &err) && colmap_seal(dir, &err));
	load_files(data, size, dir, false);
	for (int f = 0; f < 3; f++) {
		char *path = mem_printf("%s/%s.bin", dir, stems[f]);
		for (size_t bit = 0; bit < 8 * size[f]; bit++) {
			struct err why = { 0 };
			data[f][bit / 8] = (char)(data[f][bit / 8] ^ 1 << bit % 8);
			bits++;
			let_pass += parses(COLMAP_BINARY, data, size, true, &why);
			if (bit % 37 == 0) {
				assert_true(file_write(path, data[f], size[f], &err));
				assert_false(colmap_load(&read, dir, &why));
				assert_true(err_is(&why));
			}
			data[f][bit / 8] = (char)(data[f][bit / 8] ^ 1 << bit % 8);
		}
		assert_true(file_write(path, data[f], size[f], &err));
		free(path);
	}
	if (!colmap_load(&read, dir, &err))
		fail_msg("%s", err.msg);
	colmap_free(&read);
	// Ids, names, colours, sizes of pictures, the sign of a quaternion and the last digits of a number are as good as
	// others: nothing contradicts them but the seal.
	print_message("without a seal %.1f %% of the flipped bits are refused\n", 100 - 100.0 * (double)let_pass / (double)bits);
	assert_true((double)let_pass < 0.5 * (double)bits);
	for (int f = 0; f < 3; f++)
		free(data[f]);
	colmap_free(&made);
}

static void test_refused(void **state)
{
	(void)state;
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

/* A count the file cannot hold is refused before anything of that size is allocated. */
static void test_counts(void **state)
{
	(void)state;
	static char huge[8] = { -1, -1, -1, -1, -1, -1, -1, 0x7f };
	static char none[8];
	for (int f = 0; f < 3; f++) {
		const char *const data[] = { f == 0 ? huge : none, f == 1 ? huge : none, f == 2 ? huge : none };
		const size_t size[] = { 8, 8, 8 };
		struct colmap_model m;
		struct err err = { 0 };
		assert_false(colmap_parse(&m, COLMAP_BINARY, data, size, stems, &err));
		ERR_HAS(err, "the file ends before");
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
		colmap_quaternion(back, R);
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
	assert_true(same_model(&made, &text, 1e-12));
	assert_true(same_model(&made, &binary, 1e-12));
	assert_true(colmap_check_errors(&binary, c, &err));
	assert_true(colmap_save(&made, a, COLMAP_TEXT, &err));
	const char *d = scratch_path("d"), *only_text = scratch_path("e");
	assert_true(colmap_save(&made, only_text, COLMAP_TEXT, &err) && convert(only_text, d, "BIN"));
	colmap_free(&binary);
	assert_true(colmap_load(&binary, d, &err));
	assert_true(same_model(&made, &binary, 1e-12));
	colmap_free(&made);
	colmap_free(&text);
	colmap_free(&binary);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_round_trip), cmocka_unit_test(test_cut),       cmocka_unit_test(test_flipped),
		cmocka_unit_test(test_refused),    cmocka_unit_test(test_counts),    cmocka_unit_test(test_residual),
		cmocka_unit_test(test_rotations),  cmocka_unit_test(test_against_program),
	};
	scratch_open();
	int failed = cmocka_run_group_tests(tests, 0, 0);
	scratch_close();
	return failed;
}
