#include "tissue/pigment/melanin.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tissue/pigment/problem.h"
#include "tissue/pigment/texture.h"

enum { LEVELS = 40, STEPS = 4, TEXELS_MIN = 4 };

/* A node on the iris. */
struct node {
	int at;                      // its index in the map
	double x, y, profile;        // mm; ln melanin of the profile there
	struct pigment_class class;  // its texels; texels = 0: not seen
};

struct field {
	const struct pigment_fit *fit;
	const struct pigment_conf *conf;
	double low, step;            // ln melanin of the table's first level, between levels
	struct tissue_optics level[LEVELS];
	int n, seen;
	struct node *node;           // those that were seen come first
};

/* What the rings say at a share, linear between their middles. beyond: thickness instead of melanin. */
static double profile_of(const struct pigment_fit *fit, double share, bool beyond)
{
	const struct pigment_ring *ring = fit->ring;
	int r = 0;
	if (!fit->rings)
		return 0;
	while (r + 2 < fit->rings && share > ring[r + 1].share)
		r++;
	const struct pigment_ring *a = &ring[r], *b = &ring[r + 1 < fit->rings ? r + 1 : r];
	double t = b->share > a->share ? fmin(fmax((share - a->share) / (b->share - a->share), 0), 1) : 0;
	return beyond ? a->beyond + t * (b->beyond - a->beyond) : a->melanin + t * (b->melanin - a->melanin);
}

/* Mean and scatter of a node's texels. cells: [n * n]. */
static void gather(struct pigment_class *cells, int n, const struct pigment_texture *in, const struct pigment_classes_conf *c)
{
	long count;
	double pitch;
	struct pigment_texel *all = pigment_texels(&count, &pitch, in, c->inner, c->outer);
	double independent = fmin(pitch * pitch / (c->grain * c->grain), 1);
	for (long i = 0; i < count; i++) {
		int x = (int)((all[i].x / in->extent + 1) / 2 * n), y = (int)((all[i].y / in->extent + 1) / 2 * n);
		struct pigment_class *cell = &cells[(y < n ? y : n - 1) * n + (x < n ? x : n - 1)];
		cell->texels++;
		cell->thickness += all[i].thickness;
		for (int k = 0; k < 3; k++) {
			cell->rgb[k] += all[i].rgb[k];
			cell->spread[k] += all[i].rgb[k] * all[i].rgb[k];
		}
	}
	free(all);
	for (int i = 0; i < n * n; i++) {
		double m = cells[i].texels;
		if (!(m >= TEXELS_MIN)) {
			cells[i].texels = 0;
			continue;
		}
		cells[i].thickness /= m;
		for (int k = 0; k < 3; k++) {
			cells[i].rgb[k] /= m;
			cells[i].spread[k] = sqrt(fmax(cells[i].spread[k] / m - cells[i].rgb[k] * cells[i].rgb[k], 0));
		}
		cells[i].texels = fmax(m * independent, 1);
	}
}

/* Nodes on the iris: those that were seen, then the others; the profile everywhere. */
static void nodes_make(struct field *f, struct melanin_map *map, const struct pigment_texture *in, const struct pigment_classes_conf *c)
{
	int n = map->n;
	struct pigment_class *cells = mem_new((size_t)n * (size_t)n, sizeof *cells);
	gather(cells, n, in, c);
	for (int seen = 1; seen >= 0; seen--) {
		for (int i = 0; i < n * n; i++) {
			struct node node = { .at = i, .x = (2 * (i % n + 0.5) / n - 1) * map->extent, .y = (2 * (i / n + 0.5) / n - 1) * map->extent };
			double share = iris_share(in->pupil, in->root, node.x, node.y);
			map->ln[i] = node.profile = profile_of(f->fit, share, false);
			if (share < 0 || share > 1 || (cells[i].texels > 0) != seen)
				continue;
			node.class = cells[i];
			node.class.thickness *= exp(profile_of(f->fit, share, true));
			f->node[f->n++] = node;
			f->seen += seen;
		}
	}
	free(cells);
}

/* What a photograph shows of a thickness under a melanin, by the table. */
static void model(double rgb[3], const struct field *f, double ln, double thickness)
{
	double at = fmin(fmax((ln - f->low) / f->step, 0), LEVELS - 1.001), t = at - (int)at, a[3], b[3];
	pigment_model(a, f->fit->x, &f->level[(int)at], thickness, f->conf);
	pigment_model(b, f->fit->x, &f->level[(int)at + 1], thickness, f->conf);
	for (int k = 0; k < 3; k++)
		rgb[k] = exp((1 - t) * log(fmax(a[k], 1e-6)) + t * log(fmax(b[k], 1e-6)));
}

/* A node's observation of ln melanin about `ln`, by Gauss and Newton: how far it would move, and with what variance; infinite where the
 * colour does not depend on it. */
static double observe(double *variance, const struct field *f, const struct node *node, double ln)
{
	const double h = 0.5 * f->step, most = 1.5;
	double rgb[3], r[3], side[2][3], jj = 0, jr = 0;
	model(rgb, f, ln, node->class.thickness);
	pigment_class_residuals(r, &node->class, rgb, f->conf);
	for (int s = 0; s < 2; s++) {
		model(rgb, f, ln + (s ? h : -h), node->class.thickness);
		pigment_class_residuals(side[s], &node->class, rgb, f->conf);
	}
	for (int k = 1; k < 3; k++) {  // 0: of luminance
		double J = (side[1][k] - side[0][k]) / (2 * h);
		jj += J * J;
		jr += J * r[k];
	}
	*variance = 1 / fmax(jj, 1e-9);
	return fmin(fmax(-jr / fmax(jj, 1e-9), -most), most);
}

