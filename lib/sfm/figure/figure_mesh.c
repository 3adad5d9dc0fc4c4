#include "sfm/figure/figure_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/image.h"

struct corner {
	float x, y, z;   // px of the square, depth towards the viewer
	float rgb[3];    // lit, linear
};

/* Half the larger side of the box round it, and its middle. */
static float frame(float middle[3], const struct mesh *m)
{
	float low[3], high[3], half = 1;
	for (int k = 0; k < 3; k++) {
		low[k] = INFINITY;
		high[k] = -INFINITY;
		for (int i = 0; i < m->n_vertices; i++) {
			low[k] = fminf(low[k], m->vertices[i][k]);
			high[k] = fmaxf(high[k], m->vertices[i][k]);
		}
		middle[k] = 0.5f * (low[k] + high[k]);
		half = fmaxf(half, 0.5f * (high[k] - low[k]));
	}
	return half;
}

static void turned(float out[3], const float v[3], float c, float s)
{
	out[0] = c * v[0] - s * v[2];
	out[1] = v[1];
	out[2] = s * v[0] + c * v[2];
}

static struct corner *light(const struct mesh *m, int size, double turn)
{
	struct corner *out = mem_array((size_t)m->n_vertices, sizeof *out);
	float (*normals)[3] = mesh_normals(m), middle[3], half = frame(middle, m), scale = 0.46f * (float)size / half;
	float c = (float)cos(turn), s = (float)sin(turn);
	for (int i = 0; i < m->n_vertices; i++) {
		float v[3], p[3], n[3];
		for (int k = 0; k < 3; k++)
			v[k] = m->vertices[i][k] - middle[k];
		turned(p, v, c, s);
		turned(n, normals[i], c, s);
		float lit = 0.25f + 0.9f * fmaxf(0, -0.4f * n[0] + 0.4f * n[1] + 0.82f * n[2]);
		out[i] = (struct corner){ 0.5f * (float)size + scale * p[0], 0.5f * (float)size - scale * p[1], p[2], { 0 } };
		for (int k = 0; k < 3; k++)
			out[i].rgb[k] = lit * (m->colours ? m->colours[i][k] : 0.5f);
	}
	free(normals);
	return out;
}

/* Samples along a pixel's side: outlines without steps. */
enum { FINE = 3 };

/* The mesh's samples: lit colour, linear, and how near they are; -INFINITY: none. */
struct canvas {
	int size;
	float *depth, (*rgb)[3];
};

static void triangle(struct canvas *out, const struct corner *a, const struct corner *b, const struct corner *c)
{
	float area = (b->x - a->x) * (c->y - a->y) - (c->x - a->x) * (b->y - a->y), most = (float)out->size - 1;
	int low_x = (int)fmaxf(0, fminf(a->x, fminf(b->x, c->x))), high_x = (int)fminf(most, fmaxf(a->x, fmaxf(b->x, c->x)));
	int low_y = (int)fmaxf(0, fminf(a->y, fminf(b->y, c->y))), high_y = (int)fminf(most, fmaxf(a->y, fmaxf(b->y, c->y)));
	if (area == 0)
		return;
	for (int y = low_y; y <= high_y; y++)
		for (int x = low_x; x <= high_x; x++) {
			float px = (float)x + 0.5f, py = (float)y + 0.5f;
			float v = ((px - a->x) * (c->y - a->y) - (c->x - a->x) * (py - a->y)) / area;
			float w = ((b->x - a->x) * (py - a->y) - (px - a->x) * (b->y - a->y)) / area, u = 1 - v - w;
			float z = u * a->z + v * b->z + w * c->z;
			long at = (long)y * out->size + x;
			if (u < 0 || v < 0 || w < 0 || z <= out->depth[at])
				continue;
			out->depth[at] = z;
			for (int k = 0; k < 3; k++)
				out->rgb[at][k] = fminf(1, u * a->rgb[k] + v * b->rgb[k] + w * c->rgb[k]);
		}
}

/* Each pixel the mean of its samples; where there is no mesh, what the picture showed before. */
static void shrink(struct cv_picture *pic, int x0, int y0, int size, const struct canvas *fine)
{
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			uint8_t *px = pic->px + 3 * ((long)(y0 + y) * pic->width + x0 + x);
			float sum[3] = { 0 };
			int n = 0;
			for (int i = 0; i < FINE * FINE; i++) {
				long at = (long)(FINE * y + i / FINE) * fine->size + FINE * x + i % FINE;
				if (!(fine->depth[at] > -INFINITY))
					continue;
				for (int k = 0; k < 3; k++)
					sum[k] += fine->rgb[at][k];
				n++;
			}
			const float share = (float)n / (FINE * FINE);
			for (int k = 0; k < 3 && n; k++) {
				float behind = linear_from_srgb((float)px[k] / 255), mean = share * sum[k] / (float)n + (1 - share) * behind;
				px[k] = (uint8_t)(255 * srgb_from_linear(mean) + 0.5f);
			}
		}
}

void figure_mesh(struct cv_picture *pic, int x0, int y0, int size, const struct mesh *m, double turn)
{
	struct canvas fine = { FINE * size, 0, 0 };
	long n = (long)fine.size * fine.size;
	struct corner *corners = light(m, fine.size, turn);
	fine.depth = mem_array((size_t)n, sizeof *fine.depth);
	fine.rgb = mem_array((size_t)n, sizeof *fine.rgb);
	for (long i = 0; i < n; i++)
		fine.depth[i] = -INFINITY;
	for (int f = 0; f < m->n_faces; f++)
		triangle(&fine, &corners[m->faces[f][0]], &corners[m->faces[f][1]], &corners[m->faces[f][2]]);
	shrink(pic, x0, y0, size, &fine);
	free(corners);
	free(fine.depth);
	free(fine.rgb);
}
