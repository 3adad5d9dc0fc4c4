#include "base/call.h"

#include <argp.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/front_use.h"
#include "base/mem.h"
#include "base/say.h"
#include "base/version.h"
#include "base/work.h"

enum { KEY_CAPTURE = 1, KEY_CONFIG_DIR, KEY_PRINT, KEY_QUIET, KEY_FORCE, KEY_THREADS, KEY_ONLY, KEY_HELP, KEY_VERSION, KEY_OPT = 1000 };

struct parsing {
	struct call *call;
	const char *name, *about;
	int n_opts;
	const struct opt *opts;
	struct conf *conf;
	bool help;
};

char *call_program_path(void)
{
	char path[PATH_MAX + 1];
	ssize_t n = readlink("/proc/self/exe", path, PATH_MAX);
	path[n > 0 ? n : 0] = 0;
	return mem_str(path);
}

char *call_config_dir(void)
{
	char *program = call_program_path(), *slash = strrchr(program, '/');
	if (slash)
		*slash = 0;
	char *dir = mem_printf("%s/../config", program);
	free(program);
	return dir;
}

char *call_config_file(const char *name)
{
	char *dir = call_config_dir(), *path = mem_printf("%s/%s", dir, name);
	free(dir);
	return path;
}

/* The version, and the commit that stands beside the programs: not in them, so that a commit alone runs no stage again. */
static void print_version(const char *name)
{
	char *program = call_program_path(), *slash = strrchr(program, '/'), *text = 0;
	char *path = mem_printf("%.*s/version", slash ? (int)(slash - program) : 0, program);
	struct err none = { 0 };
	size_t size;
	if (file_read(&text, &size, path, 200, &none) && *text)
		printf("%s (Eyewright) %s, %.*s\n", name, EYEWRIGHT_VERSION, (int)strcspn(text, "\n"), text);
	else
		printf("%s (Eyewright) %s\n", name, EYEWRIGHT_VERSION);
	free(text);
	free(path);
	free(program);
}

static error_t take(int key, char *arg, struct argp_state *state)
{
	struct parsing *p = state->input;
	switch (key) {
	case KEY_CAPTURE:
		p->call->capture = arg;
		return 0;
	case KEY_CONFIG_DIR:
		p->call->config_dir = arg;
		return 0;
	case KEY_PRINT:
		p->call->print_config = true;
		return 0;
	case KEY_QUIET:
		p->call->quiet = true;
		return 0;
	case KEY_ONLY:
		if (strcmp(p->name, "render") || strcmp(arg, "export"))
			argp_failure(state, 2, 0, "--only = %s: must be export, and the program render", arg);
		p->call->only = arg;
		return 0;
	case KEY_FORCE:
		p->call->force = true;
		return 0;
	case KEY_HELP:
		p->help = true;
		return 0;
	case KEY_VERSION:
		print_version(p->name);
		exit(0);
	case KEY_THREADS: {
		char *end;
		long n = strtol(arg, &end, 10);
		if (end == arg || *end || n < 1 || n > 1024)
			argp_failure(state, 2, 0, "--threads = %s: must be a whole number in [1, 1024]", arg);
		p->call->threads = (int)n;
		return 0;
	}
	case ARGP_KEY_ARG:
		argp_failure(state, 2, 0, "%s: not an option; the capture folder is --capture=DIR", arg);
		return EINVAL;
	default:
		if (key < KEY_OPT || key >= KEY_OPT + p->n_opts)
			return ARGP_ERR_UNKNOWN;
		char *full = opt_full_key(p->name, p->opts[key - KEY_OPT].key);
		conf_add(p->conf, full, arg);
		free(full);
		return 0;
	}
}

static void print_help(const struct parsing *p)
{
	struct err err = { 0 };
	printf("%s: %s\n\nUsage: %s --capture=DIR [OPTION ...]\n\n"
	       "  --capture=DIR      the capture folder; . when not given\n"
	       "  --threads=N        at most so many threads; all when not given; results do not depend on it\n"
	       "  --force            remake what is up to date\n"
	       "  --only=PART        this part alone: render makes its export\n"
	       "  --print-config     print this program's slice of the configuration and stop\n"
	       "  --config-dir=DIR   folder of the default configuration\n"
	       "  --quiet            errors and warnings only\n"
	       "  --help, --version\n\n",
	       p->name, p->about, p->name);
	if (!call_load(p->call, p->name, p->conf, &err))
		printf("(configuration: %s)\n", err.msg);
	printf("Every key of the configuration is an option too; values as they are in effect here:\n\n");
	opt_help(stdout, p->name, p->n_opts, p->opts, p->conf);
	printf("\nExit status: 0 done, 1 the data cannot be used, 2 the call is wrong.\n");
}

