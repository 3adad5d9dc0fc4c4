/* opt: one table per program. The same rows drive the command line, the configuration files, --help,
 * --print-config and the range checks.
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

enum { OPT_EACH_MAX = 4 };

/* What a pattern key such as `photo.*.hint_px` found. */
struct opt_each {
	char *name;  // what stood for the star
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

/* The full key of an option of that stage: "limbus.edge_sigma", "camera.focal_px". free(). */
char *opt_full_key(const char *stage, const char *key);

/* Fills every out pointer from conf. False, err set (file, line, key, value, rule), for a value that cannot
 * be read or is out of range, a key without a default, or a key of this stage that the table does not know. */
bool opt_resolve(const char *stage, int n, const struct opt opts[], const struct conf *conf, struct err *err);

/* Key and effective value of every row, pattern keys expanded, one "key = value" a line, sorted by key: the
 * stage's slice of the configuration. */
void opt_print(FILE *out, const char *stage, int n, const struct opt opts[], const struct conf *conf);

/* --help's table: key, effective value, unit, range, help. */
void opt_help(FILE *out, const char *stage, int n, const struct opt opts[], const struct conf *conf);

/* True when full key `key` matches `pattern` with at most one star; *name gets what the star stood for
 * (free()), or null. name may be null. */
bool opt_match(const char *pattern, const char *key, char **name);

void opt_free(int n, const struct opt opts[]);

#endif
