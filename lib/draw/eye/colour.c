/* The albedo step. The fitted model knows a handful of numbers; the photograph shows every fibre. So the photograph's
 * colour is kept for each texel, and beside it what the model shows there in the light of the photograph, seen from its
 * camera. Elsewhere, and in other light, the iris shows the photograph's colour times what the model changes by:
 *     colour = gain model (texture / (gain model_of_photograph))^detail
 * Where the model is dark its channels change by wildly different factors; they are held within CHROMA of their mean, for
 * what the photograph cannot have shown in such a texel must not turn into colour. */
#include "draw/eye/impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "optics/lightpath/lightpath.h"

/* What the model shows at n texels of row y, seen through the cornea from C. */
static void model_row(struct iris_batch *b, const struct scene *s, const struct scene_level *level, int x0, int n, int y,
                      const double C[3], const struct scene_beams *beams)
{
	float k[3][BATCH], gx, gy;
	b->n = n;
	for (int i = 0; i < n; i++) {
		b->px[i] = ((float)(x0 + i) + 0.5f) / level->per_mm - (float)s->extent;
		b->py[i] = ((float)y + 0.5f) / level->per_mm - (float)s->extent;
		b->pz[i] = (float)s->eye.iris_depth
		           - relief_at(level->relief, level->n, level->per_mm, b->px[i], b->py[i], &gx, &gy);
	}
	lightpath_batch_point(n, b->px, b->py, b->pz, C, k[0], k[1], k[2], 0, &s->cornea, 4);
	for (int i = 0; i < n; i++) {
		float d[3] = { b->px[i] - k[0][i], b->py[i] - k[1][i], b->pz[i] - k[2][i] };
		float len = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		bool good = len > 0.1f && d[2] > 0.2f * len;  // else straight down: nobody sees it
		b->vx[i] = good ? d[0] / len : 0;
		b->vy[i] = good ? d[1] / len : 0;
		b->vz[i] = good ? d[2] / len : 1;
	}
	scene_scatter(b, s, level, beams);
}

/* The cornea lets less light out towards its edge; the texture has that in it, the model not. Seen head-on it is 2 %
 * less everywhere, which is what is put back here. */
static const float through = 0.98f;

/* The texture was read off the iris plane; a point of the relief lies before it, and the same ray of sight meets the
 * plane a little further on. That is where the photograph shows the point. */
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
		for (int c = 0; c < 3; c++) {
			if (!(mod[c] > SCENE_DARK))  // unlit: it says nothing of how bright the model is
				continue;
			double t = log(tex[c]), m = log(mod[c]);
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

/* Added up row by row, whatever the number of threads. */
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
	size_t texels = (size_t)level->n * (size_t)level->n;
	float *texture = level->colour;
	level->colour = mem_array(4 * texels, sizeof *level->colour);
	level->model = mem_array(4 * texels, sizeof *level->model);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < level->n; y++)
		for (int x = 0; x < level->n; x += BATCH) {
			struct iris_batch b;
			long at = 4 * ((long)y * level->n + x);
			model_row(&b, s, level, x, level->n - x < BATCH ? level->n - x : BATCH, y, C, &beams);
			put_row(level->colour + at, level->model + at, texture, &b, s, level);
		}
	free(texture);
	compare(s);
	scene_levels_make(s);
	for (int k = scene_marched(s); k < s->n_levels && s->conf.shading == SCENE_TEXELS; k++)
		scene_shade_model(&s->level[k], s, C, &beams, through);
	free(beams.beam);
}

SIMD_CLONES static void ratio_whole(int n, float *restrict r, float *restrict g, float *restrict b, const float *const per_model[3])
{
	const float most = LOOK_MOST, chroma = LOOK_CHROMA;  // brighter only a texel gets that was in a shadow of the model's
	const float *restrict per_r = per_model[0], *restrict per_g = per_model[1], *restrict per_b = per_model[2];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		// A few wavelengths stand for the spectrum: what light of hardly any colour is left deep in dark tissue they may put below zero.
		float x = (r[i] > 0 ? r[i] : 0) * per_r[i], y = (g[i] > 0 ? g[i] : 0) * per_g[i], z = (b[i] > 0 ? b[i] : 0) * per_b[i], mean = (x + y + z) * (1 / 3.0f);
		float lit = mean < most ? mean : most, low = lit * (1 / chroma), high = lit * chroma, k = mean > 1e-6f ? lit / mean : 1;
		x *= k;
		y *= k;
		z *= k;
		r[i] = x > low ? x < high ? x : high : low;
		g[i] = y > low ? y < high ? y : high : low;
		b[i] = z > low ? z < high ? z : high : low;
	}
}

void scene_colour_ratio(int n, float rgb[3][BATCH], const struct scene *s, const float *const per_model[3])
{
	float d = (float)s->conf.detail, alone[3][BATCH];
	for (int c = 0; c < 3 && d < 1; c++)
		for (int i = 0; i < n; i++)
			alone[c][i] = s->gain * rgb[c][i];
	ratio_whole(n, rgb[0], rgb[1], rgb[2], per_model);
	for (int c = 0; c < 3 && d < 1; c++)
		for (int i = 0; i < n; i++)
			rgb[c][i] = alone[c][i] > 0 && rgb[c][i] > 0 ? powf(rgb[c][i], d) * powf(alone[c][i], 1 - d) : 0;
}

void scene_colour(float rgb[3], const struct scene *s, const struct scene_level *level, float x, float y)
{
	float per[3], ratio[3][BATCH], d = (float)s->conf.detail;
	if (!level->model)
		return;
	for (int c = 0; c < 3; c++) {
		per[c] = 1 / channel_at(level->model, level->n, level->per_mm, x, y, 4, c);
		ratio[c][0] = rgb[c];
	}
	scene_colour_ratio(1, ratio, s, (const float *const[3]){ &per[0], &per[1], &per[2] });
	for (int c = 0; c < 3; c++) {
		float shown = channel_at(level->colour, level->n, level->per_mm, x, y, 4, c);
		rgb[c] = ratio[c][0] * (d == 1 ? shown : shown > 0 ? powf(shown, d) : 0);
	}
}
