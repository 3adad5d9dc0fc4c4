/* The tear line (skin paper, chapter 4) between lid and globe, from the screen's distance field: distances are those in view space, from the
 * point of the globe that a pixel shows to the one that the lid's edge hides on the screen.
 *
 * The meniscus is a quarter of a circle, tangent to the globe and to the lid: with d the distance to the lid and R its height,
 * its depth is R - sqrt(R^2 - (R - d)^2). Its normal leans away from the lid, so along a lower lid it reflects what is above.
 * It is higher at the inner corner, and absorbs light on its way in and out (wet.c). */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/face/impl.h"
#include "draw/face/skin_look.h"
#include "draw/smooth.h"
#include "image/distance/distance.h"

/* A part of the screen round one eye: inputs and outputs of the distance field. */
struct field {
	int x0, y0, width, height;
	uint8_t *material;
	float *cover, *depth, *distance, (*nearest)[2];  // the camera's unit; px
};

static void field_free(struct field *f)
{
	free(f->material);
	free(f->cover);
	free(f->depth);
	free(f->distance);
	free(f->nearest);
}

// Without hairs: they lie before a lid's edge and are not part of it.
uint8_t portrait_material(float *cover, const struct portrait_spot *spots, long row, int samples, int side)
{
	int skin = 0, globe = 0;
	for (int j = 0; j < samples; j++)
		for (int i = 0; i < samples; i++) {
			const struct portrait_spot *s = &spots[j * row + i];
			bool is_skin = s->face >= 0, is_globe = s->face == -2 - side;
			skin += is_skin;
			globe += is_globe;
		}
	int all = skin + globe;
	*cover = all ? (float)skin / (float)all : 0;
	return !all ? DISTANCE_OTHER : 2 * skin >= all ? DISTANCE_SKIN : DISTANCE_GLOBE;
}

/* Of the globe, below lids, too: the lid's own edge stands off it by what the mesh's facets leave, or by its thickness. Beside the globe its centre's. */
void portrait_globe_depth(float *depth, const struct portrait *p, const struct portrait_rays *rays, int side, const int from[2], const int size[2], float away)
{
#pragma omp parallel for schedule(static)
	for (int y = 0; y < size[1]; y++)
		for (int x = 0; x < size[0]; x++) {
			float dir[3], along = portrait_ray(dir, rays, from[0] + x + 0.5, from[1] + y + 0.5), t = portrait_eye_hit(p, side, rays->origin, dir);
			depth[(long)y * size[0] + x] = isfinite(t) ? t * along : away;
		}
}

static struct field field_make(const struct portrait *p, const struct portrait_view *v, const struct portrait_spot *spots, int samples, int side,
                               const struct image *eye, const int at[2], double reach, double away, const struct portrait_rays *rays)
{
	struct field f = { 0 };
	int margin = 4 + (int)fmin(ceil(1.2 * reach * v->focal_px / fmax(away, 1e-3)), 64), x1 = at[0] + eye->width + margin, y1 = at[1] + eye->height + margin;
	f.x0 = at[0] > margin ? at[0] - margin : 0;
	f.y0 = at[1] > margin ? at[1] - margin : 0;
	f.width = (x1 < v->width ? x1 : v->width) - f.x0;
	f.height = (y1 < v->height ? y1 : v->height) - f.y0;
	size_t n = (size_t)f.width * (size_t)f.height;
	f.material = mem_array(n, 1);
	f.cover = mem_array(n, sizeof *f.cover);
	f.depth = mem_array(n, sizeof *f.depth);
	f.distance = mem_array(n, sizeof *f.distance);
	f.nearest = mem_new(n, sizeof *f.nearest);
	long row = (long)v->width * samples;
	for (int y = 0; y < f.height; y++)
		for (int x = 0; x < f.width; x++) {
			const struct portrait_spot *of = spots + (long)(f.y0 + y) * samples * row + (long)(f.x0 + x) * samples;
			long i = (long)y * f.width + x;
			f.material[i] = portrait_material(&f.cover[i], of, row, samples, side);
		}
	portrait_globe_depth(f.depth, p, rays, side, (int[2]){ f.x0, f.y0 }, (int[2]){ f.width, f.height }, (float)away);
	const struct distance_scene scene = { f.width, f.height, f.material, f.cover, f.depth, v->focal_px, { v->center_px[0] - f.x0, v->center_px[1] - f.y0 } };
	distance_band(f.distance, f.nearest, &scene, reach, 0);
	return f;
}

