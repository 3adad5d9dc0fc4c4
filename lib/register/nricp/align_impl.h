/* nricp_align_impl: the parts of nricp_align: the state of the search, the refinement of one start, and the starts. */
#ifndef REGISTER_NRICP_ALIGN_IMPL_H
#define REGISTER_NRICP_ALIGN_IMPL_H
#include "mesh/closest.h"
#include "mesh/topology.h"
#include "register/nricp/align.h"

/* moving_from_fixed: x = scale rotation p + shift. Samples of the fixed mesh are matched to the moving one, because the fixed mesh may
 * be a small part of it. */
struct pose {
	double rotation[3][3], shift[3], scale;
};

struct sample {
	double at[3], normal[3];
};

struct search {
	const struct nricp_align_conf *conf;
	struct mesh moving;  // in units of the fixed mesh's size, from the moving mesh's centroid
	float (*normals)[3];
	struct topology topology;
	struct closest_scene *scene;
	struct sample *samples;
	int n;
	int *face;           // [n] last match of each sample, where the next search begins
	int n_held;          // landmarks: the point `at` of the fixed mesh belongs on the vertex `row` of the moving one
	struct held {
		double at[3];
		int row;
	} *held;
};

static const struct pose pose_still = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0 }, 1 };

/* Normal equations of a round for the 7 unknowns: rotation vector, shift, relative growth. */
struct sums {
	double a[7][7], b[7], weight, square;
};

struct best {
	struct pose pose;
	double matched, rms, fine, rival;
};

/* Solves the normal equations and moves the pose; its scale stays within 1 / scale_max .. scale_max. Returns false when they are
 * singular. */
bool sums_move(struct pose *pose, struct sums *sums, double scale_max);

/* Refines the pose by rounds of matching and solving. welsch: first and last scale of the weight. step: every so manyth sample is
 * used. *rms: of the matches' distances across the surface. Returns the share of these samples matched at the end. */
double align_refine(struct pose *pose, double *rms, struct search *search, int rounds, const double welsch[2], int step);

/* Refines the pose by narrower weights, down to conf->fine. Returns the share matched by that. */
double align_narrow(struct pose *pose, struct search *search, int step);

/* Refines the pose in full: b->matched and rms by the last scale of conf->welsch, then b->fine, of a copy, by align_narrow. */
void align_finish(struct best *b, struct search *search, const double welsch[2]);

/* Adds the landmarks to the normal equations; `weight` is that of all together. */
void align_hold(struct sums *sums, const struct search *search, const struct pose *pose, double weight);

/* Sum of the squared distances of the landmarks from their places. */
double align_held_off(const struct search *search, const struct pose *pose);

/* Refines poses from all starts, and returns the best. offset: fixed centroid less moving centroid, in units of the search. */
struct best align_find(struct search *search, const double offset[3]);

/* The 24 rotations of a cube, the identity first. */
void align_cube(double out[24][3][3]);

#endif
