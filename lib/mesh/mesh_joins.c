#include "mesh/mesh_joins.h"

#include <stdlib.h>

#include "base/mem.h"

/* About 8 ns each, 4 s in all: 22 000 triangles round one vertex, or 14 million sound vertices of six. */
enum { STEPS_MAX = 500000000 };

struct mesh_joins mesh_joins_begin(long n_vertices)
{
	return (struct mesh_joins){ .faces = mem_new((size_t)n_vertices, sizeof(int32_t)) };
}

void mesh_joins_add(struct mesh_joins *joins, const int32_t corner[3])
{
	for (int k = 0; k < 3; k++) {
		int32_t n = ++joins->faces[corner[k]];
		joins->steps += 2 * (int64_t)n - 1;
		if (n > joins->faces[joins->busiest])
			joins->busiest = corner[k];
	}
}

bool mesh_joins_end(struct mesh_joins *joins, struct err *err)
{
	bool few = joins->steps <= STEPS_MAX;
	if (!few)
		err_set(err, "%d faces meet in vertex %d: too many to be joined", joins->faces[joins->busiest], joins->busiest);
	free(joins->faces);
	*joins = (struct mesh_joins){ 0 };
	return few;
}
