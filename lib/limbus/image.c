#include "limbus/image.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"

/* How red an encoded colour is, -1..1; skin is redder than sclera under any light. */
static float redness(float r, float g, float b)
{
	return (r - b) / (r + g + b + 0.02f);
}

/* The redness of the whitest of what is light in the photograph: sclera, where an eye fills some of it. */
static float white_redness(const struct photo *photo)
{
	enum { SIDE = 96 };
	static const double LIGHT = 0.85, LOW = 0.08;  // quantiles
	double low[SIDE * SIDE], sorted[SIDE * SIDE], red[SIDE * SIDE];
	int n = 0, m = 0;
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			long x = (long)i * photo->width / SIDE, y = (long)j * photo->height / SIDE;
			const uint16_t *p = photo->rgb + 3 * (y * photo->width + x);
			red[n] = redness(p[0] / 65535.0f, p[1] / 65535.0f, p[2] / 65535.0f);
			low[n++] = fmin(p[0], fmin(p[1], p[2]));
		}
	memcpy(sorted, low, sizeof sorted);
	double cut = stats_quantile(n, sorted, LIGHT);
	for (int i = 0; i < n; i++)
		if (low[i] >= cut)
			red[m++] = red[i];
	/* a blue iris is no white, and no sclera is bluer than grey but under blue light, where skin is less red too */
	return (float)fmax(stats_quantile(m, red, LOW), 0);
}

struct planes {
	float *white, *bright, *tint;
};

/* One row of reduction cells: their mean colour, and from it the three planes. */
static void reduce_row(const struct planes *out, long *over, long *under, const struct photo *photo, int k, int row,
                       int width, float reference)
{
	static const float SPREAD = 0.06f;  // of redness, sclera to skin
	const int n = 3 * k * width;
	uint32_t *sum = mem_new((size_t)n, sizeof *sum);
	for (int y = row * k; y < (row + 1) * k; y++) {
		const uint16_t *p = photo->rgb + 3 * (size_t)y * (size_t)photo->width;
		for (int i = 0; i < n; i++)  // columns by themselves first: in step with memory
			sum[i] += p[i];
		uint32_t burnt = 0, black = 0;
		for (int i = 0; i < n; i += 3) {
			burnt += (p[i] > 64880) & (p[i + 1] > 64880);
			black += (p[i] < 655) & (p[i + 1] < 655) & (p[i + 2] < 655);
		}
		*over += burnt;
		*under += black;
	}
	const float scale = 1.0f / (65535.0f * (float)(k * k));
	for (int x = 0; x < width; x++) {
		uint32_t cell[3] = { 0 };
		for (int i = 0; i < k; i++)
			for (int c = 0; c < 3; c++)
				cell[c] += sum[3 * (k * x + i) + c];
		float r = (float)cell[0] * scale, g = (float)cell[1] * scale, b = (float)cell[2] * scale;
		float z = fmaxf(redness(r, g, b) - reference, 0) / SPREAD;
		out->tint[x] = 1 / (1 + z * z);
		out->white[x] = fminf(r, fminf(g, b)) * out->tint[x];
		out->bright[x] = fmaxf(r, fmaxf(g, b));
	}
	free(sum);
}

static struct grey halve(const struct grey *g)
{
	struct grey h = { g->width / 2, g->height / 2, g->x0, g->y0, 2 * g->scale, 0, 0 };
	h.px = mem_array((size_t)h.width * (size_t)h.height, sizeof *h.px);
	for (int y = 0; y < h.height; y++)
		for (int x = 0; x < h.width; x++) {
			const float *p = g->px + 2 * (long)y * g->width + 2 * x, *q = p + g->width;
			h.px[(long)y * h.width + x] = (p[0] + p[1] + q[0] + q[1]) / 4;
		}
	return h;
}

static struct grey empty(int width, int height, double scale)
{
	return (struct grey){ width, height, 0, 0, scale, mem_array((size_t)width * (size_t)height, sizeof(float)), 0 };
}

struct pyramid pyramid_make(const struct photo *photo)
{
	struct pyramid p = { .n = 1 };
	const int longer = photo->width > photo->height ? photo->width : photo->height;
	const int k = (longer + PYRAMID_LONG - 1) / PYRAMID_LONG, w = photo->width / k, h = photo->height / k;
	const float reference = white_redness(photo);
	p.level[0] = empty(w, h, k);
	p.bright[0] = empty(w, h, k);
	p.tint = empty(w, h, k);
	long over = 0, under = 0;
#pragma omp parallel for schedule(static) reduction(+ : over, under)
	for (int row = 0; row < h; row++) {
		const long at = (long)row * w;
		const struct planes out = { p.level[0].px + at, p.bright[0].px + at, p.tint.px + at };
		reduce_row(&out, &over, &under, photo, k, row, w, reference);
	}
	double n = (double)w * h * k * k;
	p.over = (double)over / n;
	p.under = (double)under / n;
	for (; p.n < PYRAMID_MAX; p.n++) {
		const struct grey *last = &p.level[p.n - 1];
		if ((last->width < last->height ? last->width : last->height) / 2 < PYRAMID_SHORT_MIN)
			break;
		p.level[p.n] = halve(last);
		p.bright[p.n] = halve(&p.bright[p.n - 1]);
	}
	return p;
}

void pyramid_free(struct pyramid *pyramid)
{
	for (int i = 0; i < pyramid->n; i++) {
		grey_free(&pyramid->level[i]);
		grey_free(&pyramid->bright[i]);
	}
	grey_free(&pyramid->tint);
	*pyramid = (struct pyramid){ 0 };
}

