/* front: settings of a stage that no other setting beats in both time and error, as measured, and which of them
 * `error = 0.05 mm` or `time = 2 s` in capture.conf asks for in place of a preset.
 *
 * config/fronts.conf, written by `make fronts`, has a line for each point of a stage's front:
 *
 *     unrefract.small = 0.012 mm, 0.05 s + 0.04 s/Mpx: scale = 0.5, max_size = 512
 *
 * error against the finest setting or the truth, and time: fixed, and for each megapixel of the photographs. What does not fit
 * its line goes on in the next ones: unrefract.small.more = key = value, ...; unrefract.small.more2 = ...
 * plan chooses one point for each stage that runs and leaves its choice in work/.made/front; the stages take their
 * settings from there. What capture.conf says of a single key goes before it, as before a preset.
 */
#ifndef BASE_FRONT_H
#define BASE_FRONT_H
#include "base/conf.h"

struct front_point {
	char *stage, *name;
	double error, fixed_s, mpx_s;
	char unit[8];          // of the error
	char *settings;        // "key = value, key = value"
	int line;
};

struct front {
	struct front_point *points;
	int n;
	struct conf conf;  // the file's text
};

/* What capture.conf asks for. */
struct front_ask {
	bool error, time;    // one of them, or none
	double value;        // in `unit`; seconds
	char unit[8];
	char text[64];       // "error = 0.05 mm"
};

/* False, err set (file, line, key, value, rule), for a line that cannot be read. front_free in any case. */
bool front_load(struct front *front, const char *path, struct err *err);
void front_free(struct front *front);

/* False, err set, for what cannot be read, error and time together, or either beside quality. */
bool front_ask(struct front_ask *ask, const struct conf *conf, struct err *err);

/* The points of n stages for what is asked, as indices into front->points; -1 where a stage has no front or, for an
 * error, none in that unit: its preset `review` stands. runs: which of them run; others_s: seconds of those without a
 * front. error: the fastest point that is as exact; where none is, the most exact one. time: each further second goes
 * where it makes an error smaller by the largest factor, as long as the sum stays below; never less than the fastest. */
void front_choose(const struct front *front, const struct front_ask *ask, int n, const char *const stages[],
                  const bool runs[], double mpx, double others_s, int chosen[]);

double front_seconds(const struct front_point *point, double mpx);

#endif
