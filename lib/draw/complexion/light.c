/* The light on a face, and the skin without it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "math/stats.h"
#include "math/vec.h"
#include "mesh/ray.h"

enum { RAYS = 192, ROUNDS = 12, SAMPLES = 30000, LEAST = 2000 };
static const double off_ln = 0.12;        // Cauchy's scale of what is not light: blotches, hairs, gloss
static const double shade_least = 0.25;   // of the median light: darker places would turn noise into skin
static const double same_shape = 0.02;    // weight of the prior that red and blue light fall as green does
static const float reach_mm = 150, lift_mm = 0.4f;

static void harmonics(double y[HARMONICS], const double d[3])
{
	const double x = d[0], v = d[1], z = d[2];
	const double all[HARMONICS] = { 0.282095, 0.488603 * v, 0.488603 * z, 0.488603 * x, 1.092548 * x * v, 1.092548 * v * z,
		                            0.315392 * (3 * z * z - 1), 1.092548 * x * z, 0.546274 * (x * x - v * v) };
	memcpy(y, all, sizeof all);
}

/* Mean of each harmonic over the directions that a point sees, weighted by the cosine to its normal. scene: null: it sees all. */
static void transfer(double t[HARMONICS], const float x[3], const float normal[3], const struct ray_scene *scene)
{
	const double n[3] = { (double)normal[0], (double)normal[1], (double)normal[2] };
	double u[3], w[3];
	memset(t, 0, HARMONICS * sizeof *t);
	vec_cross(u, n, fabs(n[0]) < 0.6 ? (double[]){ 1, 0, 0 } : (double[]){ 0, 1, 0 });
	vec_unit(u, u);
	vec_cross(w, n, u);
	for (int k = 0; k < RAYS; k++) {
		const double r = sqrt((k + 0.5) / RAYS), turn = 2.399963229728653 * k, up = sqrt(1 - r * r);
		double d[3], y[HARMONICS];
		float from[3], dir[3];
		for (int c = 0; c < 3; c++) {
			d[c] = r * cos(turn) * u[c] + r * sin(turn) * w[c] + up * n[c];
			from[c] = x[c] + lift_mm * normal[c];
			dir[c] = (float)d[c];
		}
		if (scene && ray_blocked(scene, from, dir, 0.05f, reach_mm))
			continue;
		harmonics(y, d);
		for (int i = 0; i < HARMONICS; i++)
			t[i] += y[i] / RAYS;
	}
}

/* Of every vertex of a face that a texel with weight shows. */
static double (*transfers(const struct complexion *c, const float *weight))[HARMONICS]
{
	const struct mesh *m = c->mesh;
	double (*t)[HARMONICS] = mem_new((size_t)m->n_vertices + 1, sizeof *t);
	bool *needed = mem_new((size_t)m->n_vertices + 1, sizeof *needed);
	float (*normal)[3] = mesh_normals(m);
	struct ray_scene *scene = ray_scene_new(m->n_vertices, (const float(*)[3])m->vertices, m->n_faces, (const int32_t(*)[3])m->faces);
	for (long i = 0; i < (long)c->side * c->side; i++)
		for (int k = 0; k < 3 && weight[i] > 0; k++)
			needed[m->faces[c->spot[i].face][k]] = true;
#pragma omp parallel for schedule(dynamic, 16)
	for (int i = 0; i < m->n_vertices; i++)
		if (needed[i])
			transfer(t[i], m->vertices[i], normal[i], scene);
	ray_scene_free(scene);
	free(normal);
	free(needed);
	return t;
}

static void at_texel(double t[HARMONICS], const double (*of)[HARMONICS], const struct complexion *c, long i)
{
	const struct complexion_spot *s = &c->spot[i];
	const int32_t *v = c->mesh->faces[s->face];
	const double w1 = (double)s->w[0], w2 = (double)s->w[1];
	for (int k = 0; k < HARMONICS; k++)
		t[k] = (1 - w1 - w2) * of[v[0]][k] + w1 * of[v[1]][k] + w2 * of[v[2]][k];
}

/* Cholesky; a is overwritten. False: not positive definite. */
static bool solve(double x[HARMONICS], double a[HARMONICS][HARMONICS], const double b[HARMONICS])
{
	for (int i = 0; i < HARMONICS; i++)
		for (int j = 0; j <= i; j++) {
			for (int k = 0; k < j; k++)
				a[i][j] -= a[i][k] * a[j][k];
			if (i == j && !(a[i][i] > 1e-12))
				return false;
			a[i][j] = i == j ? sqrt(a[i][i]) : a[i][j] / a[j][j];
		}
	for (int i = 0; i < HARMONICS; i++) {
		x[i] = b[i];
		for (int k = 0; k < i; k++)
			x[i] -= a[i][k] * x[k];
		x[i] /= a[i][i];
	}
	for (int i = HARMONICS - 1; i >= 0; i--) {
		for (int k = i + 1; k < HARMONICS; k++)
			x[i] -= a[k][i] * x[k];
		x[i] /= a[i][i];
	}
	return true;
}

