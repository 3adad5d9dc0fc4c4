/* call: the command line of a program, and the configuration files it names. */
#ifndef BASE_CALL_H
#define BASE_CALL_H
#include "base/opt.h"

struct call {
	const char *capture, *config_dir;
	int threads;
	bool quiet, force, print_config;
};

/* --help and --version print and exit 0; an unknown option or a word too many exits 2. Options of the table
 * go into conf's command-line layer. */
void call_parse(struct call *call, const char *name, const char *about, int argc, char **argv, int n_opts,
                const struct opt opts[], struct conf *conf);

/* Loads config/capture.conf, config/NAME.conf and the folder's capture.conf; refuses keys that no stage knows. */
bool call_load(const struct call *call, const char *name, struct conf *conf, struct err *err);

/* The folder of default configuration: ../config beside the program, unless told otherwise. free(). */
char *call_config_dir(void);

/* This program's own file. free(). */
char *call_program_path(void);

#endif
