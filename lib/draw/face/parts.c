#include "draw/face/impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/deform/lifted.h"

static bool is_surface(const struct rig *rig, int face)
{
	const uint8_t part = rig->part[rig->faces[face][0]];
	return part == RIG_SKIN || part == RIG_LINING;
}

/* Neighbours along the skin, and how much light comes from them. */
static void neighbours(struct portrait *p)
{
	const struct rig *rig = p->rig;
	int n = rig->n;
	p->near_start = mem_new((size_t)n + 2, sizeof *p->near_start);
	for (int f = 0; f < rig->n_faces; f++)
		for (int k = 0; k < 3 && is_surface(rig, f); k++)
			p->near_start[rig->faces[f][k] + 2] += 2;
	for (int i = 2; i <= n + 1; i++)
		p->near_start[i] += p->near_start[i - 1];
	p->near = mem_new((size_t)p->near_start[n + 1] + 1, sizeof *p->near);
	p->spread = mem_new((size_t)p->near_start[n + 1] + 1, sizeof *p->spread);
	for (int f = 0; f < rig->n_faces; f++)
		for (int k = 0; k < 3 && is_surface(rig, f); k++)
			for (int j = 1; j < 3; j++) {
				int a = rig->faces[f][k], b = rig->faces[f][(k + j) % 3], at = p->near_start[a + 1]++;
				double d[3];
				for (int c = 0; c < 3; c++)
					d[c] = rig->rest[a][c] - rig->rest[b][c];
				p->near[at] = b;
				p->spread[at] = (float)(0.5 * exp(-vec_norm(d) / fmax(p->conf.scatter_mm, 0.01)));
			}
}

/* Albedo of a character's own textures at the vertices: of lashes' ground, and for the page. */
static void dressed_colours(struct portrait *p)
{
	struct portrait_mesh *m = &p->mesh;
	for (int f = 0; f < m->n_dressed; f++)
		for (int k = 0; k < 3 && !m->cuts[f]; k++) {
			struct dress_point at;
			dress_at(&at, p->conf.dress, m->material[f], m->uv[f][k], 0.4f * m->uv_per_mm[f]);
			memcpy(m->albedo[m->faces[f][k]], at.rgb, sizeof at.rgb);
		}
}

/* Albedo: the skin's, in blotches; redder and darker where it is thin (lids, their margins, the canthi). */
static void colours(struct portrait *p)
{
	static const double thin[3] = { 0.93, 0.80, 0.80 }, margin[3] = { 0.98, 0.66, 0.64 };
	struct portrait_mesh *m = &p->mesh;
	for (int i = 0; i < p->rig->n; i++) {
		double gap = p->rig->gap[i];
		double radius = p->rig->globe[p->rig->side[i]].radius, lid = exp(-pow(fmax(gap, 0) / (0.28 * radius), 2));
		double rim = exp(-pow(fmax(gap - 0.2, 0) / (0.055 * radius), 2));
		static const double redder[3] = { 0.03, -0.14, -0.13 };
		double blotch = p->conf.texture * (0.6 * portrait_noise(m->rest[i], 0.13f) + 0.4 * portrait_noise(m->rest[i], 0.45f));
		for (int c = 0; c < 3; c++)
			m->albedo[i][c] = (float)(p->conf.skin_rgb[c] * (1 + redder[c] * blotch) * (1 + 0.7 * lid * (thin[c] - 1)) * (1 + 0.8 * rim * (margin[c] - 1)));
	}
	if (m->n_dressed) {
		dressed_colours(p);
		return;
	}
	for (int i = m->n_base; i < m->n; i++)
		for (int c = 0; c < 3; c++)
			m->albedo[i][c] = 0.5f * (m->albedo[m->between[i - m->n_base][0]][c] + m->albedo[m->between[i - m->n_base][1]][c]);
}

struct portrait *portrait_new(const struct rig *rig, const struct scene *const eyes[2], const struct envmap *env,
                              const struct portrait_conf *conf)
{
	struct portrait *p = mem_new(1, sizeof *p);
	*p = (struct portrait){ .rig = rig, .eye = { eyes[0], eyes[1] }, .env = env, .conf = *conf, .deform = deform_new(rig), .lids = deform_near_of(rig) };
	portrait_mesh_make(p);
	neighbours(p);
	colours(p);
	p->direct = mem_new((size_t)rig->n + 1, sizeof *p->direct);
	p->lit = mem_new((size_t)rig->n + 1, sizeof *p->lit);
	p->lit_at = mem_new((size_t)rig->n + 1, sizeof *p->lit_at);
	deform_rest(p->deform, p->mesh.x, p->mesh.normal);
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(p->target_from_globe[s], rig, (double[]){ 0, 0, 0 });
	portrait_mesh_move(p);
	portrait_wet_make(p);
	portrait_lashes_make(p);
	return p;
}

const struct hairs *portrait_hairs(const struct portrait *p)
{
	return &p->hairs;
}

void portrait_free(struct portrait *p)
{
	if (!p)
		return;
	portrait_mesh_free(&p->mesh);
	ray_scene_free(p->shadow);
	free(p->solid);
	deform_free(p->deform);
	deform_near_free(&p->lids);
	portrait_lashes_free(p);
	free(p->wrinkle_input);
	free(p->wrinkle_strength);
	free(p->direct);
	for (int side = 0; side < 2; side++)
		portrait_fringe_free(p->fringe[side]);
	free(p->lit);
	free(p->lit_at);
	free(p->near_start);
	free(p->near);
	free(p->spread);
	free(p);
}

void portrait_pose(struct portrait *p, const double *controls)
{
	double e[RIG_COMPONENTS], turn[2][3][3], lifted[2];
	deform_lifted(lifted, &p->lids, p->rig, controls);
	rig_components(e, p->rig, controls);
	rig_globes_turned(turn, p->rig, controls);
	memcpy(p->target_from_globe, turn, sizeof turn);
	portrait_fold_pose(p, controls);
	deform_pose(p->deform, e, (const double(*)[3][3])turn, p->mesh.x, p->mesh.normal);
	deform_settle(p->mesh.x, p->rig, &p->lids, (const double(*)[3][3])turn, lifted);
	portrait_mesh_move(p);
}
