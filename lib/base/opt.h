/* opt: the table of a program's options. Its rows serve the command line, the configuration files, --help, --print-config and the
 * range checks.
 *
 * A key without a dot belongs to the stage: "edge_sigma" is `limbus.edge_sigma` in capture.conf,
 * `edge_sigma` in config/limbus.conf and --edge-sigma on the command line. A key with a dot, and `quality`, is shared by
 * all stages: `camera.focal_px` in capture.conf, its default in config/capture.conf, --camera.focal-px on
 * the command line. Defaults live in those files alone.
 */
#ifndef BASE_OPT_H
#define BASE_OPT_H
#include <stdio.h>

#include "base/conf.h"

enum opt_type { OPT_T_REAL, OPT_T_INT, OPT_T_BOOL, OPT_T_CHOICE, OPT_T_REALS, OPT_T_STR, OPT_T_EACH };

enum { OPT_EACH_MAX = 5 };

/* One match of a pattern key such as `photo.*.hint_px`. */
struct opt_each {
	char *name;  // what the star matched; owned
	double value[OPT_EACH_MAX];
	const char *text;  // the value as written; owned by the conf
};
struct opt_each_list {
	struct opt_each *items;
	int n;
};

struct opt {
	const char *key;
	enum opt_type type;
	bool may_unset;  // an empty value is allowed: NAN, or null for a string
	int count;       // numbers in a REALS or EACH value; 0 in an EACH: text
	double min, max;
	const char *unit, *help;
	const char *const *choices;  // null-terminated
	union {
		double *real;
		int *integer;
		bool *boolean;
		const char **str;
		struct opt_each_list *each;
	} out;
};

#define OPT_REAL(key, ptr, lo, hi, unit, help) { key, OPT_T_REAL, false, 1, lo, hi, unit, help, 0, { .real = ptr } }
#define OPT_INT(key, ptr, lo, hi, unit, help) { key, OPT_T_INT, false, 1, lo, hi, unit, help, 0, { .integer = ptr } }
#define OPT_BOOL(key, ptr, help) { key, OPT_T_BOOL, false, 1, 0, 1, "", help, 0, { .boolean = ptr } }
/* *ptr is the index into the null-terminated array of names. */
#define OPT_CHOICE(key, ptr, names, help) { key, OPT_T_CHOICE, false, 1, 0, 0, "", help, names, { .integer = ptr } }
#define OPT_STR(key, ptr, help) { key, OPT_T_STR, true, 1, 0, 0, "", help, 0, { .str = ptr } }
#define OPT_REALS(key, ptr, n, lo, hi, unit, help) { key, OPT_T_REALS, false, n, lo, hi, unit, help, 0, { .real = ptr } }
/* May be left empty; all NAN then. */
#define OPT_REAL_UNSET(key, ptr, lo, hi, unit, help) { key, OPT_T_REAL, true, 1, lo, hi, unit, help, 0, { .real = ptr } }
#define OPT_REALS_UNSET(key, ptr, n, lo, hi, unit, help) { key, OPT_T_REALS, true, n, lo, hi, unit, help, 0, { .real = ptr } }
/* Key with one star: one entry for each name found; n = 0 reads text. */
#define OPT_EACH(key, ptr, n, lo, hi, unit, help) { key, OPT_T_EACH, true, n, lo, hi, unit, help, 0, { .each = ptr } }

/* The full key of an option of that stage ("limbus.edge_sigma", "camera.focal_px"); free(). */
char *opt_full_key(const char *stage, const char *key);

/* Fills every out pointer of the table from conf; strings stay conf's. Returns false, err set (file, line, key, value, rule), for a
 * value that cannot be read or is out of range, a key without a default, or a key of this stage that is not in the table.
 * opt_free in any case. */
bool opt_resolve(const char *stage, int n, const struct opt opts[], const struct conf *conf, struct err *err);

/* Prints the stage's slice of the configuration: key and effective value of every row, pattern keys expanded, one "key = value" a
 * line, sorted by key. */
void opt_print(FILE *out, const char *stage, int n, const struct opt opts[], const struct conf *conf);

/* Prints the table of --help: key, effective value, range, unit, help. */
void opt_help(FILE *out, const char *stage, int n, const struct opt opts[], const struct conf *conf);

/* Whether the full key `key` matches `pattern`, which has at most one star. name: null, or set to what the star matched (free()),
 * null without a match. */
bool opt_match(const char *pattern, const char *key, char **name);

/* Frees the lists of the table's pattern keys. */
void opt_free(int n, const struct opt opts[]);

#endif
