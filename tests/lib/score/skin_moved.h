/* skin_moved: errors of skin points by classes of their motion since the reference, so that equally hard frames are compared. */
#ifndef TESTS_SKIN_MOVED_H
#define TESTS_SKIN_MOVED_H

enum { SKIN_MOTIONS = 7 };

/* A point's error, px, and its class of motion: less than 0.5, 1, 2 px and so on, or more. */
struct skin_moved {
	double error;
	int far;
};

int skin_how_far(const double now[2], const double was[2]);

/* Median of n errors, each class of motion weighted as `far` counts it. NAN: they have none in common. Sorts the points. */
double skin_alike(long n, struct skin_moved *point, const double far[SKIN_MOTIONS]);

#endif
