#include "image/subsurface/impl.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void subsurface_gauss_make(struct subsurface_gauss *g, double variance, double texels_per_mm, const double weight[3])
{
	double sum = 0, w[2 * SUBSURFACE_RADIUS + 1], inner = variance;
	*g = (struct subsurface_gauss){
		.radius = (int)fmin(fmax(ceil(2.3 * sqrt(variance)), 1), SUBSURFACE_RADIUS),
		.channels = weight[2] > 0 ? 3 : weight[1] > 0 ? 2 : 1,
		.weight = { (float)weight[0], (float)weight[1], (float)weight[2] },
	};
	for (int round = 0; round < 20; round++) {  // corrects for the truncation: the variance of the taps is the one asked for
		double second = 0;
		sum = 0;
		for (int k = -g->radius; k <= g->radius; k++) {
			sum += w[k + g->radius] = exp(-k * k / (2 * inner));
			second += k * k * w[k + g->radius];
		}
		inner *= variance * sum / second;
	}
	for (int k = 0; k <= 2 * g->radius; k++) {
		double root = sqrt(sqrt(w[k] / sum));
		g->root[k] = (float)root;
		g->fall[k] = (float)(root * texels_per_mm * texels_per_mm / (8 * variance));
	}
}

void subsurface_room_make(struct subsurface_room *room, size_t n)
{
	if (room->n < n) {
		free(room->px);
		*room = (struct subsurface_room){ mem_array(n, sizeof *room->px), n, 0 };
	}
	room->used = 0;
}

void subsurface_room_free(struct subsurface_room *room)
{
	free(room->px);
	*room = (struct subsurface_room){ 0 };
}

float *subsurface_room_take(struct subsurface_room *room, size_t n)
{
	float *px = room->px + room->used;
	room->used += subsurface_rounded(n);
	assert(room->used <= room->n);
	return px;
}

static size_t even_size(const struct subsurface_level *l)
{
	return ((size_t)l->parts * (size_t)l->height + 3) / 4;
}

size_t subsurface_level_size(struct subsurface_level *l, int width, int height, bool top)
{
	int radius = 0;
	for (int i = 0; i < l->n; i++)
		radius = l->gauss[i].radius > radius ? l->gauss[i].radius : radius;
	l->width = width;
	l->height = height;
	l->side = (int)subsurface_rounded((size_t)radius);
	l->stride = top && !l->n ? width : 2 * l->side + (int)subsurface_rounded((size_t)width);
	l->parts = top ? 0 : (width + SUBSURFACE_PART - 1) / SUBSURFACE_PART;
	return top && !l->n ? 0 : 4 * subsurface_rounded((size_t)l->stride * (size_t)height) + subsurface_rounded(even_size(l));
}

void subsurface_level_sides(const struct subsurface_level *l, int y)
{
	for (int k = 0; k < 4; k++) {
		float *row = l->own[k] + (size_t)y * (size_t)l->stride;
		memset(row - l->side, 0, (size_t)l->side * sizeof *row);
		memset(row + l->width, 0, (size_t)(l->stride - l->side - l->width) * sizeof *row);
	}
}

/* Copies the picture into level 0, with empty borders. */
static void copy(const struct subsurface_level *l, const struct subsurface_picture *p)
{
#pragma omp parallel for schedule(static)
	for (int y = 0; y < l->height; y++) {
		for (int k = 0; k < 4; k++)
			memcpy(l->own[k] + (size_t)y * (size_t)l->stride, (k < 3 ? p->rgb[k] : p->depth) + (size_t)y * (size_t)l->width,
			       (size_t)l->width * sizeof *p->depth);
		subsurface_level_sides(l, y);
	}
}

void subsurface_level_fill(struct subsurface_level *level, int deepest, const struct subsurface_picture *p, struct subsurface_room *room)
{
	for (int l = 0; l <= deepest; l++) {
		bool given = !l && !level->n;
		for (int k = 0; k < 4; k++) {
			level[l].own[k] = given ? 0 : subsurface_room_take(room, (size_t)level[l].stride * (size_t)level[l].height) + level[l].side;
			level[l].in[k] = !given ? level[l].own[k] : k < 3 ? p->rgb[k] : p->depth;
		}
		level[l].even = l ? (unsigned char *)subsurface_room_take(room, even_size(&level[l])) : 0;
	}
	if (level->n)
		copy(level, p);
}