void call_parse(struct call *call, const char *name, const char *about, int argc, char **argv, int n_opts,
                const struct opt opts[], struct conf *conf)
{
	*call = (struct call){ .capture = "." };
	static const struct argp_option fixed[] = {
		{ "capture", KEY_CAPTURE, "DIR", 0, 0, 0 }, { "config-dir", KEY_CONFIG_DIR, "DIR", 0, 0, 0 },
		{ "print-config", KEY_PRINT, 0, 0, 0, 0 },  { "quiet", KEY_QUIET, 0, 0, 0, 0 },
		{ "force", KEY_FORCE, 0, 0, 0, 0 },         { "threads", KEY_THREADS, "N", 0, 0, 0 },
		{ "only", KEY_ONLY, "PART", 0, 0, 0 },
		{ "help", KEY_HELP, 0, 0, 0, 0 },           { "version", KEY_VERSION, 0, 0, 0, 0 },
	};
	struct argp_option *table = mem_new((size_t)(COUNT(fixed) + 2 * n_opts + 1), sizeof *table);
	char **names = mem_new((size_t)n_opts + 1, sizeof *names);
	int n = 0;
	for (; n < COUNT(fixed); n++)
		table[n] = fixed[n];
	for (int i = 0; i < n_opts; i++) {
		if (opts[i].type == OPT_T_EACH)
			continue;
		table[n++] = (struct argp_option){ opts[i].key, KEY_OPT + i, "VALUE", 0, 0, 0 };
		names[i] = mem_str(opts[i].key);
		for (char *c = names[i]; *c; c++)
			*c = *c == '_' ? '-' : *c;
		if (strcmp(names[i], opts[i].key))
			table[n++] = (struct argp_option){ names[i], KEY_OPT + i, "VALUE", 0, 0, 0 };
	}
	struct parsing p = { call, name, about, n_opts, opts, conf, false };
	struct argp argp = { .options = table, .parser = take };
	argp_err_exit_status = 2;
	argv[0] = (char *)name;
	error_t bad = argp_parse(&argp, argc, argv, ARGP_NO_HELP | ARGP_IN_ORDER, 0, &p);
	free(table);
	for (int i = 0; i < n_opts; i++)
		free(names[i]);
	free(names);
	if (bad)
		exit(2);
	if (p.help) {
		print_help(&p);
		exit(0);
	}
}

/* Checks the keys of capture.conf that are not of this stage: a key that begins with the name of a stage is left to that stage;
 * all others must stand in config/capture.conf. */
static bool check_shared(const struct conf *conf, const char *config_dir, struct err *err)
{
	for (int i = 0; i < conf->n; i++) {
		const struct conf_item *item = &conf->items[i];
		if (item->layer != 1)
			continue;
		bool known = false;
		for (int j = 0; j < conf->n && !known; j++)
			known = !conf->items[j].layer && opt_match(conf->items[j].key, item->key, 0);
		const char *dot = strchr(item->key, '.');
		if (!known && dot) {
			char *file = mem_printf("%s/%.*s.conf", config_dir, (int)(dot - item->key), item->key);
			bool stage = strncmp(item->key, "capture.", 8) && strncmp(item->key, "fronts.", 7) && !strchr(item->key, '/');
			known = stage && file_exists(file);
			free(file);
		}
		if (!known)
			return err_set(err, "%s:%d: %s = %.80s: unknown key", item->file, item->line, item->key, item->value);
	}
	return true;
}

/* quality names the presets of config/STAGE.conf (key.draft ...): another word would choose none of them. */
static bool check_quality(const struct conf *conf, struct err *err)
{
	static const char *const names[] = { "draft", "review", "final" };
	const struct conf_item *item = conf_find(conf, "quality", 0);
	for (int i = 0; i < COUNT(names); i++)
		if (!item || !strcmp(item->value, names[i]))
			return true;
	return err_set(err, "%s:%d: quality = %.80s: must be draft, review or final", item->file, item->line, item->value);
}

bool call_load(const struct call *call, const char *name, struct conf *conf, struct err *err)
{
	char *dir = call->config_dir ? mem_str(call->config_dir) : call_config_dir();
	char *shared = mem_printf("%s/capture.conf", dir), *own = mem_printf("%s/%s.conf", dir, name),
	     *capture = mem_printf("%s/capture.conf", call->capture), *prefix = mem_printf("%s.", name);
	bool ok = work_check_inputs(call->capture, err) && conf_load(conf, shared, "", 0, err) && conf_load(conf, own, prefix, 0, err)
	          && conf_load(conf, capture, "", 1, err) && check_shared(conf, dir, err) && check_quality(conf, err)
	          && front_apply(conf, name, call->capture, dir, err);
	free(dir);
	free(shared);
	free(own);
	free(capture);
	free(prefix);
	return ok;
}