/* Unit, in the globe's tangent plane, away from the lid's edge, to which off[2] leads from (x, y), one px long. px_mm: out, what that px is there. */
static bool away(float out[3], float *px_mm, const struct portrait_rays *rays, const float at[3], const float n[3], double x, double y, const float off[2])
{
	float dir[3], t = 0, d = 0, len = 0;
	portrait_ray(dir, rays, x + (double)off[0], y + (double)off[1]);
	for (int c = 0; c < 3; c++) {
		t += (at[c] - rays->origin[c]) * n[c];
		d += dir[c] * n[c];
	}
	for (int c = 0; c < 3; c++) {
		out[c] = at[c] - (rays->origin[c] + t / d * dir[c]);
		len += out[c] * out[c];
	}
	len = sqrtf(len);
	for (int c = 0; c < 3; c++)
		out[c] /= len;
	*px_mm = len;
	return d < -0.02f && len > 1e-5f;
}

/* Direction towards the lid, averaged over neighbours: one pixel's own follows every step of the edge. Offsets are summed, so that
 * more distant pixels, whose direction is more exact, weigh more. */
static void towards(float off[2], const struct field *f, int x, int y, int reach)
{
	off[0] = off[1] = 0;
	for (int v = y - reach; v <= y + reach; v++)
		for (int u = x - reach; u <= x + reach; u++) {
			long i = (long)v * f->width + u;
			if (u < 0 || v < 0 || u >= f->width || v >= f->height || f->material[i] != DISTANCE_GLOBE || !isfinite(f->distance[i]))
				continue;
			off[0] += f->nearest[i][0];
			off[1] += f->nearest[i][1];
		}
	float len = sqrtf(off[0] * off[0] + off[1] * off[1]) + 1e-6f;
	off[0] /= len;
	off[1] /= len;
}

/* What a film with that normal reflects towards the camera: the room, or skin that stands before it. */
static void mirrored(float rgb[3], float *fresnel, const struct portrait *p, const struct portrait_rays *rays, const float at[3], const float n[3], const float dir[3])
{
	float c = -(dir[0] * n[0] + dir[1] * n[1] + dir[2] * n[2]), r[3], cam[3] = { 0 };
	for (int i = 0; i < 3; i++)
		r[i] = dir[i] + 2 * c * n[i];
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			cam[k] += (float)rays->rig_from_cam[i][k] * r[i];
	envmap_at(rgb, p->env, cam, (float)TEAR_ROUGH);
	if (ray_blocked(p->shadow, at, r, 0.3f, 60))
		for (int i = 0; i < 3; i++)
			rgb[i] = (float)(TEAR_SKIN * p->conf.skin_rgb[i]);
	*fresnel = portrait_film_share(c);
}

/* The normal of the meniscus at distance d from the lid, between the globe's and the direction away from the lid. */
void portrait_meniscus(float out[3], const float n[3], const float away[3], float d, float height)
{
	float x = 1 - (d > 0 ? d < height ? d : height : 0) / height, c = sqrtf(1 - x * x);  // sine and cosine of its lean
	for (int i = 0; i < 3; i++)
		out[i] = c * n[i] + x * away[i];
}

enum { ACROSS = 12 };

struct wet {
	const struct portrait *p;
	const struct portrait_rays *rays;
	int side;
	float reach;   // of the highest meniscus, in the rig's mm
	float per_mm;  // the camera's unit in one of the rig's
	float pixel;   // mm, where it faces the camera
	float blur;    // mm: half of what a pixel shows aslant, at most
};

