/* What is added to a rig behind its own vertices and faces (added.c) by lining.c and corner.c. For the files of this folder. */
#ifndef RIG_MAKE_LINING_IMPL_H
#define RIG_MAKE_LINING_IMPL_H
#include "rig/make/make_impl.h"

/* Vertices and faces to be added. of, share: what a vertex follows. */
struct lining {
	int n, n_of, n_faces, first, side;  // first: the number of the first
	struct lining_vertex {
		float rest[3], gap;
		int side, of;                   // of its followers the first
	} *vertex;
	int *of;
	float *share;
	int32_t (*faces)[3];
};

/* Starts a vertex at that place, which keeps `gap` mm over the globe; whom it follows comes next. Returns its number. */
int32_t lining_vertex(struct lining *m, const double rest[3], double gap);
/* The last vertex moves as that one of the rig, by that share of all. */
void lining_follow(struct lining *m, int vertex, double share);
/* The first corner has to be a vertex of ours: a face is what its first corner is. */
void lining_face(struct lining *m, int32_t a, int32_t b, int32_t c);

/* A place over an eye's globe in a direction of the head's axes: so far from its surface. */
void lining_over_globe(double out[3], const struct rig *rig, int side, const double head[3], double gap);

/* Behind those of the rig, with their normals and those of the edges that they are sewn to. */
void lining_append(struct rig *rig, const struct lining *m);

/* corner.c: the caruncle and the plica semilunaris of each inner corner. */
void lining_corners(struct lining *m, const struct rig *rig, const struct rig_conf *conf);

#endif
