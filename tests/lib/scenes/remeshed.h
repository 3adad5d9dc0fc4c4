/* remeshed: a character in another topology: its surface in triangles of its own, more or fewer, none of them where an edge was; eyeballs as
 * spheres of triangles; stretched into other proportions. */
#ifndef TESTS_SCENES_REMESHED_H
#define TESTS_SCENES_REMESHED_H
#include "mesh/mesh.h"

struct remeshed {
	int faces;          // of the head; 0: as they are
	double stretch[3];  // of x, y, z about the middle between the eyeballs; eyeballs keep their shape, their size goes with y; 0: 1
	double ball[4];     // centre of the left eyeball and radius, where the mesh has none, the right one across x = 0; radius 0: it has two
};

/* Head first, then the left and the right eyeball (x above 0: left). Returns false, err set, where it has no eyeballs or cannot be decimated. */
bool remeshed_make(struct mesh *out, const struct mesh *in, const struct remeshed *how, struct err *err);

#endif
