/* stress: seeded runs over hostile cases, one family of cases after the other. Each family ends in one line: how many, how
 * many were flagged (refused, or said to be uncertain), how many wrong, and its worst case with the digits lost there and
 * the command that runs that case alone and prints it; where all were flagged and nothing was measured, the first of them.
 *
 *     struct stress s;
 *     stress_start(&s, "pca", argc, argv);
 *     for (stress_family(&s, "constant columns", 200); stress_case(&s);)
 *             ... s.rng ... stress_lost(&s, error), stress_wrong(&s, "why") ...
 *     return stress_end(&s);
 *
 * Calls: [--share=X] (of the usual number of cases) [--seed=N] [--family=N [--case=N]].
 */
#ifndef TESTS_LIB_STRESS_H
#define TESTS_LIB_STRESS_H
#include <stdbool.h>
#include <stdint.h>

#include "math/rng.h"

struct stress {
	const char *program, *name;
	char family[200];
	double share;
	uint64_t seed;
	long family_index, cases, index, only_family, only_case;
	struct rng rng;            // of this case alone
	long flagged, wrong, wrong_all, run_all;
	long worst_case, first_wrong, first_flagged;
	double worst;              // the family's measure
	const char *measure;       // null: digits lost
	bool case_flagged, case_wrong, show;
	char why[300];             // of the first wrong case
	char about[300], worst_about[300], flagged_about[300];
};

void stress_start(struct stress *s, const char *name, int argc, char **argv);

/* Begins a family of so many cases; ends the one before. */
void stress_family(struct stress *s, const char *family, long cases);

/* The next case of the family, or false. */
bool stress_case(struct stress *s);

/* What the case is, for the worst case's line. */
__attribute__((format(printf, 2, 3)))
void stress_about(struct stress *s, const char *fmt, ...);

/* Relative error of a result: digits lost of the sixteen. NAN is wrong. */
void stress_lost(struct stress *s, double error);

/* The same of numbers that hold fewer: digit is their epsilon. */
void stress_lost_of(struct stress *s, double error, double digit);

/* Another measure than digits, of which the largest is the worst: "times the bound". */
void stress_measure(struct stress *s, double value, const char *unit);

void stress_flagged(struct stress *s);

__attribute__((format(printf, 2, 3)))
void stress_wrong(struct stress *s, const char *fmt, ...);

/* Exit status: 1 when a case was wrong, or none was run. */
int stress_end(struct stress *s);

#endif
