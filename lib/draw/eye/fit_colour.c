/* The albedo step. The fitted model has a handful of parameters; the photograph shows every fibre. So each texel keeps the
 * photograph's colour, and beside it the colour of the model in the light and view of the photograph. In any other light
 * and view the iris shows the photograph's colour times the ratio by which the model's colour changes:
 *     colour = gain tint model (texture / (gain tint model_of_photograph))^detail
 * with tint what the map of melanin and the error of the photograph's white make of the model's colour (tint.h), and the texture's colours over
 * that white.
 * Where the model is dark its channels change by very different factors; they are clamped to within conf.ratio_chroma of their mean,
 * so that noise of dark texels does not turn into colour. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/colour.h"
#include "draw/eye/levels.h"
#include "draw/eye/march/march.h"
#include "draw/eye/march/shade.h"
#include "draw/eye/own_light.h"
#include "draw/eye/rim_edge.h"
#include "draw/eye/tint.h"
#include "draw/eye/view.h"

/* Transmittance of the cornea for light on its way out. The texture contains this loss, which grows towards the edge; the model
 * does not. Seen head-on it is 2 % everywhere: that part is applied here. */
static const float through = 0.98f;

/* The texture was sampled on the iris plane. A point of the relief lies in front of that plane, and its ray of sight meets the plane
 * a little further on: there the texture shows the point. */
static void put_row(float *colour, float *model, const float *texture, const struct iris_batch *b, const struct scene *s,
                    const struct scene_level *level)
{
	for (int i = 0; i < b->n; i++, colour += 4, model += 4) {
		float t = ((float)s->eye.iris_depth - b->pz[i]) / b->vz[i];
		for (int c = 0; c < 4; c++)
			colour[c] = channel_at(texture, level->n, level->per_mm, b->px[i] + t * b->vx[i], b->py[i] + t * b->vy[i], 4, c);
		for (int c = 0; c < 3; c++) {
			colour[c] = colour[c] > SCENE_DARK ? colour[c] : SCENE_DARK;
			model[c] = b->rgb[c][i] * through > SCENE_DARK ? b->rgb[c][i] * through : SCENE_DARK;
		}
		model[3] = 0;
	}
}

struct fit_sums {
	double n, tex, mod, tt, mm, tm;
};

/* Sums of logarithms over a row, where a photograph saw the iris. */
static struct fit_sums sums_row(const struct scene *s, int y)
{
	const struct scene_level *level = &s->level[0];
	struct fit_sums f = { 0 };
	for (int x = 0; x < level->n; x++) {
		const float *tex = level->colour + 4 * ((long)y * level->n + x), *mod = level->model + 4 * ((long)y * level->n + x);
		double u = (x + 0.5) / level->per_mm - s->extent, v = (y + 0.5) / level->per_mm - s->extent;
		if (tex[3] < 0.5f || hypot(u - s->pupil[0], v - s->pupil[1]) < s->pupil[2] + 0.15 || hypot(u, v) > 0.92 * s->limbus[0])
			continue;
		float tint[3];
		scene_tint_at(tint, s, (float)u, (float)v);
		for (int c = 0; c < 3; c++) {
			if (!(mod[c] > SCENE_DARK))  // unlit: no information on the model's brightness
				continue;
			double t = log(tex[c]), m = log(mod[c] * tint[c]);
			f.n++;
			f.tex += t;
			f.mod += m;
			f.tt += t * t;
			f.mm += m * m;
			f.tm += t * m;
		}
	}
	return f;
}

/* Sets gain and explained from the sums of all rows, added in a fixed order, so that threads change nothing. */
static void compare(struct scene *s)
{
	int n = s->level[0].n;
	struct fit_sums *row = mem_new((size_t)n, sizeof *row), f = { 0 };
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < n; y++)
		row[y] = sums_row(s, y);
	for (int y = 0; y < n; y++) {
		f.n += row[y].n;
		f.tex += row[y].tex;
		f.mod += row[y].mod;
		f.tt += row[y].tt;
		f.mm += row[y].mm;
		f.tm += row[y].tm;
	}
	free(row);
	if (!(f.n > 0))
		return;
	double vt = f.tt - f.tex * f.tex / f.n, vm = f.mm - f.mod * f.mod / f.n, cov = f.tm - f.tex * f.mod / f.n;
	s->gain = (float)exp((f.tex - f.mod) / f.n);
	s->explained = vt > 0 ? 1 - (vt + vm - 2 * cov) / vt : 0;
}

void scene_fit_colour(struct scene *s, const struct scene_view *view, const struct scene_lighting *light)
{
	struct scene_level *level = &s->level[0];
	double eye_from_cam[3][3], C[3] = { 0 };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			eye_from_cam[j][i] = view->cam_from_eye[i][j];
			C[j] -= view->cam_from_eye[i][j] * view->cam_from_eye[i][3];
		}
	struct scene_beams beams = scene_beams(s, light, eye_from_cam);
	if (!s->plain)  // colours that are painted tell of no shadow
		scene_rim_edge_fit(s, level->colour, C, &beams);
	size_t texels = (size_t)level->n * (size_t)level->n;
	float *texture = level->colour;
	level->colour = mem_array(4 * texels, sizeof *level->colour);
	level->model = mem_array(4 * texels, sizeof *level->model);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < level->n; y++)
		for (int x = 0; x < level->n; x += BATCH) {
			struct iris_batch b;
			long at = 4 * ((long)y * level->n + x);
			scene_model_row(&b, s, level, x, level->n - x < BATCH ? level->n - x : BATCH, y, C, &beams);
			put_row(level->colour + at, level->model + at, texture, &b, s, level);
		}
	free(texture);
	compare(s);
	scene_own_light_make(s, &beams);
	scene_levels_make(s);
	for (int k = scene_marched(s); k < s->n_levels && s->conf.shading == SCENE_TEXELS; k++)
		scene_shade_model(&s->level[k], s, C, &beams, through);
	scene_beams_free(&beams);
}