static double covariance(const struct node *a, const struct node *b, const struct melanin_conf *c)
{
	return c->field * c->field * exp(-hypot(a->x - b->x, a->y - b->y) / c->reach);
}

/* Of every node with those that were seen. */
static void covariances(double *between, const struct field *f, const struct melanin_conf *c)
{
	int m = f->seen;
#pragma omp parallel for schedule(static)
	for (int i = 0; i < f->n; i++)
		for (int j = 0; j < m; j++)
			between[(long)i * m + j] = covariance(&f->node[i], &f->node[j], c);
}

/* Cholesky factor of the covariance of the observations. */
static bool factorise(double *A, const double *between, int m, const double variance[], struct err *err)
{
	memcpy(A, between, (size_t)m * (size_t)m * sizeof *A);
	for (int i = 0; i < m; i++)
		A[(long)i * m + i] += variance[i];
	return !LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', m, A, m) || err_set(err, "pigment: the covariance of melanin's map cannot be factorised");
}

/* The field at every node, and in the end its sigma. */
static bool solve(struct melanin_map *map, const struct field *f, const struct melanin_conf *c, struct err *err)
{
	int m = f->seen;
	double *A = mem_array((size_t)m * (size_t)m + 1, sizeof *A), *between = mem_array((size_t)f->n * (size_t)m + 1, sizeof *between);
	double *u = mem_new((size_t)f->n + 1, sizeof *u), *z = mem_array((size_t)m + 1, sizeof *z), *variance = mem_array((size_t)m + 1, sizeof *variance);
	bool ok = true;
	covariances(between, f, c);
	for (int k = 0; ok && m && k < STEPS; k++) {
		for (int i = 0; i < m; i++)
			z[i] = u[i] + observe(&variance[i], f, &f->node[i], f->fit->x[PIGMENT_ABL_MELANIN] + f->node[i].profile + u[i]);
		ok = factorise(A, between, m, variance, err) && !LAPACKE_dpotrs(LAPACK_ROW_MAJOR, 'L', m, 1, A, m, z, 1);
		for (int i = 0; ok && i < f->n; i++) {
			u[i] = 0;
			for (int j = 0; j < m; j++)
				u[i] += between[(long)i * m + j] * z[j];
		}
	}
	if (ok && m)  // rows of `between` become L^-1 of themselves, whose squares are what the observations take off the variance
		LAPACKE_dtrtrs(LAPACK_COL_MAJOR, 'U', 'T', 'N', m, f->n, A, m, between, m);
	for (int i = 0; ok && i < f->n; i++) {
		double left = c->field * c->field;
		for (int j = 0; j < m; j++)
			left -= between[(long)i * m + j] * between[(long)i * m + j];
		map->ln[f->node[i].at] += u[i];
		map->sigma[f->node[i].at] = sqrt(fmax(left, 0));
	}
	free(A);
	free(between);
	free(u);
	free(z);
	free(variance);
	return ok;
}

/* What the profile's own sigma adds. */
static void add_rings(struct melanin_map *map, const struct pigment_fit *fit)
{
	double mean = 0;
	for (int r = 0; r < fit->rings; r++)
		mean += fit->ring[r].sigma * fit->ring[r].sigma / fit->rings;
	for (int i = 0; i < map->n * map->n; i++)
		map->sigma[i] = sqrt(map->sigma[i] * map->sigma[i] + mean);
}

bool melanin_fit(struct melanin_map *out, const struct pigment_texture *in, const struct pigment_fit *fit, const struct pigment_conf *conf,
                 const struct pigment_classes_conf *classes, const struct melanin_conf *c, struct err *err)
{
	struct pigment_conf errors = *conf;
	struct melanin_conf own = *c;
	errors.model_error = fit->model_error;
	*out = (struct melanin_map){ 0 };
	if (!(fit->varies > 0))
		return true;
	own.field *= fit->varies;
	*out = (struct melanin_map){ .n = (int)fmin(ceil(2 * in->extent / c->cell), MELANIN_SIDE_MAX), .extent = in->extent };
	struct field *f = mem_new(1, sizeof *f);
	f->fit = fit;
	f->conf = &errors;
	f->node = mem_array((size_t)out->n * (size_t)out->n, sizeof *f->node);
	f->low = log(1e-5);
	f->step = (log(0.9) - f->low) / (LEVELS - 1);
	struct tissue_bands bands;
	tissue_bands_make(&bands, conf->bands, conf->illuminant);
	for (int l = 0; l < LEVELS; l++) {
		struct tissue tissue = pigment_tissue_beyond(fit->x, f->low + l * f->step - fit->x[PIGMENT_ABL_MELANIN], conf);
		tissue_optics_make(&f->level[l], &tissue, &bands);
	}
	for (int i = 0; i < out->n * out->n; i++)
		out->sigma[i] = own.field;
	nodes_make(f, out, in, classes);
	bool ok = solve(out, f, &own, err);
	add_rings(out, fit);
	free(f->node);
	free(f);
	return ok;
}

double melanin_at(const struct melanin_map *map, double x, double y)
{
	int n = map->n;
	double u = fmin(fmax((x / map->extent + 1) / 2 * n - 0.5, 0), n - 1.001), v = fmin(fmax((y / map->extent + 1) / 2 * n - 0.5, 0), n - 1.001);
	int i = (int)u, j = (int)v;
	const double *p = map->ln + j * n + i;
	u -= i;
	v -= j;
	return (1 - v) * ((1 - u) * p[0] + u * p[1]) + v * ((1 - u) * p[n] + u * p[n + 1]);
}
