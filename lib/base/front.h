/* front: Pareto fronts of error against time, one per stage, and the choice of a point on them by `error = 0.05 mm` or `time = 2 s`
 * in capture.conf, which takes the place of a preset.
 *
 * config/fronts.conf, written by `make fronts`, has a line for each point of a stage's front:
 *
 *     unrefract.small = 0.012 mm, 0.05 s + 0.04 s/Mpx: scale = 0.5, max_size = 512
 *
 * The error is measured against the finest setting or the truth; the time is a fixed part and a part for each megapixel of the
 * photographs, and, of a stage that works on the iris map, one for each million of its texels ("+ 0.2 s/Mtexel"). A line may be continued: unrefract.small.more = key = value, ...; unrefract.small.more2 = ...
 * plan chooses one point for each stage that runs and writes the choice to work/.made/front, where the stages read it
 * (front_use.h). A key that capture.conf sets has precedence over the point's, as over a preset's.
 */
#ifndef BASE_FRONT_H
#define BASE_FRONT_H
#include "base/conf.h"

struct front_point {
	char *stage, *name;
	double error, fixed_s, mpx_s, mtexel_s;  // error in `unit`; s; s for each megapixel, for each million texels
	char unit[8];          // of the error
	char *settings;        // "key = value, key = value"
	int line;
};

struct front {
	struct front_point *points;
	int n;
	struct conf conf;  // the file's text
};

/* What capture.conf asks for: an error, a time, or neither. */
struct front_ask {
	bool error, time;    // one of them, or none
	double value;        // in `unit`; seconds
	char unit[8];
	char text[64];       // "error = 0.05 mm"
};

/* Reads config/fronts.conf. Returns false, err set (file, line, key, value, rule), for a line that cannot be read. front_free in
 * any case. */
bool front_load(struct front *front, const char *path, struct err *err);
void front_free(struct front *front);

/* Reads the keys `error` and `time`. Returns false, err set, when they cannot be read, when both are given, or one of them beside
 * `quality`. */
bool front_ask(struct front_ask *ask, const struct conf *conf, struct err *err);

/* Chooses a point for each of n stages.
 * runs[n]    which of them run
 * mpx        size of all photographs, megapixels
 * mtexel     size of the iris map, million texels
 * others_s   seconds that stages without a front take
 * chosen[n]  out: indices into front->points; -1 where a stage has no front or, for an error, none in that unit: its preset
 *            `review` then holds
 * For an error: the fastest point within it; where there is none, the most exact one. For a time: greedy from the fastest points;
 * each step goes to the stage that gains the largest factor in error for a second, as long as the sum stays below. */
void front_choose(const struct front *front, const struct front_ask *ask, int n, const char *const stages[],
                  const bool runs[], double mpx, double mtexel, double others_s, int chosen[]);

/* Seconds that a point takes with photographs of so many megapixels and an iris map of so many million texels. */
double front_seconds(const struct front_point *point, double mpx, double mtexel);

#endif
