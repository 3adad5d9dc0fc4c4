/* call: the command line of a program, and the configuration files it names. */
#ifndef BASE_CALL_H
#define BASE_CALL_H
#include "base/opt.h"

struct call {
	const char *capture, *config_dir;  // folders, borrowed from argv; config_dir: null where not given
	const char *only;                  // the one part to make; null: all; borrowed
	int threads;                       // 0: all
	bool quiet, force, print_config;
};

/* Parses a program's command line.
 * name, about   of the program, for --help and messages
 * opts[n_opts]  its options; values given as --key=VALUE are appended to conf's command-line layer
 * --help and --version print and exit 0; an unknown option or a superfluous word exits 2. */
void call_parse(struct call *call, const char *name, const char *about, int argc, char **argv, int n_opts,
                const struct opt opts[], struct conf *conf);

/* Loads config/capture.conf, config/NAME.conf and the capture folder's capture.conf into conf, and the settings that plan chose
 * (front_use.h). Returns false, err set, when a file cannot be read or a key belongs to no stage. */
bool call_load(const struct call *call, const char *name, struct conf *conf, struct err *err);

/* Path of the folder of default configuration: ../config beside the program. free(). */
char *call_config_dir(void);

/* Path of a file in it. free(). */
char *call_config_file(const char *name);

/* Path of this program's executable. free(). */
char *call_program_path(void);

#endif
