/* Files: whole or not at all, and never out of the folder. */
#include "tests/lib/unit.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/work.h"
#include "tests/lib/scratch.h"

static void written_is_read(void **state)
{
	(void)state;
	struct err err = { 0 };
	char data[1000], *back;
	size_t size;
	for (size_t i = 0; i < sizeof data; i++)
		data[i] = (char)(i * 7);
	const char *path = scratch_path("a/b c/d\n'\"/e.bin");
	assert_true(file_write(path, data, sizeof data, &err));
	assert_true(file_read(&back, &size, path, sizeof data, &err));
	assert_int_equal(size, sizeof data);
	assert_memory_equal(back, data, size);
	assert_int_equal(back[size], 0);
	free(back);
	assert_false(file_read(&back, &size, path, sizeof data - 1, &err));
	ERR_HAS(err, "must be <= 999");
	assert_null(back);
}

/* What JSON's reader quotes of a damaged file stays one line. */
static void damaged_json_is_refused_in_a_line(void **state)
{
	(void)state;
	static const char text[] = "{\":n\\u\nl}";
	struct err err = { 0 };
	const char *path = scratch_path("damaged.json");
	assert_true(file_write(path, text, sizeof text - 1, &err));
	assert_null(json_read(path, 1000, &err));
	ERR_HAS(err, "not JSON");
	assert_null(strchr(err.msg, '\n'));
}

static int files_in(const char *dir)
{
	struct err err = { 0 };
	struct file_list list;
	assert_true(file_list(&list, dir, &err));
	int n = list.n;
	file_list_free(&list);
	return n;
}

/* A reader opens the file again and again while a writer replaces it: each sees one of the two, whole. */
static void replaced_at_once(void **state)
{
	(void)state;
	enum { SIZE = 1 << 18, ROUNDS = 60 };
	char *a = mem_new(SIZE, 1), *b = mem_new(SIZE, 1), *got;
	struct err err = { 0 };
	size_t size;
	memset(a, 'a', SIZE);
	memset(b, 'b', SIZE);
	const char *path = scratch_write("f", a, SIZE);
	int torn = 0;
#pragma omp parallel sections num_threads(2) private(got, size)
	{
#pragma omp section
		for (int i = 0; i < ROUNDS; i++) {
			struct err e = { 0 };
			file_write(path, i & 1 ? a : b, SIZE, &e);
		}
#pragma omp section
		for (int i = 0; i < ROUNDS; i++) {
			struct err e = { 0 };
			if (file_read(&got, &size, path, SIZE, &e))
				torn += size != SIZE || (memcmp(got, a, SIZE) && memcmp(got, b, SIZE));
			else
				torn++;
			free(got);
		}
	}
	assert_int_equal(torn, 0);
	assert_int_equal(files_in(scratch_path(".")), 1);  // nothing is left beside it
	assert_false(err_is(&err));
	free(a);
	free(b);
}

static void failed_write_leaves_what_was(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *got;
	size_t size;
	scratch_text("there", "old");
	scratch_text("dir/inner", "x");
	assert_false(file_write(scratch_path("there/below"), "new", 3, &err));  // a file where a folder has to be
	assert_true(err_is(&err));
	err = (struct err){ 0 };
	assert_false(file_write(scratch_path("dir"), "new", 3, &err));  // a folder where the file has to be
	ERR_HAS(err, "cannot write");
	assert_true(file_exists(scratch_path("dir/inner")));
	err = (struct err){ 0 };
	assert_true(file_read(&got, &size, scratch_path("there"), 10, &err));
	assert_string_equal(got, "old");
	free(got);
}