/* A pixel that shows the eye, in part at least: of one that is mostly skin what lies between the lid's edge and its other end. */
static void pixel_wet(float *px, const struct wet *w, double x, double y, const struct field *f)
{
	int u = (int)x - f->x0, v = (int)y - f->y0;
	const long i = (long)v * f->width + u;
	const bool edge = f->material[i] == DISTANCE_SKIN;
	float off[2], px_mm, d = edge ? 0 : f->distance[i] / w->per_mm;
	float dir[3], at[3], n[3], out[3], lean[3], rgb[3], fresnel, len = 0;
	portrait_ray(dir, w->rays, x, y);
	float t = portrait_eye_hit(w->p, w->side, w->rays->origin, dir);
	if (!isfinite(t) || d >= w->reach + w->blur)
		return;
	for (int c = 0; c < 3; c++) {
		at[c] = w->rays->origin[c] + t * dir[c];
		n[c] = at[c] - (float)w->p->rig->globe[w->side].center[c];
		len += n[c] * n[c];
	}
	for (int c = 0; c < 3; c++)
		n[c] /= sqrtf(len);
	float height = portrait_lake_height(w->p, w->side, at);
	towards(off, f, u, v, (int)fminf(height / w->pixel, 6) + 1);
	if (!away(out, &px_mm, w->rays, at, n, x, y, off))
		return;
	const float from = edge ? 0 : fmaxf(d - 0.5f * px_mm, 0), to = edge ? (1 - f->cover[i]) * px_mm : d + 0.5f * px_mm;
	if (from >= height)
		return;
	// The meniscus turns by a right angle within a few pixels: a pixel's reflection is the mean over it.
	float sum[3] = { 0 }, through[3] = { 0 }, below[3], cos_i = -(dir[0] * n[0] + dir[1] * n[1] + dir[2] * n[2]);
	for (int k = 0; k < ACROSS; k++) {
		float dk = from + ((float)k + 0.5f) / ACROSS * (to - from), part = 1 - smooth((float)TEAR_END * height, height, dk);
		portrait_meniscus(lean, n, out, dk, height);
		mirrored(rgb, &fresnel, w->p, w->rays, at, lean, dir);
		portrait_lake_light(below, portrait_lake_depth(dk, height), cos_i, w->p->conf.tear_absorb);
		for (int c = 0; c < 3; c++) {
			through[c] += (1 - part * fresnel) * below[c] / ACROSS;
			sum[c] += w->p->matte ? 0 : part * fresnel * rgb[c] / ACROSS;
		}
	}
	for (int c = 0; c < 3; c++)
		px[c] = px[c] * through[c] + sum[c];
}

void portrait_tears(struct image out[2], int at[2][2], const struct portrait *p, const struct portrait_view *v, const struct portrait_spot *spots,
                    int samples)
{
	struct portrait_rays rays = portrait_rays_of(v);
	double scale = sqrt(v->cam_from_target[0][0] * v->cam_from_target[0][0] + v->cam_from_target[0][1] * v->cam_from_target[0][1]
	                    + v->cam_from_target[0][2] * v->cam_from_target[0][2]);
	for (int side = 0; side < 2; side++) {
		struct image *eye = &out[side];
		if (!eye->px || !(p->conf.tear_mm > 0))
			continue;
		struct wet wet = { p, &rays, side, (float)(p->conf.tear_mm * (1 + LAKE_RISE)), (float)scale, 0, 0 };
		double away = v->cam_from_target[2][3];
		for (int c = 0; c < 3; c++)
			away += v->cam_from_target[2][c] * p->rig->globe[side].center[c];
		wet.pixel = (float)(away / (v->focal_px * scale));
		wet.blur = 2 * wet.pixel;
		struct field f = field_make(p, v, spots, samples, side, eye, at[side], (double)(wet.reach + wet.blur) * scale, away, &rays);
#pragma omp parallel for schedule(dynamic, 8)
		for (int y = 0; y < eye->height; y++)
			for (int x = 0; x < eye->width; x++) {
				long i = (long)(at[side][1] + y - f.y0) * f.width + at[side][0] + x - f.x0;
				if (f.material[i] == DISTANCE_GLOBE ? isfinite(f.distance[i]) : f.material[i] == DISTANCE_SKIN && f.cover[i] < 1)
					pixel_wet(image_at(eye, x, y), &wet, at[side][0] + x + 0.5, at[side][1] + y + 0.5, &f);
			}
		field_free(&f);
	}
}
