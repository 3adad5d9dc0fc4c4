#include "track/clip/points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

enum { NEAR = 24, NEIGHBOURS = 12 };

static const double facing = 0.15;      // cosine of the steepest skin that is followed
static const double rim_px = 1.5;       // so close to an opening pixels are half eye

/* Clears the openings of the eyes, and a rim round them, in a mask of 255. */
static void cut_openings(uint8_t *mask, const struct track_clip *clip, const struct track_subject *s)
{
	int w = clip->info.width, h = clip->info.height;
	for (int e = 0; e < SIDES; e++) {
		double px[OPENING_POINTS][2], mid[2] = { 0 }, low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
		bool ok = s->opening[e].open && clip->eye_seen[e];
		for (int i = 0; i < OPENING_POINTS && ok; i++) {
			ok = head_project(px[i], &clip->camera, clip->cam_from_head, s->opening[e].edge[i]);
			for (int k = 0; k < 2; k++)
				mid[k] += px[i][k] / OPENING_POINTS;
		}
		for (int i = 0; i < OPENING_POINTS && ok; i++) {
			double r = hypot(px[i][0] - mid[0], px[i][1] - mid[1]);
			for (int k = 0; k < 2; k++) {
				px[i][k] += rim_px * (px[i][k] - mid[k]) / fmax(r, 1);
				low[k] = fmin(low[k], px[i][k]);
				high[k] = fmax(high[k], px[i][k]);
			}
		}
		for (int y = (int)fmax(0, low[1]); ok && y < h && y < high[1]; y++)
			for (int x = (int)fmax(0, low[0]); x < w && x < high[0]; x++) {
				bool in = false;
				for (int i = 0, j = OPENING_POINTS - 1; i < OPENING_POINTS; j = i++)
					if ((px[i][1] > y + 0.5) != (px[j][1] > y + 0.5)
					    && x + 0.5 < (px[j][0] - px[i][0]) * (y + 0.5 - px[i][1]) / (px[j][1] - px[i][1]) + px[i][0])
						in = !in;
				if (in)
					mask[(long)y * w + x] = 0;
			}
	}
}

static bool in_sight(double px[2], const struct track_clip *clip, const struct ray_scene *rays, const float vertex[3],
                     const float normal[3], const double from[3])
{
	double p[3] = { vertex[0], vertex[1], vertex[2] }, dir[3], n[3] = { normal[0], normal[1], normal[2] };
	for (int k = 0; k < 3; k++)
		dir[k] = p[k] - from[k];
	if (!head_project(px, &clip->camera, clip->cam_from_head, p) || -vec_dot(dir, n) < facing * vec_norm(dir))
		return false;
	if (!(px[0] > 3 && px[1] > 3 && px[0] < clip->info.width - 3 && px[1] < clip->info.height - 3))
		return false;
	const float o[3] = { (float)from[0], (float)from[1], (float)from[2] }, d[3] = { (float)dir[0], (float)dir[1], (float)dir[2] };
	return !ray_blocked(rays, o, d, 0, 1 - 0.3f / (float)vec_norm(dir));
}

/* Takes candidates in order unless one taken lies within gap; returns how many. */
static int thin(int *taken, int n, const double (*px)[2], double gap)
{
	int m = 0;
	for (int i = 0; i < n; i++) {
		bool free_place = true;
		for (int k = 0; k < m && free_place; k++) {
			double dx = px[taken[k]][0] - px[i][0], dy = px[taken[k]][1] - px[i][1];
			free_place = dx * dx + dy * dy >= gap * gap;
		}
		if (free_place)
			taken[m++] = i;
	}
	return m;
}

/* True when the segment a..b does not cross an opening. */
static bool over_skin(const uint8_t *mask, int width, const double a[2], const double b[2])
{
	int steps = (int)ceil(hypot(b[0] - a[0], b[1] - a[1]) / 2) + 1;
	for (int i = 0; i <= steps; i++) {
		double t = (double)i / steps;
		if (!mask[(long)(a[1] + t * (b[1] - a[1])) * width + (long)(a[0] + t * (b[0] - a[0]))])
			return false;
	}
	return true;
}

/* The points nearest to point i over skin, in rising distance; returns how many. */
static int nearest(int near[NEAR], const struct track_points *p, int i, int width)
{
	const double(*at)[2] = (const double(*)[2])p->points.at;
	double d2[NEAR];
	int n = 0;
	for (int j = 0; j < p->n; j++) {
		double d = pow(at[i][0] - at[j][0], 2) + pow(at[i][1] - at[j][1], 2);
		if (j == i || (n == NEAR && d >= d2[NEAR - 1]) || !over_skin(p->mask, width, at[i], at[j]))
			continue;
		int k = n < NEAR ? n++ : NEAR - 1;
		for (; k > 0 && d2[k - 1] > d; k--) {
			d2[k] = d2[k - 1];
			near[k] = near[k - 1];
		}
		d2[k] = d;
		near[k] = j;
	}
	return n;
}

