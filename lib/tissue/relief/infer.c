#include "tissue/relief/infer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "tissue/light/iris_light.h"
#include "tissue/relief/infer_impl.h"
#include "tissue/spread.h"

enum { GRID_MAX = 640, RINGS = 64 };

static void grid_free(struct infer_grid *g)
{
	float *maps[] = { g->course, g->weight, g->off, g->tint, g->precise, g->scratch[0], g->scratch[1], g->scratch[2], g->scratch[3] };
	for (int i = 0; i < COUNT(maps); i++)
		free(maps[i]);
	shading_free(&g->shading);
	free(g);
}

static struct infer_grid *grid_new(double extent, const struct infer_conf *conf)
{
	const double pitch = 1.25;  // of the finest Gaussian
	struct infer_grid *g = mem_new(1, sizeof *g);
	g->n = (int)fmin(fmax(round(2 * extent / (pitch * conf->finest)), 48), GRID_MAX);
	g->scale = g->n / (2 * extent);
	g->conf = conf;
	for (int b = 0; b <= B; b++)
		g->sigma[b] = conf->finest * g->scale * (1 << b);
	float **maps[] = { &g->course, &g->weight, &g->off, &g->tint, &g->precise, &g->scratch[0], &g->scratch[1], &g->scratch[2], &g->scratch[3] };
	for (int i = 0; i < COUNT(maps); i++)
		*maps[i] = mem_array((size_t)infer_texels(g), sizeof(float));
	return g;
}

/* A place of the grid, in mm; its iris_share. */
static double share_at(const struct infer_grid *g, long i, double extent, const struct pupil *pupil, double root)
{
	double x = (2 * ((double)(i % g->n) + 0.5) / g->n - 1) * extent, y = (2 * ((double)(i / g->n) + 0.5) / g->n - 1) * extent;
	return iris_share(pupil, root, x, y);
}

/* The thickness' mean over circles round the pupil, ln. */
static bool set_course(struct infer_grid *g, const struct image *thickness, double extent, const struct pupil *pupil, double root, struct err *err)
{
	double sum[RINGS + 1] = { 0 }, all[RINGS + 1] = { 0 };
	long full = (long)thickness->width * thickness->height;
	float *one = mem_array((size_t)full, sizeof *one), *small = g->scratch[0];
	for (long i = 0; i < full; i++)
		one[i] = logf(fmaxf(thickness->px[i * thickness->channels], 1e-3f));
	bool ok = cv_resize(small, g->n, g->n, one, thickness->width, thickness->height, 1, err);
	free(one);
	for (int turn = 0; ok && turn < 2; turn++)
		for (long i = 0; i < infer_texels(g); i++) {
			double at = fmin(fmax(share_at(g, i, extent, pupil, root), 0), 1) * RINGS;
			int k = at < RINGS - 1 ? (int)at : RINGS - 1;
			double t = at - k;
			if (turn) {
				double a = sum[k] / fmax(all[k], 1e-9), b = sum[k + 1] / fmax(all[k + 1], 1e-9);
				g->course[i] = (float)(all[k] > 0 ? all[k + 1] > 0 ? (1 - t) * a + t * b : a : b);
				continue;
			}
			sum[k] += (1 - t) * (double)small[i];
			sum[k + 1] += t * (double)small[i];
			all[k] += 1 - t;
			all[k + 1] += t;
		}
	return ok;
}

/* How the operator stands at each texel, the ln luminance of the course under its light in `off`, and in `tint` what the light's spreading changes
 * of that: beside an edge of the light tissue is lit from beside. */
static bool predict(struct infer_grid *g, const struct relief_table *table, const struct image *light, struct err *err)
{
	float *slope = g->scratch[1], *bare = g->scratch[3], *lit_up = g->precise, *smooth = g->scratch[2], *shade = g->scratch[3];
	for (long i = 0; i < infer_texels(g); i++) {
		double u = ((double)(i % g->n) + 0.5) / g->n * light->width, v = ((double)(i / g->n) + 0.5) / g->n * light->height, lit[IRIS_LIT];
		for (int c = 0; c < IRIS_LIT; c++)
			lit[c] = (double)image_sample(light, u, v, c);
		shading_slants(g->shading.slant[i], g->scale, lit + 4, lit + 6);
		bare[i] = (float)fmax(0.2126 * lit[0] + 0.7152 * lit[1] + 0.0722 * lit[2], 1e-4);
	}
	memcpy(smooth, g->course, (size_t)infer_texels(g) * sizeof *smooth);
	memcpy(lit_up, bare, (size_t)infer_texels(g) * sizeof *lit_up);
	if (!tissue_spread_map(smooth, g->n, 1, g->shading.spread * g->scale, err) || !tissue_spread_map(lit_up, g->n, 1, g->shading.spread * g->scale, err))
		return false;
	for (long i = 0; i < infer_texels(g); i++) {
		float f;
		int k = relief_place(table, smooth[i], &f);
		float here = fmaxf(table->light[k] + f * (table->light[k + 1] - table->light[k]), 1e-6f);
		float lit = fmaxf(lit_up[i], 1e-4f);
		g->off[i] = logf(here * lit);
		g->tint[i] = logf(lit / bare[i]);
		slope[i] = (table->slope[k] + f * (table->slope[k + 1] - table->slope[k])) / here;
		g->shading.thick[i] = 1;  // the course itself shades as a height, not by its logarithm
		g->shading.alpha[i] = 0;
		smooth[i] = expf(g->course[i]);
	}
	shading_apply(shade, smooth, &g->shading);
	for (long i = 0; i < infer_texels(g); i++) {
		g->off[i] += shade[i];
		g->shading.thick[i] = smooth[i];
		g->shading.alpha[i] = slope[i];
	}
	return true;
}

