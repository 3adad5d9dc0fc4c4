#include "sfm/cloud/surface_colour.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/image.h"
#include "math/vec.h"
#include "mesh/ray.h"

/* Pixel of a mesh point in a view; false outside. */
static bool project(double px[2], double p[3], const struct surface_view *v, const float x[3])
{
	const struct camera camera = { 1, { 0, 0 }, { v->distortion[0], v->distortion[1], v->distortion[2], v->distortion[3],
		                                          v->distortion[4] }, CAMERA_RIG };
	double world[3] = { (double)x[0], (double)x[1], (double)x[2] }, u[2];
	for (int i = 0; i < 3; i++)
		p[i] = vec_dot(v->cam_from_mesh[i], world) + v->cam_from_mesh[i][3];
	if (!camera_project(u, &camera, p))
		return false;
	for (int i = 0; i < 2; i++)
		px[i] = v->center_px[i] + v->focal[i] * u[i];
	return px[0] >= 1 && px[1] >= 1 && px[0] <= v->width - 1 && px[1] <= v->height - 1;
}

struct rated {
	double score;
	int view;
};

static int by_score(const void *a, const void *b)
{
	const struct rated *p = a, *q = b;
	return p->score != q->score ? (p->score < q->score) - (p->score > q->score) : p->view - q->view;
}

static void view_center(double c[3], const struct surface_view *v)
{
	for (int i = 0; i < 3; i++)
		c[i] = -(v->cam_from_mesh[0][i] * v->cam_from_mesh[0][3] + v->cam_from_mesh[1][i] * v->cam_from_mesh[1][3]
		         + v->cam_from_mesh[2][i] * v->cam_from_mesh[2][3]);
}

/* Score of a view: pixels that a millimetre of the surface covers in it; 0 outside the picture or where it hardly faces the camera. */
static double rate(const struct surface_view *v, const float x[3], const float normal[3])
{
	double px[2], p[3], c[3], d[3];
	if (!project(px, p, v, x))
		return 0;
	view_center(c, v);
	for (int i = 0; i < 3; i++)
		d[i] = c[i] - (double)x[i];
	double length = vec_norm(d);
	double facing = (d[0] * (double)normal[0] + d[1] * (double)normal[1] + d[2] * (double)normal[2]) / length;
	return facing > 0.3 ? facing * v->focal[0] / length : 0;
}

static bool hidden(const struct ray_scene *scene, const struct surface_view *v, const float x[3], const float normal[3],
                   double lift)
{
	double c[3];
	float from[3], dir[3];
	view_center(c, v);
	for (int i = 0; i < 3; i++) {
		from[i] = x[i] + (float)lift * normal[i];
		dir[i] = (float)c[i] - from[i];
	}
	return ray_blocked(scene, from, dir, 0, 1);
}

void surface_best_views(int (*best)[SURFACE_BEST], const struct mesh *mesh, int n, const struct surface_view views[])
{
	float (*normals)[3] = mesh_normals(mesh);
	struct ray_scene *scene = ray_scene_new(mesh->n_vertices, (const float (*)[3])mesh->vertices, mesh->n_faces,
	                                        (const int32_t (*)[3])mesh->faces);
	const double lift = 0.5;  // mm above the surface: its own triangles do not hide it
#pragma omp parallel for schedule(dynamic, 256)
	for (int i = 0; i < mesh->n_vertices; i++) {
		struct rated *order = mem_array((size_t)n, sizeof *order);
		int m = 0, found = 0;
		for (int k = 0; k < n; k++) {
			double score = rate(&views[k], mesh->vertices[i], normals[i]);
			if (score > 0)
				order[m++] = (struct rated){ score, k };
		}
		qsort(order, (size_t)m, sizeof *order, by_score);
		for (int k = 0; k < SURFACE_BEST; k++)
			best[i][k] = -1;
		for (int k = 0; k < m && found < SURFACE_BEST; k++)
			if (!hidden(scene, &views[order[k].view], mesh->vertices[i], normals[i], lift))
				best[i][found++] = order[k].view;
		free(order);
	}
	ray_scene_free(scene);
	free(normals);
}

void surface_add_colour(float (*sum)[4], const struct mesh *mesh, int k, const struct surface_view *view, const uint8_t *rgb,
                        int width, int height, const int (*best)[SURFACE_BEST])
{
	for (int i = 0; i < mesh->n_vertices; i++) {
		double px[2], p[3];
		if ((best[i][0] != k && best[i][1] != k && best[i][2] != k) || !project(px, p, view, mesh->vertices[i]))
			continue;
		int x = (int)(px[0] * width / view->width), y = (int)(px[1] * height / view->height);
		x = x < width ? x : width - 1;
		y = y < height ? y : height - 1;
		float w = best[i][0] == k ? 2 : 1;
		for (int c = 0; c < 3; c++)
			sum[i][c] += w * linear_from_srgb((float)rgb[3 * ((long)y * width + x) + c] / 255);
		sum[i][3] += w;
	}
}

void surface_set_colours(struct mesh *mesh, const float (*sum)[4])
{
	float (*now)[4] = mem_array((size_t)mesh->n_vertices, sizeof *now);
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int c = 0; c < 4; c++)
			now[i][c] = sum[i][c];
	// Colour spreads along the edges over vertices without one, one edge a round.
	for (int round = 0; round < 50; round++)
		for (int f = 0; f < mesh->n_faces; f++)
			for (int k = 0; k < 3; k++) {
				const float *from = now[mesh->faces[f][k]];
				float *to = now[mesh->faces[f][(k + 1) % 3]];
				if (!(from[3] > 0) || to[3] > 0)
					continue;
				for (int c = 0; c < 3; c++)
					to[c] = from[c] / from[3];
				to[3] = 1;
			}
	free(mesh->colours);
	mesh->colours = mem_array((size_t)mesh->n_vertices, sizeof *mesh->colours);
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int c = 0; c < 3; c++)
			mesh->colours[i][c] = now[i][3] > 0 ? now[i][c] / now[i][3] : 0.5f;
	free(now);
}