static void join(struct track_points *p, int width)
{
	int(*edge)[2] = mem_new((size_t)p->n * NEAR + 1, sizeof *edge), n_edges = 0;
	int(*near)[NEAR] = mem_new((size_t)p->n + 1, sizeof *near), *found = mem_new((size_t)p->n + 1, sizeof *found);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < p->n; i++)
		found[i] = nearest(near[i], p, i, width);
	for (int i = 0; i < p->n; i++)
		for (int k = 0; k < found[i]; k++, n_edges++) {
			edge[n_edges][0] = i;
			edge[n_edges][1] = near[i][k];
		}
	free(near);
	free(found);
	skin_points_join(&p->points, n_edges, (const int(*)[2])edge, NEIGHBOURS);
	free(edge);
}

/* Vertices that are visible and within reach (mm) of an eye that is seen. Returns how many. */
static int candidates(int *row, double (*px)[2], float (*normal)[3], const struct track_clip *clip, const struct track_subject *s, const uint8_t *mask,
                      double reach)
{
	const struct mesh *mesh = &s->mesh;
	struct ray_scene *rays = ray_scene_new(mesh->n_vertices, (const float(*)[3])mesh->vertices, mesh->n_faces, (const int32_t(*)[3])mesh->faces);
	double from[3], origin[3] = { 0 };
	int n = 0;
	head_to(from, clip->cam_from_head, origin);
	for (int i = 0; i < mesh->n_vertices; i++) {
		bool near = false;
		const float *v = mesh->vertices[i];
		for (int e = 0; e < SIDES; e++)
			near |= clip->eye_seen[e] && pow(v[0] - s->center[e][0], 2) + pow(v[1] - s->center[e][1], 2) + pow(v[2] - s->center[e][2], 2) < reach * reach;
		if (near && in_sight(px[n], clip, rays, v, normal[i], from) && mask[(long)px[n][1] * clip->info.width + (long)px[n][0]])
			row[n++] = i;
	}
	ray_scene_free(rays);
	return n;
}

bool track_points_face(const struct track_points *p, int i, const double m[4][4])
{
	double at[3], n[3];
	head_from(at, m, p->head[i]);
	for (int r = 0; r < 3; r++)
		n[r] = vec_dot(m[r], p->normal[i]);
	return -vec_dot(n, at) > facing * vec_norm(at);
}

bool track_points_choose(struct track_points *p, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf,
                         struct err *err)
{
	size_t area = (size_t)clip->info.width * (size_t)clip->info.height, most = (size_t)s->mesh.n_vertices + 1;
	*p = (struct track_points){ .mask = mem_new(area, 1) };
	int *row = mem_new(most, sizeof *row), *taken = mem_new(most, sizeof *taken);
	double(*px)[2] = mem_new(most, sizeof *px);
	memset(p->mask, 255, area);
	cut_openings(p->mask, clip, s);
	float(*normal)[3] = mesh_normals(&s->mesh);
	int n = candidates(row, px, normal, clip, s, p->mask, conf->reach_mm);
	double low = conf->gap_px, high = 64;
	p->n = thin(taken, n, (const double(*)[2])px, low);
	if (p->n > conf->points) {
		for (int i = 0; i < 10; i++) {
			double mid = 0.5 * (low + high);
			*(thin(taken, n, (const double(*)[2])px, mid) > conf->points ? &low : &high) = mid;
		}
		p->n = thin(taken, n, (const double(*)[2])px, high);
	}
	p->vertex = mem_new((size_t)p->n + 1, sizeof *p->vertex);
	p->head = mem_new((size_t)p->n + 1, sizeof *p->head);
	p->normal = mem_new((size_t)p->n + 1, sizeof *p->normal);
	p->points = (struct skin_points){ .n = p->n, .at = mem_new((size_t)p->n + 1, sizeof *p->points.at) };
	for (int i = 0; i < p->n; i++) {
		p->vertex[i] = row[taken[i]];
		for (int k = 0; k < 3; k++) {
			p->head[i][k] = s->mesh.vertices[p->vertex[i]][k];
			p->normal[i][k] = normal[p->vertex[i]][k];
		}
		memcpy(p->points.at[i], px[taken[i]], sizeof p->points.at[i]);
	}
	free(normal);
	free(row);
	free(taken);
	free(px);
	join(p, clip->info.width);
	return s->assumed || p->n >= 20 || err_set(err, "%s: only %d vertices of skin are in sight round the eyes, at least 20 are needed: check subject.unit_mm and subject.eye_center", s->file, p->n);
}

void track_points_free(struct track_points *p)
{
	skin_points_free(&p->points);
	free(p->vertex);
	free(p->head);
	free(p->normal);
	free(p->mask);
}
