/* Blurs every level by its Gaussians and interpolates up to the picture, a band of rows at a time, so that the intermediate
 * rows stay in the core's cache. */
#include <omp.h>
#include <string.h>

#include "image/subsurface/impl.h"
#include "math/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

enum { BAND = 32 };

/* A thread's rows [y, y + n) of three planes. */
struct window {
	float *plane[3];
	int y, n, stride;
};

static float *window_row(const struct window *w, int c, int y)
{
	return w->plane[c] + (size_t)(y - w->y) * (size_t)w->stride;
}

/* Moves the buffer to rows [from, to), keeping those that it holds. Returns the first row that it lacks. */
static int window_move(struct window *w, int from, int to)
{
	int had = w->y + w->n, kept = had > from ? had - from : 0;
	for (int c = 0; c < 3 && kept && from > w->y; c++)
		memmove(w->plane[c], window_row(w, c, from), (size_t)kept * (size_t)w->stride * sizeof **w->plane);
	w->y = from;
	w->n = to - from;
	return from + kept;
}

/* A thread's buffers of a level: rows of its sum, including the levels below, and of each Gaussian's blur along x. */
struct state {
	const struct subsurface_level *level, *deepest;
	struct window sum, across[SUBSURFACE_MAX];
	float *mean;
	unsigned char *flat;  // of the level below: parts between two of its rows
};

static int wide(const struct subsurface_level *l)
{
	return (int)subsurface_rounded((size_t)l->width);
}

/* Numbers that a byte for each part of a row takes, with one more for a part that ends the row. */
static size_t flat_size(const struct subsurface_level *l)
{
	size_t bytes = (size_t)l->width / (2 * SUBSURFACE_PART) + 2;
	return (bytes / sizeof(float) / SUBSURFACE_ROUNDING + 1) * SUBSURFACE_ROUNDING;
}

/* Rows of level l's sum that a band of the picture needs. */
static int rows_of(int l)
{
	int n = BAND;
	for (int k = 0; k < l; k++)
		n = n / 2 + 2;
	return n;
}

size_t subsurface_sum_size(const struct subsurface_level *level, int deepest)
{
	size_t n = 0;
	for (int l = 0; l <= deepest; l++) {
		size_t rows = (size_t)rows_of(l) + 1;  // and one for means
		for (int i = 0; i < level[l].n; i++)
			rows += (size_t)(rows_of(l) + 2 * level[l].gauss[i].radius);
		n += 3 * rows * (size_t)wide(&level[l]) + flat_size(&level[l]);
	}
	return n;
}

static float *window_make(struct window *w, float *room, int rows, int stride)
{
	*w = (struct window){ .stride = stride };
	for (int c = 0; c < 3; c++, room += (size_t)rows * (size_t)stride)
		w->plane[c] = room;
	return room;
}

static void state_make(struct state *s, const struct subsurface_level *level, int deepest, float *room)
{
	for (int l = 0; l <= deepest; l++) {
		s[l].level = &level[l];
		s[l].deepest = &level[deepest];
		room = window_make(&s[l].sum, room, rows_of(l), wide(&level[l]));
		for (int i = 0; i < level[l].n; i++)
			room = window_make(&s[l].across[i], room, rows_of(l) + 2 * level[l].gauss[i].radius, wide(&level[l]));
		s[l].mean = room;
		room += 3 * wide(&level[l]);
		s[l].flat = (unsigned char *)room;
		room += flat_size(&level[l]);
	}
}

static void blur_x(const struct window *w, const struct subsurface_level *l, const struct subsurface_gauss *g, int y)
{
	size_t at = (size_t)y * (size_t)l->stride;
	struct subsurface_line line = { .z = l->in[3] + at, .n = w->stride, .step = 1, .z_step = 1, .from = -g->radius, .to = g->radius, .channels = g->channels };
	for (int c = 0; c < g->channels; c++) {
		line.in[c] = l->in[c] + at;
		line.out[c] = window_row(w, c, y);
		line.gain[c] = 1;
	}
	subsurface_line(&line, g);
}

static void blur_y(const struct window *out, const struct window *in, const struct subsurface_level *l, const struct subsurface_gauss *g, int y, bool adds)
{
	struct subsurface_line line = { .z = l->in[3] + (size_t)y * (size_t)l->stride, .n = out->stride, .step = in->stride, .z_step = l->stride, .channels = g->channels };
	line.from = y < g->radius ? -y : -g->radius;
	line.to = l->height - 1 - y < g->radius ? l->height - 1 - y : g->radius;
	line.adds = adds;
	for (int c = 0; c < g->channels; c++) {
		line.in[c] = window_row(in, c, y);
		line.out[c] = window_row(out, c, y);
		line.gain[c] = g->weight[c];
	}
	subsurface_line(&line, g);
}

