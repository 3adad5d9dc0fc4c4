/* lid_line: a margin of a lid as a chain of points, px, from the inner corner to the outer. */
#ifndef TRACK_LID_LINE_H
#define TRACK_LID_LINE_H
#include "track/eye/opening.h"
#include "track/eye/eye_track.h"

enum { LINE = OPENING_POINTS + 2 * LID_POINTS_MAX };

struct line {
	int n;
	double p[LINE][2];
};

/* Share of the way from one place to another at which p lies. */
double line_along(const double p[2], const double from[2], const double to[2]);

/* The place of a line nearest to p. */
void line_nearest(double out[2], const struct line *line, const double p[2]);

/* Where a line that runs from end to end passes the share u. False: it does not. */
bool line_passes(double out[2], const struct line *line, double u, const double ends[2][2]);

/* Nothing happens to a line that is full. */
void line_add(struct line *line, const double p[2]);

/* n points at equal distances along a line of at least two. */
void line_spread(double (*out)[2], int n, const struct line *line);

#endif