/* Linear light of every 16-bit code, once for all threads. */
static float decode[65536];
static void decode_fill(void)
{
	for (int i = 0; i < 65536; i++)
		decode[i] = linear_from_srgb((float)i / 65535.0f);
}

static const float *decode_table(void)
{
	static pthread_once_t once = PTHREAD_ONCE_INIT;
	pthread_once(&once, decode_fill);
	return decode;
}

enum { TILE = 8 };

/* How pixels are made, and of which tiles they are. */
struct grey_due {
	const struct photo *photo;
	int k;                // px of the photograph, each way, in one
	float weight[3];
	int across, down;     // tiles
	bool *made;           // [down][across]
	int *list;            // room for all tiles
};

static void make_tile(const struct grey *g, const struct grey_due *due, int tile)
{
	const float *table = decode_table();
	const int k = due->k, left = tile % due->across * TILE, top = tile / due->across * TILE;
	const int n = left + TILE < g->width ? TILE : g->width - left, end = top + TILE < g->height ? top + TILE : g->height;
	const long x0 = lround(g->x0) + (long)left * k, y0 = lround(g->y0);
	const float r = due->weight[0], green = due->weight[1], b = due->weight[2];
	for (int row = top; row < end; row++) {
		float sum[TILE] = { 0 };
		for (long y = y0 + (long)row * k; y < y0 + (long)(row + 1) * k; y++)
			for (int i = 0; i < k; i++) {  // pixels by themselves first: none waits for the one before
				const uint16_t *p = due->photo->rgb + 3 * (y * due->photo->width + x0 + i);
				for (int x = 0; x < n; x++, p += 3 * k)
					sum[x] += r * table[p[0]] + green * table[p[1]] + b * table[p[2]];
			}
		memcpy(g->px + (long)row * g->width + left, sum, (size_t)n * sizeof *sum);
	}
}

struct grey grey_linear(const struct photo *photo, const struct ellipse *e, double margin, double max_a,
                        const double weight[3])
{
	const double c = cos(e->angle), s = sin(e->angle);
	double hx = margin * hypot(e->a * c, e->b * s), hy = margin * hypot(e->a * s, e->b * c);
	int k = (int)ceil(e->a / max_a);
	k = k < 1 ? 1 : k;
	int x0 = (int)fmin(fmax(floor(e->cx - hx), 0), photo->width - 2 * k);
	int y0 = (int)fmin(fmax(floor(e->cy - hy), 0), photo->height - 2 * k);
	int x1 = (int)fmax(fmin(ceil(e->cx + hx), photo->width), x0 + 2 * k);
	int y1 = (int)fmax(fmin(ceil(e->cy + hy), photo->height), y0 + 2 * k);
	struct grey g = { (x1 - x0) / k, (y1 - y0) / k, x0, y0, k, 0, mem_new(1, sizeof *g.due) };
	const double norm = (double)k * k;
	g.px = mem_array((size_t)g.width * (size_t)g.height, sizeof *g.px);
	*g.due = (struct grey_due){ photo, k, { (float)(weight[0] / norm), (float)(weight[1] / norm), (float)(weight[2] / norm) },
		                    (g.width + TILE - 1) / TILE, (g.height + TILE - 1) / TILE, 0, 0 };
	const size_t tiles = (size_t)g.due->across * (size_t)g.due->down;
	g.due->made = mem_new(tiles, sizeof *g.due->made);
	g.due->list = mem_array(tiles, sizeof *g.due->list);
	return g;
}

/* The tile of a place along one side of n pixels, as grey_at clamps it. */
static int tile_of(double u, int n)
{
	return (int)fmin(fmax(u, 0), n - 1) / TILE;
}

void grey_need(const struct grey *g, int n, const double box[n][4])
{
	static const double BESIDE = 2;  // pixels between which grey_at reads, and what rounding may add
	struct grey_due *due = g->due;
	int want = 0;
	if (!due)
		return;
	for (int i = 0; i < n; i++) {
		const double *b = box[i], k = g->scale;
		const int x0 = tile_of((b[0] - g->x0) / k - BESIDE, g->width), x1 = tile_of((b[2] - g->x0) / k + BESIDE, g->width);
		const int y0 = tile_of((b[1] - g->y0) / k - BESIDE, g->height), y1 = tile_of((b[3] - g->y0) / k + BESIDE, g->height);
		for (int y = y0; y <= y1; y++)
			for (int x = x0; x <= x1; x++) {
				const int tile = y * due->across + x;
				if (!due->made[tile])
					due->list[want++] = tile;
				due->made[tile] = true;
			}
	}
#pragma omp parallel for schedule(static)
	for (int i = 0; i < want; i++)
		make_tile(g, due, due->list[i]);
}

void grey_free(struct grey *grey)
{
	if (grey->due) {
		free(grey->due->made);
		free(grey->due->list);
		free(grey->due);
	}
	free(grey->px);
	*grey = (struct grey){ 0 };
}

void photo_colour(double rgb[3], const struct photo *photo, double x, double y)
{
	int i = (int)fmin(fmax(x, 0), photo->width - 1), j = (int)fmin(fmax(y, 0), photo->height - 1);
	const uint16_t *p = photo->rgb + 3 * ((long)j * photo->width + i);
	for (int c = 0; c < 3; c++)
		rgb[c] = decode_table()[p[c]];
}
