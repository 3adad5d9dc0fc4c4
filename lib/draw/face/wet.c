/* The inner corner of the eye: the caruncle, a moist mound of mucous membrane between the lids, and the lacrimal lake that
 * stands before it. The corner is found in a picture at rest: the innermost place of the globe
 * between the lids. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/look.h"
#include "draw/face/impl.h"
#include "draw/face/skin_look.h"

enum { VIEW = 480 };

static void point_of(float out[3], const struct portrait_rays *rays, double x, double y, float depth)
{
	float dir[3], along = portrait_ray(dir, rays, x, y);
	for (int c = 0; c < 3; c++)
		out[c] = rays->origin[c] + depth / along * dir[c];
}

/* The pixel of that eye nearest to the nose: of the left eye the first column's, of the right eye the last one's. */
static bool innermost(int at[2], const struct portrait_spot *spots, int side)
{
	for (int k = 0; k < VIEW; k++) {
		int x = side ? VIEW - 1 - k : k, n = 0, sum = 0;
		for (int y = 0; y < VIEW; y++)
			if (spots[y * VIEW + x].face == -2 - side) {
				sum += y;
				n++;
			}
		if (!n)
			continue;
		at[0] = x;
		at[1] = sum / n;
		return k > 0;
	}
	return false;
}

/* Corner of the globe and middle of the caruncle, a few pixels further towards the nose. */
static bool find_corner(float corner[3], float caruncle[3], const struct portrait *p, const struct portrait_view *v, int side)
{
	struct portrait_spot *spots = portrait_raster(p, v, 1);
	struct portrait_rays rays = portrait_rays_of(v);
	double size = p->rig->globe[side].radius / 12, mm = 3.2 * p->rig->globe[side].radius / VIEW;
	int at[2], step = (int)(CARUNCLE_OFF * size / mm);
	bool found = innermost(at, spots, side);
	if (found) {
		int x = side ? at[0] + step : at[0] - step;
		const struct portrait_spot *globe = &spots[at[1] * VIEW + at[0]], *skin = &spots[at[1] * VIEW + x];
		found = x >= 0 && x < VIEW && skin->face >= 0 && fabsf(skin->depth - globe->depth) < 6 * (float)size;
		if (found) {
			point_of(corner, &rays, at[0] + 0.5, at[1] + 0.5, globe->depth);
			point_of(caruncle, &rays, x + 0.5, at[1] + 0.5, skin->depth);
		}
	}
	free(spots);
	return found;
}

/* The middle of the caruncle, where one stands: of what of the lining is thick. False: there is none. */
static bool find_mound(float middle[3], const struct portrait *p, int side)
{
	const struct rig *rig = p->rig;
	const float thick = (float)(MUCOSA_THICK_MM * rig->globe[side].radius / 12);
	int n = 0;
	float sum[3] = { 0 };
	for (int i = rig_own_vertices(rig); i < rig->n; i++)
		if (rig->side[i] == side && rig->gap[i] > thick) {
			for (int c = 0; c < 3; c++)
				sum[c] += rig->rest[i][c];
			n++;
		}
	for (int c = 0; c < 3 && n; c++)
		middle[c] = sum[c] / (float)n;
	return n > 0;
}

/* Lining is mucous membrane, paler where it is thin. */
static void line(struct portrait *p)
{
	static const float thick[3] = { MUCOSA_RGB }, thin[3] = { MUCOSA_THIN_RGB };
	struct portrait_mesh *m = &p->mesh;
	const struct rig *rig = p->rig;
	const int first = rig_own_vertices(rig);
	bool *lined = mem_new((size_t)m->n + 1, sizeof *lined);
	for (int i = first; i < rig->n; i++) {
		const float at = (float)(rig->gap[i] / (MUCOSA_THICK_MM * rig->globe[rig->side[i]].radius / 12)), t = fminf(at, 1);
		lined[i] = true;
		m->wet[i] = (float)p->conf.caruncle_wet;
		for (int c = 0; c < 3; c++)
			m->albedo[i][c] = thin[c] + t * (thick[c] - thin[c]);
	}
	for (int i = m->n_base; i < m->n && first < rig->n; i++) {
		const int *e = m->between[i - m->n_base];
		lined[i] = lined[e[0]] || lined[e[1]];
		if (!lined[i])
			continue;
		m->wet[i] = 0.5f * (m->wet[e[0]] + m->wet[e[1]]);
		for (int c = 0; c < 3; c++)
			m->albedo[i][c] = 0.5f * (m->albedo[e[0]][c] + m->albedo[e[1]][c]);
	}
	free(lined);
}

