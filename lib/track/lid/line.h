/* line: a margin of a lid as a polyline, px, from the inner corner to the outer. */
#ifndef TRACK_LID_LINE_H
#define TRACK_LID_LINE_H
#include "track/eye/opening.h"
#include "track/eye/eye_track.h"

enum { LINE = OPENING_POINTS + 2 * LID_POINTS_MAX };

struct line {
	int n;
	double p[LINE][2];
};

/* Projection of p onto the segment from..to, as a share of its length. */
double line_along(const double p[2], const double from[2], const double to[2]);

/* The point of a line nearest to p. */
void line_nearest(double out[2], const struct line *line, const double p[2]);

/* The point of a line at the share u of the way between the two ends. Returns false when the line does not pass it. */
bool line_passes(double out[2], const struct line *line, double u, const double ends[2][2]);

/* Appends a point; nothing happens when the line is full. */
void line_add(struct line *line, const double p[2]);

/* n points at equal arc lengths along a line of at least two. */
void line_spread(double (*out)[2], int n, const struct line *line);

#endif
