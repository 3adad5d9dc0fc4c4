#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "sfm/cloud/cloud.h"

struct cell {
	uint64_t key;            // x, y, z of the cell, 21 bits each, plus 1; 0: empty
	float xyz[3], normal[3]; // weighted sums; xyz from the cell's corner
	float weight;
	uint16_t pairs, last;    // how many pairs have points here; the last of them, counted from 1
};

/* A hash table with open addressing, at most half full. */
struct cloud_grid {
	double origin[3], edge;
	long n, room;
	int pairs;
	struct cell *cells;
};

static uint64_t mix(uint64_t z)
{
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
	z = (z ^ z >> 27) * 0x94d049bb133111eb;
	return z ^ z >> 31;
}

static struct cell *find(const struct cloud_grid *g, uint64_t key)
{
	for (long i = (long)(mix(key) & (uint64_t)(g->room - 1));; i = (i + 1) & (g->room - 1))
		if (!g->cells[i].key || g->cells[i].key == key)
			return &g->cells[i];
}

static uint64_t key_of(const int at[3])
{
	return ((uint64_t)at[0] << 42 | (uint64_t)at[1] << 21 | (uint64_t)at[2]) + 1;
}

struct cloud_grid *cloud_grid_new(const struct sfm_subject *s, const struct cloud_conf *conf)
{
	struct cloud_grid *g = mem_new(1, sizeof *g);
	g->edge = conf->voxel * s->radius;
	// One cell of margin on each side, for the neighbours.
	for (int i = 0; i < 3; i++)
		g->origin[i] = s->center[i] - s->radius - 2 * g->edge;
	g->room = 1 << 16;
	g->cells = mem_new((size_t)g->room, sizeof *g->cells);
	return g;
}

void cloud_grid_free(struct cloud_grid *g)
{
	if (g)
		free(g->cells);
	free(g);
}

static void make_room(struct cloud_grid *g)
{
	if (2 * g->n < g->room)
		return;
	struct cell *was = g->cells;
	long n = g->room;
	g->room *= 2;
	g->cells = mem_new((size_t)g->room, sizeof *g->cells);
	for (long i = 0; i < n; i++)
		if (was[i].key)
			*find(g, was[i].key) = was[i];
	free(was);
}

void cloud_grid_add(struct cloud_grid *g, const struct cloud_points *points)
{
	enum { MOST = 1 << 21 };
	g->pairs = g->pairs < UINT16_MAX ? g->pairs + 1 : g->pairs;
	for (long i = 0; i < points->n; i++) {
		int at[3];
		bool inside = true;
		for (int k = 0; k < 3; k++) {
			double x = floor(((double)points->xyz[i][k] - g->origin[k]) / g->edge);
			inside &= x >= 0 && x < MOST;
			at[k] = inside ? (int)x : 0;
		}
		if (!inside)
			continue;
		make_room(g);
		uint64_t key = key_of(at);
		struct cell *c = find(g, key);
		g->n += !c->key;
		c->key = key;
		float w = points->weight[i];
		for (int k = 0; k < 3; k++) {
			c->xyz[k] += w * (float)((double)points->xyz[i][k] - g->origin[k] - at[k] * g->edge);
			c->normal[k] += w * points->normal[i][k];
		}
		c->weight += w;
		c->pairs = (uint16_t)(c->pairs + (c->last != g->pairs));
		c->last = (uint16_t)g->pairs;
	}
}

static int by_key(const void *a, const void *b)
{
	uint64_t x = (*(const struct cell *const *)a)->key, y = (*(const struct cell *const *)b)->key;
	return (x > y) - (x < y);
}

/* The largest number of pairs of any cell of the 3 x 3 x 3 neighbourhood. */
static int support(const struct cloud_grid *g, const int at[3])
{
	int most = 0;
	for (int i = 0; i < 27; i++) {
		int near[3] = { at[0] + i % 3 - 1, at[1] + i / 3 % 3 - 1, at[2] + i / 9 - 1 };
		const struct cell *c = find(g, key_of(near));
		most = c->key && c->pairs > most ? c->pairs : most;
	}
	return most;
}

