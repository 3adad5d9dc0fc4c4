#include "track/clip/film.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"

struct film *film_new(const struct track_clip *clip, const struct track_subject *s, const struct track_points *points)
{
	struct film *film = mem_new(1, sizeof *film);
	int size[2] = { clip->info.width, clip->info.height };
	double low[2] = { size[0], size[1] }, high[2] = { 0, 0 };
	for (int i = 0; i < points->n + SIDES * OPENING_POINTS; i++) {
		int e = (i - points->n) / OPENING_POINTS;
		double px[2];
		if (i < points->n)
			memcpy(px, points->points.at[i], sizeof px);
		else if (!clip->eye_seen[e] || !s->opening[e].open
		         || !head_project(px, &clip->camera, clip->cam_from_head, s->opening[e].edge[(i - points->n) % OPENING_POINTS]))
			continue;
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], px[k]);
			high[k] = fmax(high[k], px[k]);
		}
	}
	double edge = 0.08 * (high[0] - low[0]);
	film->x0 = (int)fmax(0, low[0] - edge);
	film->y0 = (int)fmax(0, low[1] - edge);
	int w = (int)fmin(size[0], high[0] + edge) - film->x0, h = (int)fmin(size[1], high[1] + edge) - film->y0;
	film->step = (w + FILM_WIDTH - 1) / FILM_WIDTH;
	film->step = film->step < 1 ? 1 : film->step;
	film->width = w / film->step > 0 ? w / film->step : 1;
	film->height = h / film->step > 0 ? h / film->step : 1;
	for (film->every = 1; clip->info.frames > (long)film->every * FILM_MOST;)
		film->every *= 2;
	return film;
}

/* Drops every second picture. */
static void thin(struct film *film)
{
	int n = 0;
	film->every *= 2;
	for (int i = 0; i < film->n; i++) {
		if (film->frame[i] % film->every) {
			free(film->px[i]);
			continue;
		}
		film->frame[n] = film->frame[i];
		film->px[n++] = film->px[i];
	}
	film->n = n;
}

SIMD_CLONES static void down_row(unsigned *restrict down, const uint8_t *restrict from, int n)
{
	SIMD_LOOP
	for (int x = 0; x < n; x++)
		down[x] += from[x];
}

/* Means of s sums each; share: 2^32 / (s * s), rounded up. */
static void means(uint8_t *restrict to, const unsigned *restrict down, int n, int s, uint64_t share)
{
	for (int x = 0; x < n; x++) {
		unsigned sum = 0;
		for (int u = 0; u < s; u++)
			sum += down[x * s + u];
		to[x] = (uint8_t)(sum * share >> 32);
	}
}

SIMD_CLONES static void means_of_two(uint8_t *restrict to, const unsigned *restrict down, int n)
{
	SIMD_LOOP
	for (int x = 0; x < n; x++)
		to[x] = (uint8_t)((down[2 * x] + down[2 * x + 1]) >> 2);
}

void film_add(struct film *film, const struct video_frame *f)
{
	if (f->index % film->every)
		return;
	if (film->n == FILM_MOST)
		thin(film);
	if (f->index % film->every)
		return;
	uint8_t *to = film->px[film->n] = mem_array((size_t)film->width * (size_t)film->height, 1);
	film->frame[film->n++] = f->index;
	int s = film->step, wide = film->width * s;
	const uint64_t share = (UINT64_C(1) << 32) / (uint64_t)(s * s) + 1;  // of a cell, in 2^-32: no division a pixel
	unsigned *down = mem_array((size_t)wide + 1, sizeof *down);
	for (int y = 0; y < film->height; y++) {
		memset(down, 0, (size_t)wide * sizeof *down);
		for (int v = 0; v < s; v++) {
			const uint8_t *from = f->luma + (long)(film->y0 + y * s + v) * f->luma_stride + film->x0;
			down_row(down, from, wide);
		}
		if (s == 2)
			means_of_two(to + (long)y * film->width, down, film->width);
		else
			means(to + (long)y * film->width, down, film->width, s, share);
	}
	free(down);
}

void film_pack(struct pack *pack, struct film *film, long first)
{
	const size_t area = (size_t)film->width * (size_t)film->height;
	struct film was = *film;
	int known = 0;
	PACK(pack, film->every);
	PACK(pack, film->n);
	PACK(pack, film->frame);
	pack->bad = pack->bad || film->n < 0 || film->n > FILM_MOST;
	film->n = pack->bad ? 0 : film->n;
	for (int i = 0; i < film->n; i++) {
		// one that is no longer kept was thinned out
		for (; pack->reading && known < was.n && was.frame[known] < film->frame[i]; known++)
			free(was.px[known]);
		if (film->frame[i] < first && pack->reading) {
			pack->bad = pack->bad || known == was.n || was.frame[known] != film->frame[i];
			film->px[i] = pack->bad ? mem_new(area, 1) : was.px[known++];
			continue;
		}
		if (pack->reading)
			film->px[i] = mem_new(area, 1);
		if (film->frame[i] >= first)
			pack_bytes(pack, film->px[i], area);
	}
	for (; pack->reading && known < was.n; known++)
		free(was.px[known]);
}

void film_free(struct film *film)
{
	if (!film)
		return;
	for (int i = 0; i < film->n; i++)
		free(film->px[i]);
	free(film);
}
