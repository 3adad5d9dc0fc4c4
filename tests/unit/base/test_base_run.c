/* Programs run from a program: what they say, how they end, what is said of it. */
#include <signal.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/run.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static void collect(void *ctx, const char *line)
{
	char *all = ctx;
	strncat(all, line, 400);
	strcat(all, "|");
}

static bool run_sh(const char *script, char said[4096], struct err *err)
{
	const char *const argv[] = { "sh", "-c", script, 0 };
	const char *const env[] = { "RUN_TEST=here", "PATH=/bin:/usr/bin", 0 };
	said[0] = 0;
	return run_program(&(struct run){ argv, env, scratch_path("log"), collect, said, 0, 0 }, err);
}

static void test_says(void **state)
{
	(void)state;
	char said[4096], *log;
	size_t size;
	struct err err = { 0 };
	assert_true(run_sh("echo one; echo two >&2; printf 'a\\033b\\rthree '; echo $RUN_TEST", said, &err));
	assert_string_equal(said, "one|two|ab|three here|");
	assert_true(file_read(&log, &size, scratch_path("log"), 10000, &err));
	assert_non_null(strstr(log, "one\ntwo\n"));
	free(log);
	const char *const pwd[] = { "pwd", 0 };
	said[0] = 0;
	assert_true(run_program(&(struct run){ pwd, 0, scratch_path("log"), collect, said, 0, "/usr" }, &err));
	assert_string_equal(said, "/usr|");
}

static void test_ends(void **state)
{
	(void)state;
	static const struct {
		const char *script, *says;
	} cases[] = {
		{ "echo fine; echo 'ERROR: no pictures' ; echo then; exit 3", "failed: ERROR: no pictures" },
		{ "echo '  => Filtered: 0'; echo 'ERROR: no model'; echo 'Error: trace'; exit 1", "failed: ERROR: no model" },
		{ "echo '=> Filtered: 0'; echo '  => No good pair'; exit 1", "=> No good pair" },
		{ "exit 1", "it does not say why" },
		{ "kill -9 $$", "was killed" },
		{ "kill -11 $$", "signal 11" },
		{ "echo 'write: No space left on device'; exit 1", "the disk is full" },
		// A program that only mutters about a full disk and goes on has not done its work.
		{ "echo 'SQLite error: database or disk is full'", "the disk is full" },
	};
	char said[4096];
	for (int i = 0; i < COUNT(cases); i++) {
		struct err err = { 0 };
		assert_false(run_sh(cases[i].script, said, &err));
		ERR_HAS(err, cases[i].says);
		assert_null(strchr(err.msg, '\n'));
	}
}

static void test_not_installed(void **state)
{
	(void)state;
	const char *const argv[] = { "no-such-program-anywhere", 0 };
	struct err err = { 0 };
	assert_false(run_program(&(struct run){ .argv = argv, .log = scratch_path("log"), .install = "apt-get install it" }, &err));
	ERR_HAS(err, "no-such-program-anywhere is not installed: apt-get install it");
	assert_false(run_exists("no-such-program-anywhere"));
	assert_true(run_exists("sh"));
}

/* Several at a time: all that could be started end; one bad one is an error. */
static void test_many(void **state)
{
	(void)state;
	char said[5][4096];
	const char *argv[5][4];
	struct run runs[5];
	for (int i = 0; i < 5; i++) {
		const char *script = i == 3 ? "echo 'ERROR: three'; exit 1" : "echo ok";
		memcpy(argv[i], ((const char *[]){ "sh", "-c", script, 0 }), sizeof argv[i]);
		said[i][0] = 0;
		runs[i] = (struct run){ argv[i], 0, scratch_path("log"), collect, said[i], 0, 0 };
	}
	struct err err = { 0 };
	assert_false(run_programs(5, runs, 2, &err));
	ERR_HAS(err, "ERROR: three");
	for (int i = 0; i < 3; i++)
		assert_string_equal(said[i], "ok|");
	err.msg[0] = 0;
	assert_true(run_programs(3, runs, 8, &err));
}

/* More output than a pipe holds, on one line longer than any that is kept. */
static void test_floods(void **state)
{
	(void)state;
	char *said = mem_new(1 << 20, 1);
	struct err err = { 0 };
	assert_true(run_sh("head -c 300000 /dev/zero | tr '\\0' x; echo; echo end", said, &err));
	assert_int_equal(strlen(said), 400 + 1 + 4);
	free(said);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_says), cmocka_unit_test(test_ends),   cmocka_unit_test(test_not_installed),
		cmocka_unit_test(test_many), cmocka_unit_test(test_floods),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
