/* nricp_align_impl: the parts of nricp_align: the search's state, one start refined, and the starts. */
#ifndef REGISTER_NRICP_ALIGN_IMPL_H
#define REGISTER_NRICP_ALIGN_IMPL_H
#include "mesh/closest.h"
#include "mesh/topology.h"
#include "register/nricp/align.h"

/* x of the moving mesh = scale rotation p + shift, p of the fixed one: the search goes from the fixed mesh to the
 * moving, of which the fixed may be a small part. */
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
	int *face;           // [n] matched last
	int n_held;          // landmarks that a refinement keeps together: p of the fixed mesh on the vertex `row` of the moving one
	struct held {
		double at[3];
		int row;
	} *held;
};

static const struct pose pose_still = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0 }, 1 };

/* A round's sums of least squares for the 7 unknowns: turn, shift, growth. */
struct sums {
	double a[7][7], b[7], weight, square;
};

struct best {
	struct pose pose;
	double matched, rms;
	int start;
};

/* Moves the pose by the sums' answer; growth is kept within 1 / scale_max .. scale_max. False: they have none. */
bool sums_move(struct pose *pose, struct sums *sums, double scale_max);

/* Rounds of matching; returns the share matched at the end. welsch: first and last scale. */
double align_refine(struct pose *pose, double *rms, struct search *search, int rounds, const double welsch[2]);

/* All landmarks' pulls, of that weight together. */
void align_hold(struct sums *sums, const struct search *search, const struct pose *pose, double weight);

/* The best of all starts. offset: between the centroids, in units of the search. */
struct best align_find(struct search *search, const double offset[3]);

#endif
