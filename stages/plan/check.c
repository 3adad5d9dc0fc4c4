#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "plan.h"

extern char **environ;

#define CHECKED "work/.made/checked"

struct child {
	pid_t pid;
	int out;  // what it says, in memory
};

/* Starts STAGE --print-config, which reads and checks the configuration; its error goes into a file in memory. */
static bool start(struct child *child, const char *stage, const char *capture)
{
	char *program = plan_stage_program(stage), *arg = mem_printf("--capture=%s", capture);
	char *argv[] = { program, arg, "--print-config", 0 };
	posix_spawn_file_actions_t files;
	child->out = memfd_create("check", MFD_CLOEXEC);
	posix_spawn_file_actions_init(&files);
	posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
	posix_spawn_file_actions_adddup2(&files, child->out, STDERR_FILENO);
	bool ok = child->out >= 0 && !posix_spawn(&child->pid, program, &files, 0, argv, environ);
	posix_spawn_file_actions_destroy(&files);
	free(program);
	free(arg);
	return ok;
}

/* Waits for it. Returns false, err set to its first line, when it failed. */
static bool finish(struct child *child, struct err *err)
{
	int status = 0;
	char said[900] = "";
	waitpid(child->pid, &status, 0);
	ssize_t n = pread(child->out, said, sizeof said - 1, 0);
	close(child->out);
	said[n > 0 ? n : 0] = 0;
	said[strcspn(said, "\n")] = 0;
	if (WIFEXITED(status) && !WEXITSTATUS(status))
		return true;
	return err_set(err, "%s", *said ? said : "a stage cannot read the configuration");
}

/* True when capture.conf has a key that this stage has to check: one of its own, or a shared one. */
static bool concerns(const struct conf *conf, const char *stage)
{
	size_t n = strlen(stage);
	for (int i = 0; i < conf->n; i++) {
		const struct conf_item *item = &conf->items[i];
		bool of_stage = false;
		for (int s = 0; s < PLAN_STAGES; s++) {
			size_t m = strlen(plan_stages[s].name);
			of_stage |= !strncmp(item->key, plan_stages[s].name, m) && item->key[m] == '.';
		}
		bool own = !strncmp(item->key, stage, n) && item->key[n] == '.';
		if (item->layer && (own || !of_stage))
			return true;
	}
	return false;
}

/* Hash of what the result depends on: which stages run, and the configuration. Not the programs, which check again when they run. */
static void hash_of(char out[33], const struct plan *plan, const struct conf *conf)
{
	char *text = mem_str("");
	for (int i = 0; i < PLAN_STAGES + conf->n; i++) {
		char *more = i < PLAN_STAGES ? mem_printf("%s%s %d\n", text, plan->rows[i].name, plan->rows[i].run)
		                             : mem_printf("%s%s = %s\n", text, conf->items[i - PLAN_STAGES].key,
		                                          conf->items[i - PLAN_STAGES].value);
		free(text);
		text = more;
	}
	file_hash_bytes(out, text, strlen(text));
	free(text);
}

bool plan_check_conf(const struct plan *plan, const struct conf *conf, struct err *err)
{
	char hash[33], *path = mem_printf("%s/" CHECKED, plan->capture), *was = 0;
	size_t size;
	struct err none = { 0 };
	struct child children[PLAN_STAGES] = { 0 };
	hash_of(hash, plan, conf);
	bool checked = file_read(&was, &size, path, 64, &none) && !strcmp(was, hash);
	for (int i = 1; i < PLAN_STAGES && !checked; i++)
		if (plan->rows[i].run && concerns(conf, plan->rows[i].name))
			start(&children[i], plan->rows[i].name, plan->capture);
	for (int i = 1; i < PLAN_STAGES; i++)
		if (children[i].pid > 0)
			finish(&children[i], err);
	if (!checked && !err_is(err))
		file_write(path, hash, strlen(hash), err);
	free(was);
	free(path);
	return !err_is(err);
}
