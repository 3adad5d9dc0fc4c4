/* mesh_part: what of a mesh is the surface to work on: doubled vertices joined, faces without area and small pieces
 * (eyeballs, teeth, lashes, strays of a scan) left out; and what had to be mended for it.
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
	int tangled;            // edges of three faces or more, of the part
	int rims;               // boundaries (holes, ends) of the part
	int pieces, left_out;   // of the whole, once joined; and how many were left out
	double whole_area, area;
};

/* least: pieces smaller than this share of the largest's area are left out, and closed ones (balls) smaller than half of
 * it. leave: [whole's vertices] faces whose corners are all marked are left out too; or null. mesh_part_free. */
void mesh_part_make(struct mesh_part *out, const struct mesh *whole, double least, const bool *leave);
void mesh_part_free(struct mesh_part *part);

#endif