SIMD_CLONES static void scale(float *restrict out, const float *restrict in, int n, float by)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] = by * in[i];
}

/* Adds the level's unblurred light and Gaussians to its sum, rows [from, to). */
static void blur(struct state *s, int from, int to)
{
	const struct subsurface_level *l = s->level;
	bool plain = l->plain[0] > 0 || l->plain[1] > 0 || l->plain[2] > 0;
	for (int c = l->n && !plain ? l->gauss[0].channels : 0; c < 3; c++)
		for (int y = from; y < to; y++)
			scale(window_row(&s->sum, c, y), l->in[c] + (size_t)y * (size_t)l->stride, l->width, l->plain[c]);
	for (int i = 0; i < l->n; i++) {
		const struct subsurface_gauss *g = &l->gauss[i];
		int first = from > g->radius ? from - g->radius : 0, end = to + g->radius < l->height ? to + g->radius : l->height;
		for (int y = window_move(&s->across[i], first, end); y < end; y++)
			blur_x(&s->across[i], l, g, y);
		for (int y = from; y < to; y++)
			blur_y(&s->sum, &s->across[i], l, g, y, i || plain);
	}
}

static void sum(struct state *s, int from, int to);

/* out = keep out + the interpolated level below, rows [from, to). */
static void join(struct state *s, const struct window *out, int from, int to, const float keep[3])
{
	const struct subsurface_level *lower = s[1].level;
	int end = to / 2 + 1 < lower->height ? to / 2 + 1 : lower->height;
	sum(&s[1], from > 1 ? (from - 1) / 2 : 0, end);
	for (int y = from; y < to; y++) {
		const float *below[2][4];
		float *rows[3];
		int upper = (y + 1) / 2 - 1, two[2] = { upper < 0 ? 0 : upper, upper + 1 < lower->height ? upper + 1 : lower->height - 1 };
		if (y == from || y % 2)
			subsurface_join_look(s->flat, s->level, lower, two);
		for (int k = 0; k < 2; k++) {
			int at = two[y % 2 ? k : 1 - k];
			for (int c = 0; c < 3; c++)
				below[k][c] = window_row(&s[1].sum, c, at);
			below[k][3] = lower->in[3] + (size_t)at * (size_t)lower->stride;
		}
		for (int c = 0; c < 3; c++)
			rows[c] = window_row(out, c, y);
		subsurface_join(rows, keep, s->level, lower, y, below, s->flat, s[1].mean);
	}
}

/* Computes rows [from, to) of the level's sum; from and to never decrease from one call to the next. */
static void sum(struct state *s, int from, int to)
{
	static const float all[3] = { 1, 1, 1 };
	int first = window_move(&s->sum, from, to);
	if (first == to)
		return;
	blur(s, first, to);
	if (s->level < s->deepest)
		join(s, &s->sum, first, to, all);
}

SIMD_CLONES static void give(float *restrict px, const float *restrict sum, const float *restrict z, int n, float keep)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		px[i] = z[i] > 0 ? keep * px[i] + sum[i] : px[i];
}

void subsurface_sum(const struct subsurface_level *level, int deepest, const struct subsurface_picture *p, const double stays[3],
                    struct subsurface_room *room)
{
	const float keep[3] = { (float)stays[0], (float)stays[1], (float)stays[2] };
	size_t each = subsurface_sum_size(level, deepest);
	float *rooms = subsurface_room_take(room, (size_t)omp_get_max_threads() * each);
#pragma omp parallel
	{
		struct state state[SUBSURFACE_LEVELS];
		const struct window out = { { p->rgb[0], p->rgb[1], p->rgb[2] }, 0, p->height, p->width };
		int threads = omp_get_num_threads(), own = omp_get_thread_num();
		int first = (int)((long)p->height * own / threads), end = (int)((long)p->height * (own + 1) / threads);
		state_make(state, level, deepest, rooms + (size_t)own * each);
		for (int from = first, to; from < end; from = to) {
			to = from + BAND < end ? from + BAND : end;
			if (deepest && !level->n) {
				join(state, &out, from, to, keep);
				continue;
			}
			sum(state, from, to);
			for (int y = from; y < to; y++)
				for (int c = 0; c < 3; c++)
					give(window_row(&out, c, y), window_row(&state->sum, c, y), level->in[3] + (size_t)y * (size_t)level->stride, p->width, keep[c]);
		}
	}
}
