/* One stage, its own main, on a whole capture folder in memory. What surrounds it is replaced when it is linked (-Wl,--wrap): it may not
 * exit, is not guarded (the next run has another folder), starts no programs, and its table of options is looked at. Asked for is
 * that it ends, with a status it may end with, and with one clear line where and only where that is not 0.
 * The environment's UNPACK=DIR leaves the folder there instead: the capture, for the program itself. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/err.h"
#include "base/mem.h"
#include "base/run.h"
#include "tests/fuzz/capture/folder.h"
#include "tests/fuzz/capture/keys.h"

int stage_main(int argc, char **argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *argc, char ***argv);

static char dir[256], program[300];
static jmp_buf over;
static bool running;
static pid_t self;
static int said;

_Noreturn void __real_exit(int status);
_Noreturn void __real__exit(int status);
bool __real_opt_resolve(const char *stage, int n, const struct opt opts[], const struct conf *conf, struct err *err);

/* Only where the stage itself wants to end: not a child of it, nor the fuzzer. */
_Noreturn void __wrap_exit(int status)
{
	if (running && getpid() == self)
		longjmp(over, status + 1);
	__real_exit(status);
}

_Noreturn void __wrap__exit(int status)
{
	if (running && getpid() == self) {
		said = said ? said : 1;  // "out of memory" is said past say_error
		longjmp(over, status + 1);
	}
	__real__exit(status);
}

bool __wrap_opt_resolve(const char *stage, int n, const struct opt opts[], const struct conf *conf, struct err *err)
{
	keys_take(stage, n, opts);
	return __real_opt_resolve(stage, n, opts, conf, err);
}

void __wrap_guard_enter(const char *work, const char *capture, bool starts_programs)
{
	(void)work;
	(void)capture;
	(void)starts_programs;
}

/* A small file: its bytes are hashed in each run. */
char *__wrap_call_program_path(void)
{
	return mem_str(program);
}

char *__wrap_plan_stage_program(const char *stage)
{
	(void)stage;
	return mem_str("/bin/true");
}

void __wrap_say_error(const char *who, const char *text)
{
	(void)who;
	said++;
	if (getenv("VERBOSE"))
		fprintf(stderr, "%s: %s\n", who, text);
	if (!*text || strchr(text, '\n'))
		abort();  // refused without a line, or in several
}

bool __wrap_run_exists(const char *name)
{
	(void)name;
	return true;
}

bool __wrap_run_programs(int n, const struct run runs[], int threads, struct err *err)
{
	(void)n;
	(void)threads;
	return err_set(err, "%s: no programs are started here", runs[0].argv[0]);
}

bool __wrap_run_program(const struct run *run, struct err *err)
{
	return __wrap_run_programs(1, run, 1, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct folder f;
	static char name[] = "stage", quiet[] = "--quiet", threads[] = "--threads=1", capture[sizeof dir + 16];
	char *argv[] = { name, capture, quiet, threads, 0 };
	snprintf(capture, sizeof capture, "--capture=%s", dir);
	folder_parse(&f, data, size);
	if (getenv("UNPACK")) {
		folder_unpack(&f, getenv("UNPACK"));
		return 0;
	}
	folder_unpack(&f, dir);
	const int first = open("/dev/null", O_RDONLY | O_CLOEXEC);
	close(first);
	said = 0;
	running = true;
	const int jumped = setjmp(over), status = jumped ? jumped - 1 : stage_main(4, argv);
	running = false;
	close_range((unsigned)first, ~0u, 0);  // locks of a stage that did not come to its end
	if (status < 0 || status > 3 || said != (status == 1 || status == 2))
		abort();  // another exit status, failure without a line, or a line without failure
	folder_empty(dir);
	return 0;
}

static void remove_all(void)
{
	if (getpid() == self) {
		folder_empty(dir);
		rmdir(dir);
		unlink(program);
	}
}

/* One run on an empty folder shows the table of options. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
	(void)argc;
	(void)argv;
	const char *memory = access("/dev/shm", W_OK) ? getenv("TMPDIR") : "/dev/shm";
	snprintf(dir, sizeof dir, "%.200s/eyewright-capture-XXXXXX", memory ? memory : "/tmp");
	self = getpid();
	setenv("OMP_WAIT_POLICY", "passive", 1);
	if (!mkdtemp(dir))
		abort();
	snprintf(program, sizeof program, "%s.program", dir);
	const int fd = open(program, O_WRONLY | O_CREAT, 0755);
	if (fd < 0 || write(fd, "1", 1) != 1)
		abort();
	close(fd);
	atexit(remove_all);
	static const uint8_t empty[] = "@ capture.conf 0\n";
	if (!getenv("UNPACK"))
		LLVMFuzzerTestOneInput(empty, sizeof empty - 1);
	return 0;
}
