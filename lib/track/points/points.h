/* points: points of skin in a reference frame, and which are neighbours.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_POINTS_POINTS_H
#define TRACK_POINTS_POINTS_H

enum { SKIN_NEAR_MAX = 32 };

/* The neighbours of point i are near[first[i] .. first[i + 1] - 1]. */
struct skin_points {
	int n;
	double (*at)[2];       // [n] px in the reference frame; owned, as are the next two
	int *first, *near;     // [n + 1], [first[n]]
};
void skin_points_free(struct skin_points *points);

/* Sets first and near, of n and at: of each point the `count` (at most SKIN_NEAR_MAX) nearest in the image among those within
 * three edges of a mesh, or, without edges (n_edges 0), among all. */
void skin_points_join(struct skin_points *points, int n_edges, const int (*edges)[2], int count);

#endif
