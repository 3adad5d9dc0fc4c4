/* mesh_part: the part of a mesh that is the surface to work on: coincident vertices merged, faces without area and small
 * components (eyeballs, teeth, lashes, fragments of a scan) left out; with counts of what was repaired.
 */
#ifndef MESH_MESH_PART_H
#define MESH_MESH_PART_H
#include "mesh/mesh.h"

struct mesh_part {
	struct mesh mesh;       // owned
	int32_t *row;           // [mesh.n_vertices] which vertex of the whole it is, the first of equals; owned
	int32_t *of;            // [whole's vertices] its vertex of the part; -1: left out; owned
	int32_t *face;          // [mesh.n_faces] which face of the whole; owned
	int doubled;            // vertices of the whole that lie exactly where another does and were joined to it
	int flat;               // faces without area
	int tangled;            // non-manifold edges (of three faces or more) of the part
	int rims;               // boundary loops (holes, ends) of the part
	int pieces, left_out;   // connected components of the whole after merging; how many of them were left out
	double whole_area, area;
};

/* Makes the part of a mesh. mesh_part_free.
 * least  components with less than this share of the largest one's area are left out, and closed ones (balls) with less than half
 *        of the largest one's
 * leave  [whole's vertices] faces whose corners are all marked are left out too; or null */
void mesh_part_make(struct mesh_part *out, const struct mesh *whole, double least, const bool *leave);
void mesh_part_free(struct mesh_part *part);

#endif
