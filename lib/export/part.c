#include "export/part.h"

#include <stdlib.h>

#include "base/mem.h"

void export_part_free(struct export_part *p)
{
	free(p->x);
	free(p->normal);
	free(p->uv);
	free(p->tangent);
	free(p->corner);
	for (int k = 0; k < EXPORT_TARGETS; k++)
		free(p->target[k]);
	*p = (struct export_part){ 0 };
}

struct export_part export_grid(int rings, int around, bool pole_first, bool pole_last)
{
	struct export_part p = { .n = rings * around };
	size_t n = (size_t)p.n;
	p.x = mem_new(n, sizeof *p.x);
	p.normal = mem_new(n, sizeof *p.normal);
	p.uv = mem_new(n, sizeof *p.uv);
	p.corner = mem_new(6 * n, sizeof *p.corner);
	for (int j = 0; j + 1 < rings; j++)
		for (int i = 0; i < around; i++) {
			uint32_t a = (uint32_t)(j * around + i), b = (uint32_t)(j * around + (i + 1) % around);
			uint32_t c = a + (uint32_t)around, d = b + (uint32_t)around;
			const uint32_t quad[6] = { a, c, d, a, d, b };
			for (int k = 0; k < 6; k++)
				if (!(k < 3 ? pole_last && j + 2 == rings : pole_first && !j))
					p.corner[p.n_corners++] = quad[k];
		}
	return p;
}
