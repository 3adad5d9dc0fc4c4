#include "rig/glb/posed.h"

#include <stdlib.h>

#include "base/mem.h"

struct posed posed_new(const struct glb_bake *b)
{
	return (struct posed){ mem_array(3 * (size_t)b->n + 1, sizeof(float)), mem_array(3 * (size_t)b->n + 1, sizeof(float)), mem_array(3 * (size_t)b->n_hair + 1, sizeof(float)) };
}

void posed_free(struct posed *p)
{
	free(p->x);
	free(p->lean);
	free(p->hair);
}

void posed_take(struct posed *to, const struct poser *p, const struct glb_bake *b)
{
	poser_skin(to->x, to->lean, p, b->n, b->vertex);
	poser_hair(to->hair, p);
}

struct posed posed_of(const struct glb_bake *b, int pose)
{
	return (struct posed){ b->pose + 3 * (size_t)pose * (size_t)b->n, b->pose_lean + 3 * (size_t)pose * (size_t)b->n, b->hair_pose + 3 * (size_t)pose * (size_t)b->n_hair };
}
