/* Rasteriser: which surface every sample shows, and which hairs before it. Bands of rows, one thread each, so that the result does not depend on threads. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/face/impl.h"

struct screen {
	const struct portrait *p;
	float (*at)[3];  // x, y in samples, depth; depth <= 0: behind the camera
	int points, width, height;
	struct portrait_spot *spots;
	struct portrait_veils *veils;  // null: surfaces are drawn; else hairs, and before there is room for them the pixels are marked that have one
	int samples;
};

/* A hair at a sample. Hairs thinner than samples lie apart are drawn so wide, and let through what they would not hide. */
static void hide(struct screen *s, int face, int x, int y, float depth)
{
	struct portrait_veils *v = s->veils;
	const long pixel = (long)(y / s->samples) * (s->width / s->samples) + x / s->samples;
	if (!(depth < s->spots[(long)y * s->width + x].depth))
		return;
	if (!v->veil) {
		v->at[pixel] = 0;
		return;
	}
	struct portrait_veil *to = &v->veil[v->at[pixel] + y % s->samples * s->samples + x % s->samples];
	to->through *= 1 - portrait_lash_cover(s->p, face);
	if (depth < to->depth) {
		to->depth = depth;
		to->face = face;
	}
}

static void project(struct screen *s, const struct portrait *p, const struct portrait_view *v, int samples)
{
	for (int i = 0; i < s->points; i++) {
		const float *x = p->mesh.x[i];
		double c[3];
		for (int k = 0; k < 3; k++)
			c[k] = v->cam_from_target[k][0] * x[0] + v->cam_from_target[k][1] * x[1] + v->cam_from_target[k][2] * x[2]
			       + v->cam_from_target[k][3];
		s->at[i][0] = (float)(samples * (v->focal_px * c[0] / c[2] + v->center_px[0]));
		s->at[i][1] = (float)(samples * (v->focal_px * c[1] / c[2] + v->center_px[1]));
		s->at[i][2] = (float)c[2];
	}
}

/* One triangle in the rows [low, high). Front faces alone: skin has an inside nobody sees. */
static void fill(struct screen *s, const int32_t v[3], int face, int low, int high)
{
	const float *a = s->at[v[0]], *b = s->at[v[1]], *c = s->at[v[2]];
	float above = (float)low + 0.5f, below = (float)high - 0.5f;  // most triangles lie in another band
	if ((a[1] < above && b[1] < above && c[1] < above) || (a[1] > below && b[1] > below && c[1] > below))
		return;
	if (!(a[2] > 1 && b[2] > 1 && c[2] > 1))
		return;
	// Counter-clockwise from outside; the picture's y points down.
	float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
	const bool cuts = face < s->p->mesh.n_dressed && s->p->mesh.cuts[face];  // hair cards are seen from both sides
	if (!(area < 0) && !(cuts && area > 0))
		return;
	int y0 = (int)fmaxf(ceilf(fminf(fminf(a[1], b[1]), c[1]) - 0.5f), (float)low);
	int y1 = (int)fminf(floorf(fmaxf(fmaxf(a[1], b[1]), c[1]) - 0.5f), (float)high - 1);
	int x0 = (int)fmaxf(ceilf(fminf(fminf(a[0], b[0]), c[0]) - 0.5f), 0);
	int x1 = (int)fminf(floorf(fmaxf(fmaxf(a[0], b[0]), c[0]) - 0.5f), (float)s->width - 1);
	float ia = 1 / a[2], ib = 1 / b[2], ic = 1 / c[2], k = 1 / area;
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			float px = (float)x + 0.5f, py = (float)y + 0.5f;
			float wa = ((c[0] - b[0]) * (py - b[1]) - (c[1] - b[1]) * (px - b[0])) * k;
			float wb = ((a[0] - c[0]) * (py - c[1]) - (a[1] - c[1]) * (px - c[0])) * k, wc = 1 - wa - wb;
			// Enlarged by 1e-5, so that no sample falls between two triangles.
			if (wa < -1e-5f || wb < -1e-5f || wc < -1e-5f)
				continue;
			float depth = 1 / (wa * ia + wb * ib + wc * ic);
			struct portrait_spot *spot = &s->spots[(long)y * s->width + x];
			if (s->veils)
				hide(s, face, x, y, depth);
			else if (depth < spot->depth && !(cuts && portrait_cut_away(s->p, face, (float[3]){ wa * ia * depth, wb * ib * depth, wc * ic * depth })))
				*spot = (struct portrait_spot){ face, depth };
		}
}

