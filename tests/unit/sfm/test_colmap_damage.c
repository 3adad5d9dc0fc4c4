/* COLMAP's model files damaged: every cut, every flipped bit, thousands of other changes. None crashes, what is refused says
 * why, what is taken is a whole model. */
#include "base/file.h"
#include "base/mem.h"
#include "math/rng.h"
#include "sfm/colmap/colmap.h"
#include "tests/lib/scenes/sfm_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const char *const stems[3] = { "cameras", "images", "points3D" };

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

/* One change of a file as disks, networks and attackers make them: bits, bytes, runs of one value, pieces lost or doubled, an
 * end cut off. *size never grows by more than SPARE. */
enum { SPARE = 64 };
static void mutate(char *data, size_t *size, struct rng *rng)
{
	size_t n = *size, at = n ? (size_t)rng_below(rng, (int)n) : 0, run = 1 + (size_t)rng_below(rng, SPARE);
	if (!n)
		return;
	run = run < n - at ? run : n - at;
	switch (rng_below(rng, 6)) {
	case 0:
		data[at] = (char)(data[at] ^ 1 << rng_below(rng, 8));
		break;
	case 1:
		data[at] = (char)rng_below(rng, 256);
		break;
	case 2:
		memset(data + at, rng_below(rng, 2) ? 0xff : 0, run);
		break;
	case 3:
		memmove(data + at, data + at + run, n - at - run);
		*size = n - run;
		break;
	case 4:
		memmove(data + at + run, data + at, n - at);
		*size = n + run;
		break;
	default:
		*size = at;
	}
	data[*size] = 0;
}

/* What is taken of a changed model is one: written and read again it is the same. */
static void check_taken(const struct colmap_model *m, const char *dir)
{
	struct colmap_model again;
	struct err err = { 0 };
	assert_true(colmap_save(m, dir, COLMAP_BINARY, &err));
	if (!colmap_load(&again, dir, &err))
		fail_msg("%s", err.msg);
	assert_true(sfm_same(m, &again, 0));
	colmap_free(&again);
}

/* Thousands of changes of one to four kinds at once: each is refused with its reason, or gives a whole model. */
static void test_mutated(void **state)
{
	(void)state;
	enum { TRIALS = SANITISED ? 4000 : 20000 };
	struct colmap_model made;
	struct err err = { 0 };
	sfm_scene(&made, 4, 12, 1);
	for (int format = 0; format < 2; format++) {
		const char *dir = scratch_path("mutated%d", format), *again = scratch_path("again%d", format);
		char *data[3], *copy[3];
		size_t size[3];
		int taken = 0;
		assert_true(colmap_save(&made, dir, (enum colmap_format)format, &err));
		load_files(data, size, dir, format == COLMAP_TEXT);
		for (int trial = 0; trial < TRIALS; trial++) {
			struct rng rng = { (uint64_t)trial + 1 };
			struct colmap_model m;
			struct err why = { 0 };
			size_t sizes[3];
			int changes = 1 + rng_below(&rng, 4);
			for (int f = 0; f < 3; f++) {
				copy[f] = mem_array(size[f] + 4 * SPARE + 1, 1);
				memcpy(copy[f], data[f], size[f]);
				copy[f][sizes[f] = size[f]] = 0;
			}
			for (int k = 0; k < changes; k++) {
				int f = rng_below(&rng, 3);
				mutate(copy[f], &sizes[f], &rng);
			}
			if (colmap_parse(&m, (enum colmap_format)format, (const char *const[3]){ copy[0], copy[1], copy[2] }, sizes, stems, &why)) {
				if (taken++ % 50 == 0)
					check_taken(&m, again);
				colmap_residual(&m, -1);
				colmap_free(&m);
			} else
				assert_true(err_is(&why));
			for (int f = 0; f < 3; f++)
				free(copy[f]);
		}
		print_message("%s: %d of %d changed models are refused\n", format == COLMAP_TEXT ? "text" : "binary", TRIALS - taken, TRIALS);
		assert_in_range(taken, 1, TRIALS / 2);
		for (int f = 0; f < 3; f++)
			free(data[f]);
	}
	colmap_free(&made);
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

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_cut), cmocka_unit_test(test_flipped), cmocka_unit_test(test_mutated),
		                                cmocka_unit_test(test_counts) };
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
