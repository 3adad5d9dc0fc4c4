/* Algorithm 1 (rig/deform/deform.h) for the page's shader (render/viewer/pose.glsl): numbers as floats, in the rig's own axes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/web/base64.h"
#include "draw/web/face_impl.h"
#include "draw/web/field.h"
#include "draw/web/packed.h"
#include "rig/deform/terms.h"

/* Floats of a vertex and of a hair's vertex, in the order in which pose.glsl reads them. */
enum { TERMS = 12 + RIG_BASIS, PIN = 12 };
_Static_assert(RIG_COMPONENTS == 8, "pose.glsl has two vectors of components");

/* x[n][columns], which it frees. */
static json_t *floats(float *x, long n, size_t columns)
{
	json_t *out = packed_json(x, (size_t)n * columns * sizeof *x, columns * sizeof *x, columns * sizeof *x);
	free(x);
	return out;
}

/* Numbers in mm, px[height][width][channels], of which neighbours differ little: {step, bytes}. */
static json_t *packed(const float *px, int width, int height, int channels)
{
	size_t size;
	double step;
	uint8_t *bytes = field_encode(&size, &step, px, width, height, channels);
	json_t *out = json_pack("{s:f,s:o}", "step", step, "bytes", base64_json(bytes, size));
	free(bytes);
	return out;
}

static void terms(float to[TERMS], const struct web_face *f, int i)
{
	const struct rig *rig = f->rig;
	struct deform_terms t;
	bool moves = deform_terms_moves(rig, i);
	deform_terms_of(&t, rig, i);
	const float *at = moves ? t.offset : rig->rest[i];
	float all[12] = { t.mean[0], t.mean[1], rig->thickness[i], rig->gap[i], rig->glue[i], rig->side[i], moves, 0, at[0], at[1], at[2], (float)f->settled_as[i] };
	memcpy(to, all, sizeof all);
	memcpy(to + COUNT(all), t.basis, sizeof t.basis);
}

/* Upper bound of the part of the skull's map (texels: x0, y0, x1, y1) over which the page's controls can move the vertices. */
static void reach_on_map(int box[4], const struct web_face *f)
{
	const struct rig *rig = f->rig;
	const struct skull_map *map = &rig->skull;
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY }, e[RIG_COMPONENTS][2];
	for (int k = 0; k < RIG_COMPONENTS; k++) {
		const double *row = rig->W + k * (rig->n_inputs + 1);
		e[k][0] = e[k][1] = row[rig->n_inputs];
		for (int i = 0; i < rig->n_inputs; i++) {
			bool expression = i >= SKIN_EYE_INPUTS, lids = !expression && i % 5 >= 3;
			double from = expression ? 0 : lids ? -0.5 : -45, to = expression ? 1.2 : lids ? 2 : 45;
			double full = row[i];  // with all of what lids do with the expression
			for (int lid = 0; lid < EXPRESS_LIDS && expression; lid++)
				full += row[lid / 2 * 5 + 3 + lid % 2] * rig->expression[i - SKIN_EYE_INPUTS][lid];
			e[k][0] += fmin(fmin(row[i] * from, row[i] * to), full * to);
			e[k][1] += fmax(fmax(row[i] * from, row[i] * to), full * to);
		}
	}
	for (int i = 0; i < f->level[0].posed; i++) {
		struct deform_terms t;
		deform_terms_of(&t, rig, f->order[i]);
		for (int c = 0; c < 2; c++) {
			double from = t.mean[c], to = t.mean[c];
			for (int k = 0; k < RIG_COMPONENTS; k++) {
				double b = t.basis[c * RIG_COMPONENTS + k];
				from += fmin(b * e[k][0], b * e[k][1]);
				to += fmax(b * e[k][0], b * e[k][1]);
			}
			low[c] = fmin(low[c], from);
			high[c] = fmax(high[c], to);
		}
	}
	const double origin[2] = { map->x0, map->y0 };
	const int size[2] = { map->width, map->height };
	for (int c = 0; c < 2; c++) {
		box[c] = (int)fmin(fmax(floor((low[c] - origin[c]) / map->step) - 1, 0), size[c] - 2);
		box[2 + c] = (int)fmin(fmax(ceil((high[c] - origin[c]) / map->step) + 2, box[c] + 2), size[c]);
	}
}

static json_t *skull(const struct web_face *f)
{
	const struct skull_map *map = &f->rig->skull;
	int box[4];
	reach_on_map(box, f);
	int width = box[2] - box[0], height = box[3] - box[1];
	float *px = mem_array((size_t)width * (size_t)height * 3 + 1, sizeof *px);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			memcpy(px + 3 * ((long)y * width + x), map->texel + SKULL_CHANNELS * ((long)(box[1] + y) * map->width + box[0] + x), 3 * sizeof *px);
	double grid[] = { map->x0, map->y0, map->step, map->width, map->height }, part[] = { box[0], box[1], width, height };
	json_t *mm = packed(px, width, height, 3);
	free(px);
	return json_pack("{s:o,s:o,s:o}", "grid", json_numbers(COUNT(grid), grid), "part", json_numbers(COUNT(part), part), "mm", mm);
}

