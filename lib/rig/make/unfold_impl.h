/* unfold_impl: skin off the lids' margins as a sheet of faces that the front sees, which poses of shut eyes narrow or turn over; the smallest and smoothest move, in proportion to how far
 * eyes are closed, that leaves them some breadth. */
#ifndef RIG_MAKE_UNFOLD_IMPL_H
#define RIG_MAKE_UNFOLD_IMPL_H
#include <stdbool.h>

/* A face at rest. A gradient over it is the sum of its corners' values times slope. */
struct leaf {
	int v[3];
	double slope[3][2], area;  // 1/mm, mm^2
	bool held;                 // it ends at a margin
};

/* A pose of shut eyes, all shut or not. */
struct sheet_pose {
	double closed, (*at)[2];   // share of full closing; [n] where vertices are, mm to the left and up
	double *least;             // [n_leaves] the least breadth of each over that at rest
};

/* Its vertices have numbers of their own. Arrays are owned: sheet_free. */
struct sheet {
	int n, n_leaves, n_poses;
	double *may;               // [n] share to which a vertex may move
	struct leaf *leaf;
	struct sheet_pose *pose;
	double (*move)[2];         // [n] mm to the left and up, of full closing
	double (*added)[2];        // [n] what of it the poses have already
};

/* widen.c: how broad a face is in a pose, with moves as they are, over that at rest, where it is narrowest; negative where it is turned over. */
double sheet_breadth(const struct sheet *sheet, const struct sheet_pose *pose, const struct leaf *leaf);
/* Changes moves so that faces come nearer to their least breadths in all poses. */
void sheet_widen(struct sheet *sheet);
void sheet_free(struct sheet *sheet);

#endif
