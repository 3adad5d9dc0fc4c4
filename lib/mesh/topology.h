/* topology: neighbours, boundary edges and connected components of a triangle mesh. */
#ifndef MESH_TOPOLOGY_H
#define MESH_TOPOLOGY_H
#include "mesh/mesh.h"

struct topology {
	int n;                   // vertices
	int32_t *start;          // [n + 1]; the neighbours of i are neighbour[start[i]] .. neighbour[start[i + 1] - 1]
	int32_t *neighbour;      // rising within a vertex, each once
	uint8_t *boundary;       // [n] 1: on an edge of one face
	int32_t (*rim)[2];       // [n_rim] edges of one face, in the face's direction
	int n_rim;
	int n_tangled;           // non-manifold edges: of three faces or more
	int32_t *piece;          // [n] connected component, numbered by falling number of vertices
	int n_pieces;
};

/* Computes the topology of a mesh; faces with two equal corners are ignored. topology_free. */
void topology_make(struct topology *out, const struct mesh *mesh);
void topology_free(struct topology *topology);

/* For each of n vertices the lowest vertex of its connected component; a vertex without faces is a component of its own. free(). */
int *mesh_pieces(int n, int n_faces, const int32_t (*faces)[3]);

/* For each vertex a third of the area of its faces, in the mesh's unit squared; free(). */
double *mesh_vertex_areas(const struct mesh *mesh);

#endif
