#include "mesh/openness.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "mesh/ray.h"

enum { RAYS = 24 };
static const float OFF = 3e-5f;  // distance of a ray's start from its own surface, of the mesh's extent

/* Directions evenly over the cosine-weighted hemisphere about z: Vogel's spiral on the disc, projected up. */
static void sky(float dir[RAYS][3])
{
	for (int i = 0; i < RAYS; i++) {
		double r = sqrt((i + 0.5) / RAYS), a = M_PI * (3 - sqrt(5)) * i;
		dir[i][0] = (float)(r * cos(a));
		dir[i][1] = (float)(r * sin(a));
		dir[i][2] = (float)sqrt(1 - r * r);
	}
}

static void frame(float x[3], float y[3], const float n[3])
{
	// Duff et al. 2017: no branch cuts, no normalisation.
	float s = copysignf(1, n[2]), a = -1 / (s + n[2]), b = n[0] * n[1] * a;
	x[0] = 1 + s * n[0] * n[0] * a;
	x[1] = s * b;
	x[2] = -s * n[0];
	y[0] = b;
	y[1] = s + n[1] * n[1] * a;
	y[2] = -n[1];
}

/* Measures every step-th vertex. Stops at a vertex once `enough` of its rays are free. */
static void measure(float *open, const struct mesh *mesh, int step, int enough)
{
	float dir[RAYS][3], (*normal)[3] = mesh_normals(mesh);
	float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, size = 0;
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++) {
			lo[k] = fminf(lo[k], mesh->vertices[i][k]);
			hi[k] = fmaxf(hi[k], mesh->vertices[i][k]);
			size = fmaxf(size, hi[k] - lo[k]);
		}
	struct ray_scene *scene = ray_scene_new(mesh->n_vertices, (const float(*)[3])mesh->vertices, mesh->n_faces,
	                                        (const int32_t(*)[3])mesh->faces);
	sky(dir);
#pragma omp parallel for schedule(dynamic, 256)
	for (int i = 0; i < mesh->n_vertices; i += step) {
		const float *n = normal[i];
		float x[3], y[3], from[3];
		int free_rays = 0;
		frame(x, y, n);
		for (int k = 0; k < 3; k++)
			from[k] = mesh->vertices[i][k] + OFF * size * n[k];
		for (int r = 0; r < RAYS && free_rays < enough; r++) {
			float d[3];
			for (int k = 0; k < 3; k++)
				d[k] = dir[r][0] * x[k] + dir[r][1] * y[k] + dir[r][2] * n[k];
			free_rays += !ray_blocked(scene, from, d, 0, INFINITY);
		}
		open[i] = (float)free_rays / RAYS;
	}
	ray_scene_free(scene);
	free(normal);
}

void mesh_openness(float *open, const struct mesh *mesh)
{
	measure(open, mesh, 1, RAYS);
}

/* Tests every step-th vertex; returns how many those are and, in *n, how many of them are hidden. */
static int find_hidden(bool *hidden, int *n, const struct mesh *mesh, double least, int step)
{
	int all = 0;
	float *open = mem_array((size_t)mesh->n_vertices + 1, sizeof *open);
	measure(open, mesh, step, (int)ceil(least * RAYS));
	*n = 0;
	for (int i = 0; i < mesh->n_vertices; i += step, all++) {
		bool is = (double)open[i] < least;
		*n += is;
		if (hidden)
			hidden[i] = is;
	}
	free(open);
	return all;
}

void mesh_hidden(bool *hidden, const struct mesh *mesh, double least)
{
	int n;
	find_hidden(hidden, &n, mesh, least, 1);
}

double mesh_hidden_share(const struct mesh *mesh, double least, int samples)
{
	int n, all = find_hidden(0, &n, mesh, least, mesh->n_vertices > samples ? mesh->n_vertices / samples : 1);
	return all ? (double)n / all : 0;
}
