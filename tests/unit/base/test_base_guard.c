/* guard: what a process behind it can no longer do, tried by a child of the test's own. */
#include "tests/lib/unit.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <netinet/in.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/guard.h"
#include "tests/lib/scratch.h"

/* Runs `attempt` behind the guard; returns the errno it came back with, 0 where it succeeded. */
static int behind(int (*attempt)(void))
{
	const pid_t child = fork();
	if (!child) {
		guard_enter(scratch_path("cap/work"), scratch_path("cap"), false);
		errno = 0;
		_exit(attempt() < 0 ? errno : 0);
	}
	int status = 0;
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_true(WIFEXITED(status));
	return WEXITSTATUS(status);
}

static int make(const char *rel)
{
	return open(scratch_path("%s", rel), O_WRONLY | O_CREAT, 0666);
}
static int inside(void) { return make("cap/work/new") < 0 || mkdir(scratch_path("cap/work/dir"), 0777) || rename(scratch_path("cap/work/new"), scratch_path("cap/work/dir/new")) ? -1 : 0; }
static int beside(void) { return make("cap/new"); }
static int over(void) { return open(scratch_path("victim/mine"), O_WRONLY); }
static int cut(void) { return truncate(scratch_path("victim/mine"), 0); }
static int away(void) { return unlink(scratch_path("victim/mine")); }
static int through_link(void) { return make("cap/work/link/new"); }
static int whole_file(void)
{
	struct err err = { 0 };
	return file_write(scratch_path("cap/work/link/mine"), "x", 1, &err) ? 0 : (errno = EACCES, -1);
}
static int reads(void) { return open(scratch_path("victim/mine"), O_RDONLY); }
static int reads_link(void) { return open(scratch_path("cap/work/link/mine"), O_RDONLY); }
static int lists(void) { return open(scratch_path("victim"), O_RDONLY | O_DIRECTORY); }
static int reads_own(void) { return open(scratch_path("cap/photo"), O_RDONLY); }
static int reads_made(void) { return open(scratch_path("cap/work/old"), O_RDONLY); }
static int reads_library(void) { return open("/etc/passwd", O_RDONLY) < 0 ? -1 : open("/proc/self/status", O_RDONLY); }
static int nothing(void) { return open("/dev/null", O_WRONLY); }
static int net(void) { return socket(AF_INET, SOCK_STREAM, 0); }
static int net6(void) { return socket(AF_INET6, SOCK_DGRAM, 0); }
static int local(void) { return socket(AF_UNIX, SOCK_STREAM, 0); }
static int start(void) { return execl("/bin/true", "true", (char *)0); }
static int memory(void) { return mmap(0, (size_t)1 << 46, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0) == MAP_FAILED ? -1 : 0; }
static int files(void)
{
	for (int i = 0; i < 5000; i++)
		if (open("/dev/null", O_RDONLY) < 0)
			return -1;
	return 0;
}

static void written_below_work_alone(void **state)
{
	(void)state;
	scratch_text("victim/mine", "mine");
	scratch_text("cap/work/old", "");
	assert_int_equal(symlink(scratch_path("victim"), scratch_path("cap/work/link")), 0);
	if (syscall(SYS_landlock_create_ruleset, 0, 0, LANDLOCK_CREATE_RULESET_VERSION) < 3)
		skip();
	assert_int_equal(behind(inside), 0);
	assert_int_equal(behind(beside), EACCES);
	assert_int_equal(behind(over), EACCES);
	assert_int_equal(behind(cut), EACCES);
	assert_int_equal(behind(away), EACCES);
	assert_int_equal(behind(through_link), EACCES);
	assert_int_equal(behind(whole_file), EACCES);
	assert_int_equal(behind(nothing), 0);
}

static void read_in_the_capture_alone(void **state)
{
	(void)state;
	scratch_text("victim/mine", "mine");
	scratch_text("cap/photo", "");
	scratch_text("cap/work/old", "");
	assert_int_equal(symlink(scratch_path("victim"), scratch_path("cap/work/link")), 0);
	if (syscall(SYS_landlock_create_ruleset, 0, 0, LANDLOCK_CREATE_RULESET_VERSION) < 2)
		skip();
	assert_int_equal(behind(reads_own), 0);
	assert_int_equal(behind(reads_made), 0);
	assert_int_equal(behind(reads_library), 0);
	assert_int_equal(behind(reads), EACCES);
	assert_int_equal(behind(reads_link), EACCES);
	assert_int_equal(behind(lists), EACCES);
}

static void no_network_and_no_program(void **state)
{
	(void)state;
	scratch_text("cap/work/old", "");
	assert_int_equal(behind(net), EPERM);
	assert_int_equal(behind(net6), EPERM);
	assert_int_equal(behind(local), 0);
	assert_int_equal(behind(start), EPERM);
}

static void limits(void **state)
{
	(void)state;
	scratch_text("cap/work/old", "");
	assert_int_equal(behind(files), EMFILE);
#ifndef __SANITIZE_ADDRESS__
	assert_int_equal(behind(memory), ENOMEM);
#else
	(void)memory;
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = { SCRATCH_TEST(written_below_work_alone), SCRATCH_TEST(read_in_the_capture_alone), SCRATCH_TEST(no_network_and_no_program), SCRATCH_TEST(limits) };
	return cmocka_run_group_tests(tests, 0, 0);
}