static void a_link_beside_is_not_followed(void **state)
{
	(void)state;
	// Whoever guesses the temporary name and puts a link there must not have another file overwritten.
	struct err err = { 0 };
	const char *victim = scratch_text("victim", "precious"), *path = scratch_path("out");
	char hash[33], *got;
	size_t size;
	file_hash_bytes(hash, path, strlen(path));
	hash[16] = 0;
	assert_int_equal(symlink(victim, scratch_path(".%s.new", hash)), 0);
	file_write(path, "new", 3, &err);
	err = (struct err){ 0 };
	assert_true(file_read(&got, &size, victim, 100, &err));
	assert_string_equal(got, "precious");
	free(got);
}

static void only_regular_files_are_read(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *got;
	size_t size;
	assert_int_equal(mkfifo(scratch_path("pipe"), 0600), 0);
	assert_false(file_read(&got, &size, scratch_path("pipe"), 10, &err));  // would wait for ever
	ERR_HAS(err, "not a regular file");
	err = (struct err){ 0 };
	assert_false(file_read(&got, &size, scratch_path("."), 10, &err));
	ERR_HAS(err, "is a folder");
	err = (struct err){ 0 };
	assert_false(file_read(&got, &size, scratch_path("none"), 10, &err));
	ERR_HAS(err, "none: No such file");
}

static void paths_stay_inside(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *real;
	scratch_text("in/root/file", "x");
	scratch_text("in/rootless/file", "x");
	scratch_text("in/out", "x");
	const char *root = scratch_path("in/root");
	assert_int_equal(symlink("../out", scratch_path("in/root/link")), 0);
	assert_int_equal(symlink("file", scratch_path("in/root/good")), 0);
	assert_true(file_inside(&real, root, "file", &err));
	free(real);
	assert_true(file_inside(&real, root, "good", &err));
	free(real);
	scratch_text("in/root/a..b/..c", "x");
	assert_true(file_inside(&real, root, "a..b/..c", &err));
	free(real);
	static const char *const bad[] = { "../out", "/etc/passwd", "", "a/..", "a/../../out", "link", "..", "../rootless/file" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		err = (struct err){ 0 };
		if (file_inside(&real, root, bad[i], &err))
			fail_msg("\"%s\" led out", bad[i]);
		assert_true(err_is(&err));
		assert_null(real);
	}
}

static void hashes_and_lists(void **state)
{
	(void)state;
	struct err err = { 0 };
	char a[33], b[33];
	// XXH3's 128-bit digest of no bytes, from the algorithm's published test vectors.
	file_hash_bytes(a, "", 0);
	assert_string_equal(a, "99aa06d3014798d86001c324468d497f");
	enum { SIZE = 700001 };  // more than one piece
	char *data = mem_new(SIZE, 1);
	for (int i = 0; i < SIZE; i++)
		data[i] = (char)((unsigned)i * (unsigned)i >> 3);
	file_hash_bytes(a, data, SIZE);
	assert_true(file_hash(b, scratch_write("big", data, SIZE), 1 << 30, &err));
	assert_string_equal(a, b);
	free(data);
	scratch_text("l/b", "");
	scratch_text("l/a\nb", "");
	scratch_text("l/.hidden", "");
	scratch_text("l/B", "");
	struct file_list list;
	assert_true(file_list(&list, scratch_path("l"), &err));
	assert_int_equal(list.n, 3);
	assert_string_equal(list.names[0], "B");
	assert_string_equal(list.names[1], "a\nb");
	file_list_free(&list);
	assert_true(file_list(&list, scratch_path("none"), &err));
	assert_int_equal(list.n, 0);
}

static void errors_keep_the_first(void **state)
{
	(void)state;
	struct err err = { 0 };
	assert_false(err_set(&err, "a = %d", 1));
	err_set(&err, "later");
	assert_string_equal(err.msg, "a = 1");
	err_wrap(&err, "photo %d", 2);
	assert_string_equal(err.msg, "photo 2: a = 1");
	char large[3000];
	memset(large, 'x', sizeof large - 1);
	large[sizeof large - 1] = 0;
	struct err cut = { 0 }, quoted = { 0 };
	err_set(&quoted, "%s: x = %s", "a.json", "si\nngle\x1b[1m");
	assert_string_equal(quoted.msg, "a.json: x = si ngle [1m");
	err_set(&cut, "%s", large);
	err_wrap(&cut, "%s", large);
	assert_true(strlen(cut.msg) < sizeof cut.msg);
}

