/* The albedo step. The fitted model knows a handful of numbers; the photograph shows every fibre. What the photograph
 * shows beyond the model becomes a factor on the model's colour, texel by texel: texture over model, the model marched
 * with the light and from the place of the photograph itself, so that relief, shadow and refraction are not counted
 * twice. conf.detail raises the factor to a power: 1 shows the photographed eye, 0 the model. */
#include "eye/scene_impl.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath.h"

/* Beyond these a factor says that the model is wrong there (a lash, a reflection), not what colour the iris has. */
static const float least = 1 / 12.0f, most = 12;

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

struct fit_sums {
	double n, log_tex, log_mod, tt, mm, tm;
};

/* Sums over a row where a photograph saw the iris; the row's texels become texture over model. */
static void factor_row(struct fit_sums *sum, float *texel, const struct iris_batch *b, const struct scene *s)
{
	for (int i = 0; i < b->n; i++, texel += 4) {
		float dx = b->px[i] - (float)s->pupil[0], dy = b->py[i] - (float)s->pupil[1], r = sqrtf(b->px[i] * b->px[i] + b->py[i] * b->py[i]);
		bool counts = texel[3] > 0.5f && sqrtf(dx * dx + dy * dy) > s->pupil[2] + 0.15 && r < 0.92f * (float)s->limbus[0];
		for (int c = 0; c < 3; c++) {
			float model = b->rgb[c][i] * through, tex = texel[c] > 1e-4f ? texel[c] : 1e-4f;
			model = model > 1e-4f ? model : 1e-4f;
			if (counts) {
				double t = log(tex), m = log(model);
				sum->n++;
				sum->log_tex += t;
				sum->log_mod += m;
				sum->tt += t * t;
				sum->mm += m * m;
				sum->tm += t * m;
			}
			texel[c] = tex / model;
		}
	}
}

static void finish(struct scene *s, const struct fit_sums *f)
{
	const struct scene_level *level = &s->level[0];
	double n = f->n > 0 ? f->n : 1, mean = (f->log_tex - f->log_mod) / n;
	double vt = f->tt - f->log_tex * f->log_tex / n, vm = f->mm - f->log_mod * f->log_mod / n;
	double cov = f->tm - f->log_tex * f->log_mod / n;
	s->gain = f->n > 0 ? (float)exp(mean) : 1;
	s->explained = vt > 0 ? 1 - (vt + vm - 2 * cov) / vt : 0;
	float power = (float)s->conf.detail;
	long texels = (long)level->n * level->n;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < texels; i++)
		for (int c = 0; c < 3; c++) {
			float k = level->colour[4 * i + c] / s->gain;
			k = k > least ? k < most ? k : most : least;
			level->colour[4 * i + c] = s->gain * (power == 1 ? k : powf(k, power));
		}
}

void scene_fit_colour(struct scene *s, const struct scene_view *view, const struct scene_lighting *light)
{
	const struct scene_level *level = &s->level[0];
	double eye_from_cam[3][3], C[3] = { 0 };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			eye_from_cam[j][i] = view->cam_from_eye[i][j];
			C[j] -= view->cam_from_eye[i][j] * view->cam_from_eye[i][3];
		}
	struct scene_beams beams = scene_beams(s, light, eye_from_cam);
	struct fit_sums *row = mem_new((size_t)level->n, sizeof *row), sum = { 0 };
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < level->n; y++)
		for (int x = 0; x < level->n; x += BATCH) {
			struct iris_batch b;
			int n = level->n - x < BATCH ? level->n - x : BATCH;
			model_row(&b, s, level, x, n, y, C, &beams);
			factor_row(&row[y], level->colour + 4 * ((long)y * level->n + x), &b, s);
		}
	for (int y = 0; y < level->n; y++) {  // in this order, whatever the number of threads
		sum.n += row[y].n;
		sum.log_tex += row[y].log_tex;
		sum.log_mod += row[y].log_mod;
		sum.tt += row[y].tt;
		sum.mm += row[y].mm;
		sum.tm += row[y].tm;
	}
	free(row);
	free(beams.beam);
	finish(s, &sum);
	scene_levels_make(s);
}
