/* The way out: nothing below the gate's folder is written, removed or renamed through a link, whenever it was put there. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/gate.h"
#include "base/gate_walk.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static char work[500], victim[500];

/* A folder to write in, and one outside that holds a secret under the names used inside. */
static void begin(void)
{
	struct err err = { 0 };
	scratch_open();
	snprintf(work, sizeof work, "%s", scratch_path("work"));
	snprintf(victim, sizeof victim, "%s", scratch_path("victim"));
	assert_true(file_mkdirs(work, &err) && file_write(scratch_path("victim/a.json"), "mine", 4, &err));
	assert_true(gate_set(work, &err));
}

static void holds(const char *path, const char *text)
{
	struct err err = { 0 };
	char *data;
	size_t size;
	assert_true(file_read(&data, &size, path, 100, &err));
	assert_string_equal(data, text);
	free(data);
}

static void writes_below(void **state)
{
	(void)state;
	struct err err = { 0 };
	begin();
	assert_true(file_write(scratch_path("work/a/b/c.json"), "one", 3, &err));
	assert_true(file_write(scratch_path("work//a/./b/c.json"), "two", 3, &err));
	holds(scratch_path("work/a/b/c.json"), "two");
	assert_true(gate_rename(scratch_path("work/a/b/c.json"), scratch_path("work/a/b/d.json")));
	holds(scratch_path("work/a/b/d.json"), "two");
	assert_true(file_remove(scratch_path("work/a/b/d.json"), &err) && file_remove(scratch_path("work/none/d.json"), &err));
	assert_false(file_exists(scratch_path("work/a/b/d.json")) || file_exists(scratch_path("work/none")));
	// Beside it, paths are as ever.
	assert_true(file_write(scratch_path("else/where.json"), "x", 1, &err));
	assert_true(file_write(scratch_path("workshop/a.json"), "x", 1, &err));
	scratch_close();
}

/* One attempt to get out at `path`: refused, the victim as it was. */
static void stays_in(const char *path)
{
	struct err err = { 0 };
	assert_false(file_write(path, "theirs", 6, &err));
	ERR_HAS(err, "cannot write");
	err = (struct err){ 0 };
	assert_false(file_remove(path, &err));
	assert_true(gate_create(path, O_WRONLY | O_TRUNC) < 0);
	holds(scratch_path("victim/a.json"), "mine");
	assert_false(file_exists(scratch_path("victim/deep")));
}

static void no_link_is_followed(void **state)
{
	(void)state;
	struct err err = { 0 };
	begin();
	// A folder of ours that somebody exchanges for a link while we run.
	assert_true(file_write(scratch_path("work/limbus/a.json"), "ours", 4, &err));
	assert_int_equal(rename(scratch_path("work/limbus"), scratch_path("work/gone")), 0);
	assert_int_equal(symlink(victim, scratch_path("work/limbus")), 0);
	stays_in(scratch_path("work/limbus/a.json"));
	assert_false(file_write(scratch_path("work/limbus/deep/er/a.json"), "theirs", 6, &err));
	assert_false(file_exists(scratch_path("victim/deep")));
	// In the middle of a path, to a folder inside, by dots, and the last part itself.
	assert_int_equal(symlink("gone", scratch_path("work/inside")), 0);
	err = (struct err){ 0 };
	assert_false(file_write(scratch_path("work/inside/a.json"), "theirs", 6, &err));
	holds(scratch_path("work/gone/a.json"), "ours");
	stays_in(scratch_path("work/../victim/a.json"));
	assert_int_equal(symlink(scratch_path("victim/a.json"), scratch_path("work/gone/link.json")), 0);
	assert_true(gate_create(scratch_path("work/gone/link.json"), O_WRONLY | O_TRUNC) < 0 && errno == ELOOP);
	err = (struct err){ 0 };
	assert_true(file_write(scratch_path("work/gone/link.json"), "ours", 4, &err));  // the link is replaced
	holds(scratch_path("victim/a.json"), "mine");
	// work/ itself is exchanged: what was opened is written.
	assert_int_equal(rename(work, scratch_path("moved")), 0);
	assert_int_equal(symlink(victim, work), 0);
	assert_true(file_write(scratch_path("work/a.json"), "ours", 4, &err));
	holds(scratch_path("victim/a.json"), "mine");
	holds(scratch_path("moved/a.json"), "ours");
	assert_int_equal(unlink(work), 0);
	scratch_close();
}

/* What gate_walk comes to, in a string: files before the folders that hold them. */
static bool note(void *ctx, int folder, const char *name, bool is_folder)
{
	struct stat st;
	strcat(strcat(ctx, name), is_folder ? "/" : S_ISLNK(fstatat(folder, name, &st, AT_SYMLINK_NOFOLLOW) ? 0 : st.st_mode) ? "@ " : " ");
	return true;
}

static bool take_away(void *ctx, int folder, const char *name, bool is_folder)
{
	(void)ctx;
	return !unlinkat(folder, name, is_folder ? AT_REMOVEDIR : 0);
}

static void walks_what_is_inside(void **state)
{
	(void)state;
	struct err err = { 0 };
	char seen[200] = "";
	begin();
	assert_true(file_write(scratch_path("work/a/b/one"), "x", 1, &err));
	assert_int_equal(symlink(victim, scratch_path("work/a/b/out")), 0);
	assert_true(gate_walk(work, note, seen));
	assert_true(!strcmp(seen, "one out@ b/a/") || !strcmp(seen, "out@ one b/a/"));
	assert_true(gate_walk(work, take_away, 0) && gate_rmdir(work));
	assert_false(file_exists(work));
	holds(scratch_path("victim/a.json"), "mine");
	// A folder that has become a link is not gone into.
	assert_int_equal(mkdir(work, 0755), 0);
	assert_int_equal(symlink(victim, scratch_path("work/limbus")), 0);
	assert_false(gate_walk(scratch_path("work/limbus"), take_away, 0) || gate_rmdir(scratch_path("work/limbus")));
	holds(scratch_path("victim/a.json"), "mine");
	scratch_close();
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(writes_below), cmocka_unit_test(no_link_is_followed), cmocka_unit_test(walks_what_is_inside) };
	return cmocka_run_group_tests(tests, 0, 0);
}
