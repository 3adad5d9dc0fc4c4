#include "rig/globe_map.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "mesh/ray.h"

static struct globe_map map_new(int n)
{
	return (struct globe_map){ n, mem_array((size_t)(n + 1) * (size_t)(n + 1), sizeof(float)) };
}

void globe_map_free(struct globe_map *map)
{
	free(map->radius);
	*map = (struct globe_map){ 0 };
}

/* The direction of a node; unit length. */
static void node_direction(float dir[3], int n, int column, int row)
{
	float u = 2 * (float)column / (float)n - 1, v = 2 * (float)row / (float)n - 1, z = 1 - fabsf(u) - fabsf(v);
	if (z < 0) {
		float x = (1 - fabsf(v)) * (u < 0 ? -1.0f : 1.0f);
		v = (1 - fabsf(u)) * (v < 0 ? -1.0f : 1.0f);
		u = x;
	}
	float len = sqrtf(u * u + v * v + z * z);
	dir[0] = u / len;
	dir[1] = v / len;
	dir[2] = z / len;
}

float globe_map_at(const struct globe_map *map, const float d[3])
{
	float k = 1 / (fabsf(d[0]) + fabsf(d[1]) + fabsf(d[2])), u = d[0] * k, v = d[1] * k, top = (float)map->n;
	if (d[2] < 0) {
		float x = (1 - fabsf(v)) * (u < 0 ? -1.0f : 1.0f);
		v = (1 - fabsf(u)) * (v < 0 ? -1.0f : 1.0f);
		u = x;
	}
	u = fminf(0.5f * (u + 1) * top, top - 1e-3f);
	v = fminf(0.5f * (v + 1) * top, top - 1e-3f);
	int iu = (int)u, iv = (int)v, w = map->n + 1;
	const float *p = map->radius + (long)iv * w + iu;
	u -= (float)iu;
	v -= (float)iv;
	return (1 - v) * ((1 - u) * p[0] + u * p[1]) + v * ((1 - u) * p[w] + u * p[w + 1]);
}

/* Fills nodes that no ray met (0) with the mean of their filled neighbours, ring after ring. */
static void fill(struct globe_map *map)
{
	int w = map->n + 1;
	size_t size = (size_t)w * (size_t)w;
	float *next = mem_array(size, sizeof *next);
	for (bool open = true; open;) {
		open = false;
		for (int v = 0; v < w; v++)
			for (int u = 0; u < w; u++) {
				float sum = 0, *at = map->radius + (long)v * w + u;
				int n = 0;
				next[(long)v * w + u] = *at;
				if (*at > 0)
					continue;
				for (int k = 0; k < 9; k++) {
					int x = u + k % 3 - 1, y = v + k / 3 - 1;
					float r = x < 0 || y < 0 || x >= w || y >= w ? 0 : map->radius[(long)y * w + x];
					sum += r;
					n += r > 0;
				}
				next[(long)v * w + u] = n ? sum / (float)n : 0;
				open = true;
			}
		for (size_t i = 0; i < size; i++)
			map->radius[i] = next[i];
	}
	free(next);
}

bool globe_map_from_mesh(struct globe_map *map, int n, const struct mesh *mesh, struct err *err)
{
	struct ray_scene *scene = ray_scene_new(mesh->n_vertices, (const float(*)[3])mesh->vertices, mesh->n_faces,
	                                        (const int32_t(*)[3])mesh->faces);
	float far = 0;
	int met = 0, w = n + 1;
	for (int i = 0; i < mesh->n_vertices; i++) {
		const float *p = mesh->vertices[i];
		far = fmaxf(far, p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
	}
	far = 1.01f * sqrtf(far);
	*map = map_new(n);
	for (int v = 0; v < w; v++)
		for (int u = 0; u < w; u++) {
			float dir[3], from[3], in[3];
			node_direction(dir, n, u, v);
			for (int k = 0; k < 3; k++) {
				from[k] = far * dir[k];
				in[k] = -dir[k];
			}
			struct ray_hit hit = ray_first(scene, from, in, 0, far);
			map->radius[(long)v * w + u] = hit.face >= 0 ? far - hit.t : 0;
			met += hit.face >= 0;
		}
	ray_scene_free(scene);
	if (met < w * w / 2) {
		globe_map_free(map);
		return err_set(err, "the mesh of the eyeball surrounds its centre by %.0f %% only, must be >= 50 %%",
		               100.0 * met / (w * w));
	}
	fill(map);
	return true;
}

struct globe_map globe_map_round(int n, double radius, double cornea_radius, double apex)
{
	struct globe_map map = map_new(n);
	double shift = apex - cornea_radius;  // the cap's centre on the axis
	for (int v = 0; v <= n; v++)
		for (int u = 0; u <= n; u++) {
			float dir[3];
			node_direction(dir, n, u, v);
			double z = dir[2], disc = cornea_radius * cornea_radius - shift * shift * (1 - z * z);
			double cap = apex > 0 && z > 0 && disc > 0 ? shift * z + sqrt(disc) : 0;
			map.radius[(long)v * (n + 1) + u] = (float)fmax(radius, cap);
		}
	return map;
}

struct image globe_map_polar(const struct globe_map *map, int height)
{
	struct image image = image_new(2 * height, height, 1);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < 2 * height; x++) {
			float turn = (float)M_PI * (((float)x + 0.5f) / (float)height - 1), fall = (float)M_PI * ((float)y + 0.5f) / (float)height;
			float dir[3] = { sinf(fall) * sinf(turn), cosf(fall), sinf(fall) * cosf(turn) };
			*image_at(&image, x, y) = globe_map_at(map, dir);
		}
	return image;
}
