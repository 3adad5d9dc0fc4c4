/* Estimates the light of the neutral face from its shading and from that of the lines. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "math/chol.h"
#include "math/stats.h"
#include "math/vec.h"
#include "track/wrinkle/impl.h"

enum { ROUNDS = 6, SHARES = 7 };

static const double usual_ambient = 0.5, usual_pull = 0.001;  // prior of the ambient light, of the mean light; its weight, of a point
static const double least_share = 0.1;  // of the light: some of it has no direction, even in a dark room with one lamp

void wrinkle_light(struct wrinkles *w, const float *neutral, const uint8_t *skin, const struct wrinkle_ground *g)
{
	// Least squares of light = albedo (ambient + from . n), one albedo for all; Cauchy weights against brows, moles, gloss.
	double x[4] = { 1, 0, 0, 0 }, (*n)[3] = mem_array((size_t)g->n + 1, sizeof *n), *v = mem_array((size_t)g->n + 1, sizeof *v);
	double *off = mem_array((size_t)g->n + 1, sizeof *off), mean = 0;
	int m = 0;
	for (int i = 0; i < g->n; i++) {
		struct wrinkle_point p;
		double at[2] = { g->at[i][0] - g->x0, g->at[i][1] - g->y0 };
		long px = (long)at[1] * g->width + (long)at[0];
		if (at[0] < 0 || at[1] < 0 || at[0] >= g->width || at[1] >= g->height || !skin[px] || !wrinkle_on_surface(&p, n[m], g, g->at[i]))
			continue;
		v[m] = exp((double)plane_sample(neutral, g->width, g->height, at[0], at[1]));
		mean += v[m++];
	}
	mean /= fmax(m, 1);
	double scale = 0.3;
	for (int round = 0; round < ROUNDS && m >= 12; round++) {
		double H[16] = { 0 }, b[4] = { 0 };
		for (int i = 0; i < m; i++) {
			double a[4] = { 1, n[i][0], n[i][1], n[i][2] }, r = v[i] / mean - x[0] - vec_dot(x + 1, n[i]);
			double weight = round ? 1 / (1 + r * r / (scale * scale)) : 1;
			off[i] = fabs(r);
			for (int j = 0; j < 4; j++) {
				b[j] += weight * a[j] * v[i] / mean;
				for (int k = 0; k < 4; k++)
					H[4 * j + k] += weight * a[j] * a[k];
			}
		}
		scale = fmax(0.02, 1.5 * stats_median(m, off));
		// A frontal face cannot distinguish a lamp before it from ambient light: a prior of half, as in a room.
		H[0] += usual_pull * m;
		b[0] += usual_pull * usual_ambient * m;
		for (int j = 1; j < 4; j++)
			H[5 * j] += 5e-4 * m;
		if (chol_solve(4, 4, H, b))
			memcpy(x, b, sizeof x);
	}
	// some light is ambient in any case
	double all = x[0] + vec_norm(x + 1);
	w->ambient = fmax(x[0], least_share * fmax(all, 0.1));
	memcpy(w->from, x + 1, sizeof w->from);
	free(n);
	free(v);
	free(off);
}

/* Sets the ambient share of the light that falls along a normal, keeping its sum. */
static void divide(struct wrinkles *w, const struct wrinkles *as, const double normal[3], double share)
{
	double straight = vec_dot(as->from, normal), whole = as->ambient + fmax(0, straight);
	w->ambient = share * whole;
	for (int k = 0; k < 3; k++)
		w->from[k] = as->from[k] + ((1 - share) * whole - straight) * normal[k];
}

void wrinkle_ambient(struct wrinkles *w, int n, const struct wrinkle_line lines[], const float *change, const struct wrinkle_ground *g,
                     const struct wrinkle_grooves *t)
{
	const struct wrinkles as = *w;
	double mean[3] = { 0 }, left[SHARES], best = 0;
	int at = 0;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < lines[i].n; j++) {
			struct wrinkle_point hit;
			double normal[3];
			if (wrinkle_on_surface(&hit, normal, g, lines[i].point[j].px))
				vec_add(mean, mean, 1, normal);
		}
	if (!(vec_norm(mean) > 0))
		return;
	vec_unit(mean, mean);
	for (int k = 0; k < SHARES; k++) {
		divide(w, &as, mean, least_share + (1 - least_share) * k / (SHARES - 1));
		left[k] = 0;
		for (int i = 0; i < n; i++)
			left[k] += wrinkle_unexplained(&lines[i], w, change, g, t);
		at = left[k] < left[at] ? k : at;
	}
	best = at;
	if (at > 0 && at < SHARES - 1) {  // vertex of the parabola through three
		double bend = left[at - 1] - 2 * left[at] + left[at + 1];
		best += bend > 0 ? 0.5 * (left[at - 1] - left[at + 1]) / bend : 0;
	}
	divide(w, &as, mean, least_share + (1 - least_share) * best / (SHARES - 1));
}
