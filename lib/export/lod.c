#include "export/lod.h"

#include <meshoptimizer.h>
#include <stdlib.h>

#include "base/mem.h"

/* Moves rows of `size` bytes to where the new vertices are. */
static void *moved(const void *from, size_t size, size_t n, size_t left, const unsigned *remap)
{
	if (!from)
		return 0;
	void *out = mem_new(left + 1, size);
	meshopt_remapVertexBuffer(out, from, n, size, remap);
	return out;
}

struct export_part export_lod(const struct export_part *whole, int triangles, double *error_mm)
{
	struct export_part p = { 0 };
	size_t n = (size_t)whole->n, corners = (size_t)whole->n_corners;
	float error = 0;
	p.corner = mem_new(corners + 1, sizeof *p.corner);
	corners = meshopt_simplify(p.corner, whole->corner, corners, whole->x[0], n, sizeof *whole->x, 3 * (size_t)triangles, 1, meshopt_SimplifyLockBorder, &error);
	*error_mm = error * meshopt_simplifyScale(whole->x[0], n, sizeof *whole->x);
	meshopt_optimizeVertexCache(p.corner, p.corner, corners, n);
	unsigned *remap = mem_new(n + 1, sizeof *remap);
	size_t left = meshopt_optimizeVertexFetchRemap(remap, p.corner, corners, n);
	meshopt_remapIndexBuffer(p.corner, p.corner, corners, remap);
	p.n = (int)left;
	p.n_corners = (int)corners;
	p.x = moved(whole->x, sizeof *p.x, n, left, remap);
	p.normal = moved(whole->normal, sizeof *p.normal, n, left, remap);
	p.uv = moved(whole->uv, sizeof *p.uv, n, left, remap);
	p.tangent = moved(whole->tangent, sizeof *p.tangent, n, left, remap);
	for (int k = 0; k < EXPORT_TARGETS; k++)
		p.target[k] = moved(whole->target[k], sizeof *p.target[k], n, left, remap);
	free(remap);
	return p;
}
