#include "export/margin.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"

const char *const export_margin_names[EXPORT_MARGIN_PARTS] = { "lashes", "tears" };

/* From the rig's axes, mm, to a part's. */
static void to_part(struct export_part *p, const struct scene *eye, const struct rig *rig, int side)
{
	const struct rig_globe *g = &rig->globe[side];
	const double scale = eye->conf.sclera_radius / g->radius;
	for (int i = 0; i < p->n; i++) {
		double x[3], n[3], from[3];
		for (int c = 0; c < 3; c++) {
			from[c] = scale * ((double)p->x[i][c] - g->center[c]);
			n[c] = (double)p->normal[i][c];
		}
		mat_vec(x, rig->head_from_target, from);
		mat_vec(n, rig->head_from_target, n);
		for (int c = 0; c < 3; c++) {
			p->x[i][c] = (float)x[c];
			p->normal[i][c] = (float)n[c];
		}
	}
}

static struct export_part room(int n, size_t corners)
{
	return (struct export_part){ .n = n, .x = mem_new((size_t)n + 1, sizeof(float[3])), .normal = mem_new((size_t)n + 1, sizeof(float[3])),
		                         .corner = mem_new(corners + 1, sizeof(uint32_t)) };
}

void export_margin(struct export_part margin[EXPORT_MARGIN_PARTS], const struct scene *eye, const struct rig *rig, const struct hairs *hairs, int side,
                   double tear_mm, double over_mm)
{
	struct hairs own = { .local = hairs->local, .n_points = hairs->n_points };
	own.hair = mem_new((size_t)hairs->n + 1, sizeof *own.hair);
	own.rim = mem_new((size_t)hairs->n_rims + 1, sizeof *own.rim);
	for (int i = 0; i < hairs->n; i++)
		if (hairs->hair[i].side == side && hairs->hair[i].kind != HAIR_BROW)
			own.hair[own.n++] = hairs->hair[i];
	for (int i = 0; i < hairs->n_rims && tear_mm > 0; i++)
		if (hairs->rim[i].side == side)
			own.rim[own.n_rims++] = hairs->rim[i];
	struct export_part *lashes = &margin[EXPORT_LASHES], *tears = &margin[EXPORT_TEARS];
	*lashes = room(strands_count(&own), 3 * (size_t)strands_most_faces(&own));
	*tears = room(tears_count(&own), 6 * (size_t)tears_count(&own));
	strands_place(lashes->x, lashes->normal, &own, rig, (const float(*)[3])rig->rest);
	lashes->n_corners = 3 * strands_faces((uint32_t(*)[3])lashes->corner, &own, 0, own.n);
	tears_rest(tears->x, tears->normal, &own, rig, tear_mm, over_mm);
	tears->n_corners = 3 * tears_faces((uint32_t(*)[3])tears->corner, &own, 0);
	for (int k = 0; k < EXPORT_MARGIN_PARTS; k++)
		to_part(&margin[k], eye, rig, side);
	free(own.hair);
	free(own.rim);
}
