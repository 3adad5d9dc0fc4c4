/* fronts: runs a stage at many settings on one capture and measures time and error of each run; finds the Pareto front, the
 * settings that no other beats in both, and whether a preset is beaten. For tests/bench/bench_fronts*.c; `make fronts` makes config/fronts.conf of
 * what they write.
 */
#ifndef TESTS_LIB_FRONTS_H
#define TESTS_LIB_FRONTS_H
#include "base/err.h"

enum { FRONTS_SETTINGS = 12, FRONTS_KEYS = 14 };

struct fronts_setting {
	const char *name, *values;  // of the keys, in their order: "0.5, 512"
};

/* The error of what the stage has just left in the capture, or NAN. reference: the folder that fronts_keep filled after the
 * run at the finest setting. */
typedef double fronts_error(const char *capture, const char *reference);

struct fronts_stage {
	const char *stage, *keys;               // "scale, max_size"
	const char *always;                     // further arguments of every run, or null
	struct fronts_setting finest;           // values null: the error is against a truth
	struct fronts_setting more[FRONTS_SETTINGS];  // beside the presets draft, review, final
	const char *unit, *error_of;
	fronts_error *error;
	const char *after;                      // a stage run after it, untimed, before the error is taken; or null
	int reps;                               // timed runs beside the one whose error is taken; 0: that one alone
	const char *also;                       // another capture: the error is the mean over both, the time that of the first; or null
	bool draft_to_review;                   // `final` would take too long here
	double mtexel;                          // 0, or million texels of the iris map that its time goes with
	bool anew;                              // the stage keeps what it can from its last run: work/ goes before each
};

/* True, said, in a quick run: config/fronts.conf has the fronts as they were measured last. */
bool fronts_left_out(void);

/* Measures the stage in `capture`, which has been made; `small`: the same of fewer megapixels, for the time's slope, or null
 * (all the time is fixed then). mpx: of the two. Rows, goals and the front's lines: bench/NAME.front. Where the environment
 * has STAGES ("limbus freckles"), of these alone. */
void fronts_measure(const struct fronts_stage *stage, const char *capture, const char *small, const double mpx[2]);

/* Copies work/ away as the reference of the errors. */
bool fronts_keep(const char *capture, const char *reference);

/* `make` of one stage, after those it needs; the log beside the folder. Returns false when it failed, after one line about that. */
bool fronts_make(const char *capture, const char *stage);

/* The lines of all stages measured so far, if any, into DIR/NAME.front, as config/fronts.conf has them. */
bool fronts_write(const char *dir, const char *name, struct err *err);

#endif
