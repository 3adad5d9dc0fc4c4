#include "register/nricp/noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"

static double mean_edge(const struct mesh *mesh, const struct topology *t)
{
	double sum = 0;
	for (int i = 0; i < t->n; i++)
		for (int32_t e = t->start[i]; e < t->start[i + 1]; e++) {
			const float *a = mesh->vertices[i], *b = mesh->vertices[t->neighbour[e]];
			float d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
			sum += sqrt((double)(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
		}
	return t->start[t->n] ? sum / t->start[t->n] : 0;
}

/* share: weight of a neighbour's normal against a vertex's own. */
static void smooth_normals(float (*normals)[3], const struct topology *t, float share)
{
	float (*was)[3] = mem_array((size_t)t->n + 1, sizeof *was);
	memcpy(was, normals, (size_t)t->n * sizeof *was);
	for (int i = 0; i < t->n; i++) {
		float *n = normals[i];
		for (int32_t e = t->start[i]; e < t->start[i + 1]; e++)
			for (int k = 0; k < 3; k++)
				n[k] += share * was[t->neighbour[e]][k];
		float len = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		for (int k = 0; k < 3; k++)
			n[k] = len > 0 ? n[k] / len : was[i][k];
	}
	free(was);
}

double nricp_noise(float (*normals)[3], const struct mesh *mesh, const struct topology *t)
{
	static const double usual = 0.2;  // error of the normals, radians, at which neighbours count as much as a vertex's own

	double *off = mem_array((size_t)t->n + 1, sizeof *off);
	int n = 0;
	for (int i = 0; i < t->n; i++) {
		int32_t degree = t->start[i + 1] - t->start[i];
		if (t->boundary[i] || !degree)
			continue;
		double across = 0;
		for (int32_t e = t->start[i]; e < t->start[i + 1]; e++)
			for (int k = 0; k < 3; k++)
				across += (double)normals[i][k] * ((double)mesh->vertices[t->neighbour[e]][k] - (double)mesh->vertices[i][k]) / degree;
		off[n++] = across / sqrt(1 + 1.0 / degree);  // its own noise and that of the mean of its neighbours
	}
	double sigma = n ? stats_mad(n, off, 0) : 0;
	free(off);
	double edge = mean_edge(mesh, t), turned = edge > 0 ? sigma / (usual * edge) : 0;
	smooth_normals(normals, t, (float)fmin(turned * turned, 1));
	return sigma;
}
