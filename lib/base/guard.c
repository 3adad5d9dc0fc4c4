#include "base/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <omp.h>
#include <seccomp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/mem.h"

// Sanitizers look into their own process and take terabytes of addresses for their tables.
#ifndef __has_feature  // clang's word for it
#define __has_feature(x) 0
#endif
#define WATCHED __has_feature(thread_sanitizer)  // its symbolizer is a program of its own
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__ || __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
enum { SANITISED = 1 };
#else
enum { SANITISED = 0 };
#endif

static void limit(int what, rlim_t most)
{
	struct rlimit now;
	if (!getrlimit(what, &now) && (now.rlim_cur == RLIM_INFINITY || now.rlim_cur > most)) {
		now.rlim_cur = now.rlim_max != RLIM_INFINITY && now.rlim_max < most ? now.rlim_max : most;
		setrlimit(what, &now);
	}
}

static void limit_all(void)
{
	const rlim_t memory = (rlim_t)sysconf(_SC_PHYS_PAGES) * (rlim_t)sysconf(_SC_PAGESIZE);
	if (!SANITISED)
		limit(RLIMIT_AS, 2 * memory + ((rlim_t)16 << 30));
	limit(RLIMIT_CPU, (rlim_t)86400 * (rlim_t)omp_get_num_procs());
	limit(RLIMIT_NOFILE, 1024);
}

/* Lets the ruleset allow `rights` below a folder, or for a file. */
static void allow(int ruleset, const char *path, uint64_t rights)
{
	struct landlock_path_beneath_attr below = { .allowed_access = rights, .parent_fd = open(path, O_PATH | O_CLOEXEC) };
	if (below.parent_fd < 0)
		return;
	syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &below, 0);
	close(below.parent_fd);
}

/* Lets files be read below each folder of a list like PATH; above: below the folder that it stands in, too, but for a user's own. */
static void allow_list(int ruleset, const char *list, bool above, uint64_t rights)
{
	const char *home = getenv("HOME");
	for (const char *at = list; at && *at; at += *at == ':') {
		const size_t n = strcspn(at, ":");
		char *dir = mem_printf("%.*s", (int)n, at), *over = mem_printf("%s/..", dir), *real = n && above ? realpath(over, 0) : 0;
		allow(ruleset, dir, rights);
		if (real && strcmp(real, "/") && (!home || strcmp(real, home)))
			allow(ruleset, real, rights);
		free(real);
		free(over);
		free(dir);
		at += n;
	}
}

/* What a stage reads: the capture, where WORK= has it elsewhere its source, the programs' folder and its configuration, and what libraries
 * look up. Other programs stand where PATH says, their libraries beside them. */
static void allow_reading(int ruleset, const char *capture, bool starts_programs)
{
	static const char *const system[] = { "/usr", "/lib", "/lib32", "/lib64", "/opt", "/nix", "/gnu", "/etc", "/proc", "/sys", "/dev" };
	const uint64_t rights = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
	const char *source = getenv("EYEWRIGHT_SOURCE");
	char *program = realpath("/proc/self/exe", 0), *slash = program ? strrchr(program, '/') : 0;
	if (slash)
		*slash = 0;
	char *config = mem_printf("%s/../config", program ? program : ".");
	for (int i = 0; i < COUNT(system); i++)
		allow(ruleset, system[i], rights);
	allow(ruleset, capture, rights);
	allow(ruleset, config, rights);
	if (program)
		allow(ruleset, program, rights);
	if (source && *source)
		allow(ruleset, source, rights);
	allow_list(ruleset, getenv("LD_LIBRARY_PATH"), false, rights);
	if (starts_programs)
		allow_list(ruleset, getenv("PATH"), true, rights);
	free(config);
	free(program);
}

static void keep_below(const char *work, const char *capture, bool starts_programs)
{
	// Of the kernel's headers of Linux 5.13 only the first rights are known; the others by their numbers.
	enum { REFER = 1 << 13, TRUNCATE = 1 << 14 };
	uint64_t rights = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE
	                  | LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG
	                  | LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK
	                  | LANDLOCK_ACCESS_FS_MAKE_SYM | REFER;
	const long abi = syscall(SYS_landlock_create_ruleset, 0, 0, LANDLOCK_CREATE_RULESET_VERSION);
	if (abi < 2)  // the first forbids each rename into another folder
		return;
	rights |= abi >= 3 ? TRUNCATE : 0;
	rights |= capture ? LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR : 0;
	const struct landlock_ruleset_attr attr = { .handled_access_fs = rights };
	const int ruleset = (int)syscall(SYS_landlock_create_ruleset, &attr, sizeof attr.handled_access_fs, 0);
	if (ruleset < 0)
		return;
	const char *tmp = getenv("TMPDIR");
	tmp = tmp && *tmp ? tmp : "/tmp";
	allow(ruleset, work, rights);
	if (capture)
		allow_reading(ruleset, capture, starts_programs);
	allow(ruleset, "/dev/null", LANDLOCK_ACCESS_FS_WRITE_FILE | (rights & TRUNCATE));
	if (starts_programs) {
		allow(ruleset, tmp, rights);
		setenv("SQLITE_TMPDIR", tmp, 0);  // SQLite prefers /var/tmp, COLMAP's as well as ours
	}
	if (!prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0))
		syscall(SYS_landlock_restrict_self, ruleset, 0);
	close(ruleset);
}