static void wet_vertices(struct portrait *p, const float caruncle[3], int side, float end_mm)
{
	static const float red[3] = { CARUNCLE_RED };
	struct portrait_mesh *m = &p->mesh;
	float size = (float)(p->rig->globe[side].radius / 12);
	for (int i = 0; i < m->n; i++) {
		float r2 = 0;
		for (int c = 0; c < 3; c++)
			r2 += (m->rest[i][c] - caruncle[c]) * (m->rest[i][c] - caruncle[c]);
		float t = fminf(fmaxf((sqrtf(r2) / size - (float)CARUNCLE_MM) / (end_mm - (float)CARUNCLE_MM), 0), 1);
		float wet = (1 - t * t * (3 - 2 * t)) * (float)p->conf.caruncle_wet;
		if (!(wet > m->wet[i]))
			continue;
		m->wet[i] = wet;
		for (int c = 0; c < 3; c++)
			m->albedo[i][c] *= 1 + wet * (red[c] - 1);
	}
}

void portrait_wet_make(struct portrait *p)
{
	p->first_lash = p->mesh.n_faces;  // there are none yet
	for (int side = 0; side < 2; side++) {
		struct portrait_view view = portrait_front(p->rig, side, 3.2 * p->rig->globe[side].radius, 0, 0, VIEW, VIEW);
		float caruncle[3];
		p->corner_known[side] = find_corner(p->corner[side], caruncle, p, &view, side);
		const bool mound = find_mound(caruncle, p, side);
		if ((p->corner_known[side] || mound) && p->conf.caruncle_wet > 0)
			wet_vertices(p, caruncle, side, (float)(mound ? CARUNCLE_BESIDE_MM : CARUNCLE_END_MM));
	}
	line(p);
}

float portrait_lake_height(const struct portrait *p, int side, const float at[3])
{
	float r2 = 0, reach = (float)(LAKE_MM * p->rig->globe[side].radius / 12), tear = (float)p->conf.tear_mm;
	if (!p->corner_known[side])
		return tear;
	for (int c = 0; c < 3; c++)
		r2 += (at[c] - p->corner[side][c]) * (at[c] - p->corner[side][c]);
	return tear * (1 + (float)LAKE_RISE * expf(-r2 / (reach * reach)));
}

float portrait_lake_depth(float d, float height)
{
	float x = height - fminf(fmaxf(d, 0), height);
	return height - sqrtf(height * height - x * x);
}

void portrait_lake_light(float through[3], float depth, float cos_i, const double absorb[3])
{
	float s2 = (1 - cos_i * cos_i) / ((float)LOOK_FILM_INDEX * (float)LOOK_FILM_INDEX), way = depth * (1 / sqrtf(1 - s2) + (float)LAKE_LIGHT_WAY);
	for (int c = 0; c < 3; c++)
		through[c] = expf(-(float)absorb[c] * way);
}

float portrait_film_share(float cos_i)
{
	float n = (float)LOOK_FILM_INDEX, c = fmaxf(cos_i, 0), t = sqrtf(n * n - 1 + c * c), s = (c - t) / (c + t), q = (n * n * c - t) / (n * n * c + t);
	return 0.5f * (s * s + q * q);
}

void portrait_wet_shade(float rgb[3], const struct portrait *p, const float rig_from_cam[3][3], const float n[3], const float dir[3], float wet,
                        float open)
{
	float c = -(dir[0] * n[0] + dir[1] * n[1] + dir[2] * n[2]), share = wet * portrait_film_share(c), cam[3] = { 0 }, room[3];
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			cam[k] += rig_from_cam[i][k] * (dir[i] + 2 * c * n[i]);
	envmap_at(room, p->env, cam, (float)TEAR_ROUGH);
	for (int i = 0; i < 3; i++)
		rgb[i] += share * ((p->matte ? 0 : open * room[i]) - rgb[i]);
}