void cloud_grid_points(struct cloud_points *out, const struct cloud_grid *g, const struct cloud_conf *conf)
{
	const struct cell **order = mem_array((size_t)g->n + 1, sizeof *order);
	long n = 0;
	for (long i = 0; i < g->room; i++)
		if (g->cells[i].key)
			order[n++] = &g->cells[i];
	qsort(order, (size_t)n, sizeof *order, by_key);
	*out = (struct cloud_points){ .room = n, .xyz = mem_new((size_t)n + 1, sizeof *out->xyz),
		                          .normal = mem_new((size_t)n + 1, sizeof *out->normal),
		                          .weight = mem_new((size_t)n + 1, sizeof *out->weight) };
	for (long i = 0; i < n; i++) {
		const struct cell *c = order[i];
		uint64_t key = c->key - 1;
		int at[3] = { (int)(key >> 42), (int)(key >> 21 & 0x1fffff), (int)(key & 0x1fffff) };
		double length = sqrt((double)c->normal[0] * (double)c->normal[0] + (double)c->normal[1] * (double)c->normal[1]
		                     + (double)c->normal[2] * (double)c->normal[2]);
		// Normals that cancel: no surface.
		if (support(g, at) < conf->min_pairs || !(length > 0.5 * (double)c->weight))
			continue;
		for (int k = 0; k < 3; k++) {
			out->xyz[out->n][k] = (float)(g->origin[k] + at[k] * g->edge + (double)(c->xyz[k] / c->weight));
			out->normal[out->n][k] = (float)((double)c->normal[k] / length);
		}
		out->weight[out->n++] = c->weight;
	}
	free(order);
}

struct head {
	char magic[8];
	double origin[3], edge;
	int64_t n;
	int32_t pairs, tag;
};

bool cloud_grid_save(const struct cloud_grid *g, const char *path, const char *tag, struct err *err)
{
	struct head head = { "EWCLOUD", { g->origin[0], g->origin[1], g->origin[2] }, g->edge, g->n, g->pairs, (int32_t)strlen(tag) };
	char *bytes = 0;
	size_t size = 0;
	FILE *f = open_memstream(&bytes, &size);
	fwrite(&head, sizeof head, 1, f);
	fwrite(tag, 1, strlen(tag), f);
	for (long i = 0; i < g->room; i++)
		if (g->cells[i].key)
			fwrite(&g->cells[i], sizeof g->cells[i], 1, f);
	fclose(f);
	bool ok = file_write(path, bytes, size, err);
	free(bytes);
	return ok;
}

/* Reads the cells behind the file's header; null where the file's size is not what that states. */
static struct cloud_grid *grid_of(const struct head *head, const char *cells, size_t size)
{
	if (head->n < 0 || (uint64_t)head->n != size / sizeof(struct cell) || size % sizeof(struct cell) || !(head->edge > 0))
		return 0;
	struct cloud_grid *g = mem_new(1, sizeof *g);
	memcpy(g->origin, head->origin, sizeof g->origin);
	g->edge = head->edge;
	g->pairs = head->pairs;
	for (g->room = 1 << 16; g->room < 2 * head->n + 2;)
		g->room *= 2;
	g->cells = mem_new((size_t)g->room, sizeof *g->cells);
	for (long i = 0; i < head->n; i++) {
		struct cell c;
		memcpy(&c, cells + (size_t)i * sizeof c, sizeof c);
		struct cell *to = find(g, c.key);
		g->n += c.key && !to->key;
		*to = c;
	}
	return g;
}

bool cloud_grid_load(struct cloud_grid **grid, char **tag, const char *path)
{
	const size_t limit = (size_t)4 << 30;
	struct err none = { 0 };
	struct head head = { 0 };
	char *data;
	size_t size;
	*grid = 0;
	*tag = 0;
	if (!file_exists(path) || !file_read(&data, &size, path, limit, &none))
		return false;
	if (size >= sizeof head)
		memcpy(&head, data, sizeof head);
	if (!memcmp(head.magic, "EWCLOUD", 8) && head.tag >= 0 && (size_t)head.tag <= size - sizeof head)
		*grid = grid_of(&head, data + sizeof head + head.tag, size - sizeof head - (size_t)head.tag);
	if (*grid)
		*tag = mem_printf("%.*s", head.tag, data + sizeof head);
	free(data);
	return *grid;
}

void cloud_grid_subject(struct sfm_subject *s, const struct cloud_grid *g, const struct cloud_conf *conf)
{
	s->radius = g->edge / conf->voxel;
	for (int i = 0; i < 3; i++)
		s->center[i] = g->origin[i] + s->radius + 2 * g->edge;
}

bool cloud_save(const struct cloud_points *p, const char *path, struct err *err)
{
	char *bytes = 0;
	size_t size = 0;
	FILE *f = open_memstream(&bytes, &size);
	fprintf(f, "ply\nformat binary_little_endian 1.0\nelement vertex %ld\nproperty float x\nproperty float y\n"
	           "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n", p->n);
	for (long i = 0; i < p->n; i++) {
		fwrite(p->xyz[i], sizeof p->xyz[i], 1, f);
		fwrite(p->normal[i], sizeof p->normal[i], 1, f);
	}
	fclose(f);
	bool ok = file_write(path, bytes, size, err);
	free(bytes);
	return ok;
}