static void forbid_calls(bool starts_programs)
{
	static const int calls[] = {
		SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev), SCMP_SYS(mount), SCMP_SYS(umount2), SCMP_SYS(pivot_root),
		SCMP_SYS(chroot), SCMP_SYS(setns), SCMP_SYS(unshare), SCMP_SYS(bpf), SCMP_SYS(keyctl), SCMP_SYS(add_key), SCMP_SYS(request_key),
		SCMP_SYS(init_module), SCMP_SYS(finit_module), SCMP_SYS(kexec_load), SCMP_SYS(swapon), SCMP_SYS(reboot), SCMP_SYS(acct),
		SCMP_SYS(io_uring_setup), SCMP_SYS(userfaultfd), SCMP_SYS(perf_event_open),
	};
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
	if (!filter)
		return;
	seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);  // threads that libraries have begun, too
	for (int i = 0; i < COUNT(calls); i++)
		seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), calls[i], 0);
	const struct scmp_arg_cmp elsewhere = { .arg = 0, .op = SCMP_CMP_NE, .datum_a = AF_UNIX };
	seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(socket), 1, &elsewhere);
	if (!SANITISED)
		seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(ptrace), 0);
	if (!starts_programs && !WATCHED) {
		seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(execve), 0);
		seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(execveat), 0);
	}
	seccomp_load(filter);
	seccomp_release(filter);
}

void guard_enter(const char *work, const char *capture, bool starts_programs)
{
	limit_all();
	keep_below(work, capture, starts_programs);
	forbid_calls(starts_programs);
}

/* Landlock: nothing is opened but for reading, below `reads`. */
static void read_below(const char *reads)
{
	enum { REFER = 1 << 13 };
	const long abi = syscall(SYS_landlock_create_ruleset, 0, 0, LANDLOCK_CREATE_RULESET_VERSION);
	if (abi < 1)
		return;
	const struct landlock_ruleset_attr attr = { .handled_access_fs = LANDLOCK_ACCESS_FS_MAKE_SYM * 2 - 1 };
	const int ruleset = (int)syscall(SYS_landlock_create_ruleset, &attr, sizeof attr.handled_access_fs, 0);
	if (ruleset < 0)
		return;
	if (reads)
		allow(ruleset, reads, LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR);
	if (!prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0))
		syscall(SYS_landlock_restrict_self, ruleset, 0);
	close(ruleset);
}

static void forbid_more(void)
{
	static const int calls[] = {
		SCMP_SYS(socket), SCMP_SYS(connect), SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(fork), SCMP_SYS(vfork), SCMP_SYS(clone),
		SCMP_SYS(clone3), SCMP_SYS(kill), SCMP_SYS(unlink), SCMP_SYS(unlinkat), SCMP_SYS(rename), SCMP_SYS(renameat),
		SCMP_SYS(renameat2), SCMP_SYS(mkdir), SCMP_SYS(mkdirat), SCMP_SYS(link), SCMP_SYS(linkat), SCMP_SYS(symlink), SCMP_SYS(symlinkat),
		SCMP_SYS(chmod), SCMP_SYS(fchmodat), SCMP_SYS(truncate), SCMP_SYS(creat), SCMP_SYS(open_by_handle_at), SCMP_SYS(memfd_create),
	};
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
	if (!filter)
		return;
	for (int i = 0; i < COUNT(calls); i++)
		// A sanitizer looks for its leaks from another thread.
		if (!(SANITISED && (calls[i] == SCMP_SYS(clone) || calls[i] == SCMP_SYS(clone3))))
			seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), calls[i], 0);
	const struct scmp_arg_cmp writes = { .arg = 2, .op = SCMP_CMP_MASKED_EQ, .datum_a = O_WRONLY, .datum_b = O_WRONLY };
	const struct scmp_arg_cmp both = { .arg = 2, .op = SCMP_CMP_MASKED_EQ, .datum_a = O_RDWR, .datum_b = O_RDWR };
	seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(openat), 1, &writes);
	seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(openat), 1, &both);
	seccomp_load(filter);
	seccomp_release(filter);
}

void guard_apart(const struct guard_apart *limits)
{
	if (!SANITISED)
		limit(RLIMIT_AS, limits->addresses);
	limit(RLIMIT_CPU, (rlim_t)limits->seconds);
	limit(RLIMIT_FSIZE, limits->written);
	limit(RLIMIT_CORE, 0);
	read_below(limits->reads);
	forbid_more();
}