/* Programs that write one file at the same moment all succeed, and what stands there is whole and of one of them. */
static void written_by_many(void **state)
{
	(void)state;
	enum { PROGRAMS = 6, TIMES = 300, SIZE = 40000 };
	const char *path = scratch_path("plan.json");
	pid_t child[PROGRAMS];
	for (int p = 0; p < PROGRAMS; p++)
		if (!(child[p] = fork())) {
			static char data[SIZE];
			struct err err = { 0 };
			memset(data, 'a' + p, sizeof data);
			for (int i = 0; i < TIMES && !err_is(&err); i++)
				file_write(path, data, (size_t)(SIZE - 1000 * p), &err);
			if (err_is(&err))
				fprintf(stderr, "%s\n", err.msg);
			_exit(err_is(&err));
		}
	for (int p = 0; p < PROGRAMS; p++) {
		int status;
		assert_int_equal(waitpid(child[p], &status, 0), child[p]);
		assert_int_equal(status, 0);
	}
	char *data;
	size_t size;
	struct err err = { 0 };
	assert_true(file_read(&data, &size, path, 1 << 20, &err));
	assert_int_equal(size, SIZE - 1000 * (data[0] - 'a'));
	for (size_t i = 0; i < size; i++)
		assert_int_equal(data[i], data[0]);
	free(data);
}

/* What a killed program left is swept away, what another is writing is not, and nothing else is touched. */
static void swept(void **state)
{
	(void)state;
	struct err err = { 0 };
	bool busy = true;
	char *capture = mem_str(scratch_path("capture"));
	char *left = mem_printf("%s/work/iris/.0123456789abcdef.new", capture), *held = mem_printf("%s/work/.fedcba9876543210.new", capture);
	const char *others[] = { "work/iris/texture.exr", "work/iris/.hidden", "work/.0123.new", "work/.0123456789abcdef.new.exr", ".0123456789abcdef.new" };
	assert_true(file_write(left, "x", 1, &err) && file_write(held, "x", 1, &err));
	for (int i = 0; i < COUNT(others); i++) {
		char *path = mem_printf("%s/%s", capture, others[i]);
		assert_true(file_write(path, "x", 1, &err));
		free(path);
	}
	int writer = open(held, O_WRONLY), lock = work_lock(capture, &busy, &err), again;
	assert_true(writer >= 0 && lock >= 0 && !busy && !flock(writer, LOCK_EX));
	work_sweep(capture);
	assert_false(file_exists(left));
	assert_true(file_exists(held));
	close(writer);
	work_sweep(capture);
	assert_false(file_exists(held));
	for (int i = 0; i < COUNT(others); i++) {
		char *path = mem_printf("%s/%s", capture, others[i]);
		assert_true(file_exists(path));
		free(path);
	}
	again = work_lock(capture, &busy, &err);
	assert_true(again >= 0 && busy);
	close(again);
	close(lock);
	free(capture);
	free(left);
	free(held);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(written_is_read),
		SCRATCH_TEST(replaced_at_once),
		SCRATCH_TEST(failed_write_leaves_what_was),
		SCRATCH_TEST(a_link_beside_is_not_followed),
		SCRATCH_TEST(only_regular_files_are_read),
		SCRATCH_TEST(paths_stay_inside),
		SCRATCH_TEST(hashes_and_lists),
		SCRATCH_TEST(written_by_many),
		SCRATCH_TEST(swept),
		SCRATCH_TEST(damaged_json_is_refused_in_a_line),
		cmocka_unit_test(errors_keep_the_first),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