static void put_eye(struct screen *s, const struct portrait *p, const struct portrait_rays *rays, int side, int samples, int low,
                    int high)
{
	const struct rig_globe *g = &p->rig->globe[side];
	const struct portrait_view *v = rays->view;
	double c[3];
	for (int k = 0; k < 3; k++)
		c[k] = v->cam_from_target[k][0] * g->center[0] + v->cam_from_target[k][1] * g->center[1]
		       + v->cam_from_target[k][2] * g->center[2] + v->cam_from_target[k][3];
	double half = 1.4 * g->radius * v->focal_px / fmax(c[2] - 1.4 * g->radius, 1);
	double x = v->focal_px * c[0] / c[2] + v->center_px[0], y = v->focal_px * c[1] / c[2] + v->center_px[1];
	int y0 = (int)fmax(samples * (y - half), low), y1 = (int)fmin(samples * (y + half), high - 1);
	int x0 = (int)fmax(samples * (x - half), 0), x1 = (int)fmin(samples * (x + half), s->width - 1);
	for (int j = y0; j <= y1; j++)
		for (int i = x0; i <= x1; i++) {
			float dir[3], along = portrait_ray(dir, rays, (i + 0.5) / samples, (j + 0.5) / samples);
			float depth = along * portrait_eye_hit(p, side, rays->origin, dir);
			struct portrait_spot *spot = &s->spots[(long)j * s->width + i];
			if (depth < spot->depth)
				*spot = (struct portrait_spot){ -2 - side, depth };
		}
}

enum { BAND = 64 };

struct portrait_spot *portrait_raster(const struct portrait *p, const struct portrait_view *v, int samples)
{
	struct screen s = { .p = p, .points = p->mesh.n, .width = v->width * samples, .height = v->height * samples, .samples = samples };
	struct portrait_rays rays = portrait_rays_of(v);
	long n = (long)s.width * s.height;
	s.at = mem_array((size_t)s.points + 1, sizeof *s.at);
	s.spots = mem_array((size_t)n, sizeof *s.spots);
	project(&s, p, v, samples);
#pragma omp parallel for schedule(dynamic)
	for (int band = 0; band < (s.height + BAND - 1) / BAND; band++) {
		int low = band * BAND, high = low + BAND < s.height ? low + BAND : s.height;
		for (long i = (long)low * s.width; i < (long)high * s.width; i++)
			s.spots[i] = (struct portrait_spot){ -1, INFINITY };
		for (int f = 0; f < p->first_lash; f++)
			fill(&s, p->mesh.faces[f], f, low, high);
		for (int side = 0; side < 2; side++)
			put_eye(&s, p, &rays, side, samples, low, high);
	}
	free(s.at);
	return s.spots;
}

struct portrait_veils portrait_veils_of(const struct portrait *p, const struct portrait_view *v, struct portrait_spot *spots, int samples)
{
	const int rows = BAND / samples * samples;  // whole pixels
	const long pixels = (long)v->width * v->height;
	struct portrait_veils veils = { .at = mem_array((size_t)pixels + 1, sizeof *veils.at) };
	struct screen s = { .p = p, .points = p->lash_vertex + 2 * p->hairs.n_points, .width = v->width * samples, .height = v->height * samples, .spots = spots, .veils = &veils,
		                .samples = samples };
	long n = 0;
	s.at = mem_array((size_t)s.points + 1, sizeof *s.at);
	project(&s, p, v, samples);
	for (long i = 0; i < pixels; i++)
		veils.at[i] = -1;
	for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for schedule(dynamic)
		for (int low = 0; low < s.height; low += rows)
			for (int f = p->first_lash; f < p->mesh.n_faces; f++)
				fill(&s, p->mesh.faces[f], f, low, low + rows < s.height ? low + rows : s.height);
		for (long i = 0; i < pixels && !pass; i++)
			if (veils.at[i] == 0) {
				veils.at[i] = n;
				n += samples * samples;
			}
		if (!pass)
			veils.veil = mem_array((size_t)n + 1, sizeof *veils.veil);
		for (long i = 0; i < n && !pass; i++)
			veils.veil[i] = (struct portrait_veil){ -1, INFINITY, 1 };
	}
	free(s.at);
	return veils;
}

void portrait_veils_free(struct portrait_veils *veils)
{
	free(veils->at);
	free(veils->veil);
}
