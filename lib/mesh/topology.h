/* topology: which vertices of a triangle mesh are neighbours, where it ends, and of how many pieces it is made. */
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
	int n_tangled;           // edges of three faces or more
	int32_t *piece;          // [n] pieces that no edge joins, numbered by falling number of vertices
	int n_pieces;
};

/* Faces with two equal corners are passed over. topology_free. */
void topology_make(struct topology *out, const struct mesh *mesh);
void topology_free(struct topology *topology);

/* Of each of n vertices the lowest one that faces join it to: alone, where it is in none. free(). */
int *mesh_pieces(int n, int n_faces, const int32_t (*faces)[3]);

/* A third of the area of its faces, of each vertex; free(). Squared length of the mesh's unit. */
double *mesh_vertex_areas(const struct mesh *mesh);

#endif