/* What the photograph shows beyond that, and its tint. Returns the number of texels seen; -1, err set, where OpenCV fails. */
static long look(struct infer_grid *g, const struct image *clean, double extent, const struct pupil *pupil, double root, struct err *err)
{
	long seen = 0;
	struct image small = image_new(g->n, g->n, 4);
	if (!cv_resize(small.px, g->n, g->n, clean->px, clean->width, clean->height, 4, err)) {
		image_free(&small);
		return -1;
	}
	for (long i = 0; i < infer_texels(g); i++) {
		const float *c = small.px + 4 * i;
		double share = share_at(g, i, extent, pupil, root);
		float light = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
		bool use = share > 0.03 && share < 0.95 && c[3] > 0.1f && light > 1e-5f && g->precise[i] > 0.01f;
		g->weight[i] = use ? fminf(c[3], 1) : 0;
		g->off[i] = use ? logf(light) - g->off[i] : 0;
		g->tint[i] = use ? logf(fmaxf(c[0], 1e-5f) / fmaxf(c[2], 1e-5f)) : 0;
		seen += use;
	}
	image_free(&small);
	return seen;
}

/* Thickness and its sigma at the texture's resolution. */
static bool compose(struct image *out, const float *relief, const float *sigma, struct infer_grid *g, int size, const struct relief_conf *c, struct err *err)
{
	struct image small = image_new(g->n, g->n, 2);
	*out = image_new(size, size, 2);
	for (long i = 0; i < infer_texels(g); i++) {
		small.px[2 * i] = g->course[i] + relief[i];
		small.px[2 * i + 1] = sigma[i];
	}
	// Between texels of the fit the heights are smooth: their slopes are what shows.
	bool ok = cv_resize(out->px, size, size, small.px, g->n, g->n, 2, err) && (size <= g->n || cv_blur(out->px, out->px, size, size, 2, 0.5 * size / g->n, err));
	for (long i = 0; ok && i < (long)size * size; i++) {
		float mm = fminf(fmaxf(expf(out->px[2 * i]), (float)c->low), (float)c->high);
		out->px[2 * i] = mm;
		out->px[2 * i + 1] *= mm;
	}
	image_free(&small);
	if (!ok)
		image_free(out);
	return ok;
}

static void set_optics(struct infer_grid *g, const double x[PIGMENT_N], const struct pigment_conf *pigment)
{
	const double middle = 0.45;  // mm: of irises
	struct tissue tissue = pigment_tissue(x, pigment);
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, pigment->bands, pigment->illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	shading_make(&g->shading, g->n, g->scale, &tissue, &optics, middle, pigment->cos_view, pigment->cos_light);
}

bool relief_infer(struct image *out, struct infer_fit *fit, const struct image *clean, const struct image *thickness, const struct image *light,
                  double extent, const struct pupil *pupil, double root, const double white[3], const double x[PIGMENT_N],
                  const struct pigment_conf *pigment, const struct relief_conf *relief, const struct infer_conf *conf, struct err *err)
{
	struct infer_grid *g = grid_new(extent, conf);
	size_t n = (size_t)infer_texels(g);
	float *map = mem_new(n, sizeof *map), *sigma = mem_new(n, sizeof *sigma), *variance = mem_array(n, sizeof *variance);
	struct relief_table table;
	*fit = (struct infer_fit){ 0 };
	set_optics(g, x, pigment);
	relief_table_make(&table, relief->low, relief->high, white, x, pigment);
	struct infer_colour colour = infer_colour_of(white, x, pigment, relief, &table);
	bool ok = set_course(g, thickness, extent, pupil, root, err) && predict(g, &table, light, err);
	memcpy(sigma, g->tint, n * sizeof *sigma);  // what spreading changes at edges of the light, until it is solved for
	long seen = ok ? look(g, clean, extent, pupil, root, err) : 0;
	ok = ok && seen >= 0 && (seen >= 100 || err_set(err, "iris texture: %ld texels were seen: too few for its relief", seen));
	ok = ok && infer_measure(fit, variance, g, &colour, sigma, err);
	if (ok)
		infer_solve(map, sigma, fit, g, variance);
	ok = ok && compose(out, map, sigma, g, clean->width, relief, err);
	free(map);
	free(sigma);
	free(variance);
	grid_free(g);
	return ok;
}