static json_t *globe_maps(const struct rig *rig)
{
	int n = rig->globe[0].map.n;
	long size = (long)(n + 1) * (n + 1);
	float *mm = mem_array(2 * (size_t)size, sizeof *mm);
	for (int s = 0; s < 2; s++)
		memcpy(mm + s * size, rig->globe[s].map.radius, (size_t)size * sizeof *mm);
	json_t *field = packed(mm, n + 1, 2 * (n + 1), 1);
	free(mm);
	return json_pack("{s:i,s:o,s:[o,o]}", "cells", n, "mm", field, "centers", json_numbers(3, rig->globe[0].center), json_numbers(3, rig->globe[1].center));
}

static json_t *hairs(const struct web_face *f)
{
	int n = f->n_shown - f->first_hair;
	float *pins = mem_new((size_t)n * PIN + 1, sizeof *pins);
	for (int i = 0; i < n; i++) {
		struct portrait_pin pin;
		portrait_lash_pin(&pin, f->portrait, f->order[f->first_hair + i]);
		float *to = pins + (long)i * PIN;
		for (int k = 0; k < 3; k++) {
			to[k] = (float)f->place[pin.vertex[k]];
			to[4 + k] = pin.weight[k];
			to[8 + k] = pin.local[k];
		}
		to[3] = (float)pin.side;
	}
	return floats(pins, n, PIN);
}

static json_t *between(const struct web_face *f)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	int first = f->level[0].end, n = f->first_hair - first;
	float *ends = mem_new((size_t)n * 2 + 1, sizeof *ends);
	for (int i = 0; i < 2 * n; i++)
		ends[i] = (float)f->place[m->between[f->order[first + i / 2] - m->n_base][i % 2]];
	return floats(ends, n, 2);
}

/* The gazes at which lids are known (model/known.h). */
static json_t *known(const struct known *k)
{
	return json_pack("{s:[o,o],s:o,s:f}", "corner", json_numbers(2 * KNOWN_CORNERS, &k->corner[0][0][0]), json_numbers(2 * KNOWN_CORNERS, &k->corner[1][0][0]),
	                 "torsion", json_numbers(4, &k->torsion[0][0]), "beyond", k->beyond);
}

void web_put_rig(json_t *out, const struct web_face *f)
{
	const struct rig *rig = f->rig;
	int n = f->level[0].end, posed = f->level[0].posed;
	json_t *levels = json_array(), *baseline = json_array(), *expressions = json_array();
	float *of = mem_new((size_t)posed * TERMS + 1, sizeof *of), *rest = mem_new((size_t)n * 3 + 1, sizeof *rest);
	for (int i = 0; i < n; i++) {
		if (i < posed)
			terms(of + (long)i * TERMS, f, f->order[i]);
		memcpy(rest + 3L * i, rig->rest[f->order[i]], 3 * sizeof *rest);
	}
	for (int k = 0; k < f->n_levels; k++)
		json_array_append_new(levels, json_pack("[i,i,i]", f->level[k].first, f->level[k].posed, f->level[k].end));
	for (int k = 0; k < 4; k++)
		json_array_append_new(baseline, json_numbers(3, rig->baseline[k]));
	for (int k = 0; k < rig->n_inputs - SKIN_EYE_INPUTS; k++)
		json_array_append_new(expressions, json_numbers(EXPRESS_LIDS, rig->expression[k]));
	json_object_set_new(out, "rig", json_pack("{s:i,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "inputs", rig->n_inputs, "expression_lids", expressions, "aperture_px", json_numbers(EXPRESS_LIDS, rig->aperture_px), "known", known(&rig->known),
	    "W", json_numbers(RIG_COMPONENTS * (rig->n_inputs + 1), rig->W), "baseline", baseline, "head_from_rig", json_numbers(9, &rig->head_from_target[0][0]),
	    "middle", json_numbers(3, f->middle), "levels", levels, "rows", packed_json(f->order, (size_t)n * sizeof *f->order, sizeof *f->order, sizeof *f->order), "rest", floats(rest, n, 3),
	    "terms", floats(of, posed, TERMS), "ring", packed_json(f->ring, (size_t)f->n_ring * sizeof *f->ring, sizeof *f->ring, sizeof *f->ring), "between", between(f),
	    "hairs", hairs(f), "skull", skull(f), "globe", globe_maps(rig)));
}