/* Iteratively reweighted least squares on relative residuals, with a little of a prior for even light: a film shows skin that faces it.
 * about: light of another colour, about_median on the median skin, whose shape this one has but for coloured lamps, which are weak; null: none. */
static bool fit(double light[HARMONICS], int n, const double (*t)[HARMONICS], const double *value, const double *about, double about_median)
{
	double median = 0, *copy = mem_array((size_t)n + 1, sizeof *copy);
	memcpy(copy, value, (size_t)n * sizeof *copy);
	median = stats_median(n, copy);
	free(copy);
	double mean[HARMONICS] = { 0 };
	memset(light, 0, HARMONICS * sizeof *light);
	light[0] = median / (0.282095 * 0.9);
	for (int k = 0; k < HARMONICS && about; k++)
		light[k] = mean[k] = about[k] * median / about_median;
	for (int round = 0; round < ROUNDS; round++) {
		double a[HARMONICS][HARMONICS] = { 0 }, b[HARMONICS] = { 0 };
		for (int i = 0; i < n; i++) {
			double is = 0;
			for (int k = 0; k < HARMONICS; k++)
				is += light[k] * t[i][k];
			is = fmax(is, 0.1 * median);
			const double off = (value[i] - is) / (off_ln * is), w = 1 / ((1 + off * off) * is * is);
			for (int k = 0; k < HARMONICS; k++) {
				b[k] += w * t[i][k] * value[i];
				for (int j = 0; j <= k; j++)
					a[k][j] += w * t[i][k] * t[i][j];
			}
		}
		for (int k = 0; k < HARMONICS; k++) {
			const double prior = (k == 0 ? 1e-6 : about ? same_shape : k < 4 ? 1e-4 : 1e-3) * n / (median * median);
			a[k][k] += prior;
			b[k] += prior * mean[k];
		}
		if (!solve(light, a, b))
			return false;
	}
	return true;
}

bool complexion_unlight(float (*ln)[3], const float *weight, const bool *keep, double shade[3], double from[3], const struct complexion *c)
{
	const long all = (long)c->side * c->side;
	long kept = 0;
	int n = 0;
	for (long i = 0; i < all; i++)
		kept += keep[i];
	if (kept < LEAST)
		return false;
	const long step = kept / SAMPLES + 1;
	double (*of)[HARMONICS] = transfers(c, weight), (*t)[HARMONICS] = mem_array((size_t)(kept / step) + 2, sizeof *t);
	double *value = mem_array((size_t)(kept / step) + 2, sizeof *value), light[3][HARMONICS];
	long *at = mem_array((size_t)(kept / step) + 2, sizeof *at);
	for (long i = 0, k = 0; i < all; i++)
		if (keep[i] && k++ % step == 0) {
			at[n] = i;
			at_texel(t[n++], (const double(*)[HARMONICS])of, c, i);
		}
	bool ok = true;
	for (int j = 0; j < 3 && ok; j++) {
		const int k = (j + 1) % 3;  // green first
		for (int i = 0; i < n; i++)
			value[i] = exp((double)ln[at[i]][k]);
		ok = fit(light[k], n, (const double(*)[HARMONICS])t, value, j ? light[1] : 0, shade[1]);
		for (int i = 0; i < n && ok; i++) {
			value[i] = 0;
			for (int h = 0; h < HARMONICS; h++)
				value[i] += light[k][h] * t[i][h];
		}
		shade[k] = ok ? stats_median(n, value) : 0;
		ok = ok && shade[k] > 0;
	}
#pragma omp parallel for schedule(static)
	for (long i = 0; i < all; i++) {
		double here[HARMONICS];
		if (!ok || !(weight[i] > 0))
			continue;
		at_texel(here, (const double(*)[HARMONICS])of, c, i);
		for (int k = 0; k < 3; k++) {
			double is = 0;
			for (int j = 0; j < HARMONICS; j++)
				is += light[k][j] * here[j];
			ln[i][k] -= (float)log(fmax(is, shade_least * shade[k]) / shade[k]);
		}
	}
	const double toward[3] = { light[1][3], light[1][1], light[1][2] };
	if (ok)
		vec_unit(from, toward);
	free(at);
	free(value);
	free(t);
	free(of);
	return ok;
}
