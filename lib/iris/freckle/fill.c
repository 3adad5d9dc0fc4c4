#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "iris/freckle/freckle.h"
#include "iris/unrefract/rings.h"
#include "image/mask.h"

static const float seen = 0.02f, darkest = 1e-4f;

/* One blob to fill, in its own box of the map. */
struct patch {
	const struct image *rgbw;
	const uint8_t *mask;      // of the whole map
	struct sheet sheet;
	double mm, band;          // of a texel; of surroundings
	int x0, y0, w, h;
	uint8_t *kind;            // [h][w] HOLE, BAND or NEITHER
	float *source;            // [h][w][3] log colour of the pattern
	double phi;               // direction of the hole's middle
};
enum { NEITHER, BAND, HOLE };

/* A source region for a hole: the map turned by `turn` about the pupil, or mirrored about the hole's middle first. */
struct pattern {
	double turn;
	bool mirror;
	float offset[3];  // log colour of the place against the pattern, on the band
	double cost;
};

static void cubic(float w[4], float t)
{
	w[0] = t * (-0.5f + t * (1 - 0.5f * t));
	w[1] = 1 + t * t * (-2.5f + 1.5f * t);
	w[2] = t * (0.5f + t * (2 - 1.5f * t));
	w[3] = t * t * (-0.5f + 0.5f * t);
}

/* Log colour of the map at (x, y) px, bicubic; false where it is unseen or to be filled itself. */
static bool take(float out[3], const struct patch *p, double x, double y)
{
	float fx = (float)floor(x - 0.5), fy = (float)floor(y - 0.5), wx[4], wy[4], sum[3] = { 0 };
	int x0 = (int)fx - 1, y0 = (int)fy - 1, size = p->rgbw->width;
	if (x0 < 0 || y0 < 0 || x0 + 3 >= size || y0 + 3 >= size)
		return false;
	cubic(wx, (float)x - 0.5f - fx);
	cubic(wy, (float)y - 0.5f - fy);
	for (int j = 0; j < 4; j++)
		for (int i = 0; i < 4; i++) {
			const float *px = image_at(p->rgbw, x0 + i, y0 + j);
			if (px[3] < seen || p->mask[(long)(y0 + j) * size + x0 + i])
				return false;
			for (int c = 0; c < 3; c++)
				sum[c] += wy[j] * wx[i] * px[c];
		}
	for (int c = 0; c < 3; c++)
		out[c] = logf(fmaxf(sum[c], darkest));
	return true;
}

/* The same of the nearest texel: exact enough to compare regions. */
static bool take_nearest(float out[3], const struct patch *p, double x, double y)
{
	int size = p->rgbw->width, col = (int)x, row = (int)y;
	if (!(x >= 2 && y >= 2 && col < size - 2 && row < size - 2))
		return false;
	const float *px = image_at(p->rgbw, col, row);
	for (int c = 0; c < 3; c++)
		out[c] = logf(fmaxf(px[c], darkest));
	return px[3] >= seen && !p->mask[(long)row * size + col];
}

/* The pattern's log colour for texel (col, row) of the map. */
static bool take_pattern(float out[3], const struct patch *p, const struct pattern *pattern, int col, int row,
                         bool fine)
{
	double x = (col + 0.5) * p->mm - p->sheet.extent, y = (row + 0.5) * p->mm - p->sheet.extent, at[2];
	double phi = atan2(y - p->sheet.pupil.cy, x - p->sheet.pupil.cx);
	double from = pattern->mirror ? 2 * p->phi - phi + pattern->turn : phi + pattern->turn;
	sheet_point(at, &p->sheet, sheet_t(&p->sheet, x, y), from);
	double u = (at[0] + p->sheet.extent) / p->mm, v = (at[1] + p->sheet.extent) / p->mm;
	return fine ? take(out, p, u, v) : take_nearest(out, p, u, v);
}

/* Mismatch between the pattern and the band round the hole, after removing the mean colour; INFINITY where part of it is
 * unseen. */
static void judge(struct pattern *pattern, const struct patch *p, int stride, bool fine)
{
	double sum[3] = { 0 }, square[3] = { 0 };
	int n = 0;
	pattern->cost = INFINITY;
	for (int y = 0; y < p->h; y += stride)
		for (int x = 0; x < p->w; x += stride) {
			int kind = p->kind[y * p->w + x];
			float s[3];
			if (kind == NEITHER)
				continue;
			if (!take_pattern(s, p, pattern, p->x0 + x, p->y0 + y, fine))
				return;
			const float *px = image_at(p->rgbw, p->x0 + x, p->y0 + y);
			for (int c = 0; c < 3 && kind == BAND; c++) {
				double d = logf(fmaxf(px[c], darkest)) - s[c];
				sum[c] += d;
				square[c] += d * d;
			}
			n += kind == BAND;
		}
	if (n < 8)
		return;
	pattern->cost = 0;
	for (int c = 0; c < 3; c++) {
		double mean = sum[c] / n;
		pattern->offset[c] = (float)mean;
		// a change of the mean costs less than one of the pattern: Poisson blending removes it
		pattern->cost += square[c] / n - mean * mean + 0.3 * mean * mean;
	}
}

static double half_angle(const struct patch *p)
{
	double widest = 0;
	for (int y = 0; y < p->h; y++)
		for (int x = 0; x < p->w; x++) {
			if (p->kind[y * p->w + x] == NEITHER)
				continue;
			double dx = (p->x0 + x + 0.5) * p->mm - p->sheet.extent - p->sheet.pupil.cx;
			double dy = (p->y0 + y + 0.5) * p->mm - p->sheet.extent - p->sheet.pupil.cy;
			widest = fmax(widest, fabs(remainder(atan2(dy, dx) - p->phi, 2 * M_PI)));
		}
	return widest;
}

/* The best source region to either side, plain and mirrored: a coarse search, then a fine one about the best few. */
static struct pattern find_pattern(const struct patch *p, const struct freckle_conf *conf, double search)
{
	struct pattern best = { .cost = INFINITY };
	double near = 2 * half_angle(p), step = (search - near) / conf->candidates;
	int stride = p->w * p->h > 4000 ? 3 : 2;
	if (step <= 0)
		return best;
	struct pattern *all = mem_array((size_t)conf->candidates * 4, sizeof *all);
#pragma omp parallel for schedule(dynamic, 2)
	for (int i = 0; i < conf->candidates * 4; i++) {
		double turn = near + step * (i / 4 + 0.5);
		all[i] = (struct pattern){ .turn = i & 1 ? -turn : turn, .mirror = i & 2 };
		judge(&all[i], p, stride, false);
	}
	for (int i = 0; i < conf->candidates * 4; i++)
		if (all[i].cost < best.cost)
			best = all[i];
	free(all);
	if (isfinite(best.cost))
		judge(&best, p, stride, true);
	for (double d = step / 2; isfinite(best.cost) && d * 4 > p->mm; d /= 2)
		for (int side = -1; side <= 1; side += 2) {
			struct pattern try = best;
			try.turn += side * d;
			judge(&try, p, stride, true);
			if (try.cost < best.cost && fabs(try.turn) >= near)
				best = try;
		}
	return best;
}

/* The pattern with its offset; without a pattern, the mean of the band. */
static void lay_pattern(struct patch *p, const struct pattern *pattern)
{
	for (int y = 0; y < p->h; y++)
		for (int x = 0; x < p->w; x++) {
			float *s = p->source + 3 * ((long)y * p->w + x);
			if (p->kind[y * p->w + x] == NEITHER)
				continue;
			bool ok = isfinite(pattern->cost) && take_pattern(s, p, pattern, p->x0 + x, p->y0 + y, true);
			for (int c = 0; c < 3; c++)
				s[c] = ok ? s[c] + pattern->offset[c] : 0;
		}
}

/* The correction that makes the pattern in the hole meet the band without a step: the harmonic function with the difference
 * at the band as boundary values (Perez et al. 2003, Poisson image editing), by successive over-relaxation. */
static void membrane(float *add, const struct patch *p, int c)
{
	int w = p->w, h = p->h, n = w > h ? w : h;
	float omega = (float)(2 / (1 + sin(M_PI / (n + 1))));
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			long i = (long)y * w + x;
			const float *px = image_at(p->rgbw, p->x0 + x, p->y0 + y);
			add[i] = p->kind[i] == BAND ? logf(fmaxf(px[c], darkest)) - p->source[3 * i + c] : 0;
		}
	for (int iter = 0; iter < 3 * n; iter++)
		for (int y = 0; y < h; y++)
			for (int x = 0; x < w; x++) {
				long i = (long)y * w + x;
				if (p->kind[i] != HOLE)
					continue;
				float sum = 0;
				int k = 0;
				if (x > 0 && p->kind[i - 1])
					sum += add[i - 1], k++;
				if (x + 1 < w && p->kind[i + 1])
					sum += add[i + 1], k++;
				if (y > 0 && p->kind[i - w])
					sum += add[i - w], k++;
				if (y + 1 < h && p->kind[i + w])
					sum += add[i + w], k++;
				if (k)
					add[i] += omega * (sum / (float)k - add[i]);
			}
}

static void paint(struct image *rgbw, const struct patch *p)
{
	float *add = mem_array((size_t)p->w * (size_t)p->h, sizeof *add);
	for (int c = 0; c < 3; c++) {
		membrane(add, p, c);
		for (int y = 0; y < p->h; y++)
			for (int x = 0; x < p->w; x++) {
				long i = (long)y * p->w + x;
				if (p->kind[i] == HOLE)
					image_at(rgbw, p->x0 + x, p->y0 + y)[c] = expf(p->source[3 * i + c] + add[i]);
			}
	}
	free(add);
}

/* Box, hole and band of blob k. */
static bool patch_open(struct patch *p, const int *label, int k, const int box[4])
{
	int size = p->rgbw->width, reach = (int)ceil(p->band / p->mm) + 2;
	p->x0 = box[0] > reach ? box[0] - reach : 0;
	p->y0 = box[1] > reach ? box[1] - reach : 0;
	p->w = (box[2] + reach < size ? box[2] + reach + 1 : size) - p->x0;
	p->h = (box[3] + reach < size ? box[3] + reach + 1 : size) - p->y0;
	size_t n = (size_t)p->w * (size_t)p->h;
	p->kind = mem_array(n, 1);
	p->source = mem_new(3 * n, sizeof *p->source);
	double sx = 0, sy = 0;
	for (int y = 0; y < p->h; y++)
		for (int x = 0; x < p->w; x++) {
			bool hole = label[(long)(p->y0 + y) * size + p->x0 + x] == k;
			p->kind[y * p->w + x] = hole;
			sx += hole ? (p->x0 + x + 0.5) * p->mm - p->sheet.extent - p->sheet.pupil.cx : 0;
			sy += hole ? (p->y0 + y + 0.5) * p->mm - p->sheet.extent - p->sheet.pupil.cy : 0;
		}
	p->phi = atan2(sy, sx);
	mask_grow(p->kind, p->w, p->h, p->band / p->mm);
	bool any = false;
	for (int y = 0; y < p->h; y++)
		for (int x = 0; x < p->w; x++) {
			long i = (long)(p->y0 + y) * size + p->x0 + x;
			uint8_t *kind = &p->kind[y * p->w + x];
			bool clear = !p->mask[i] && p->rgbw->px[4 * i + 3] >= seen;
			*kind = label[i] == k ? HOLE : *kind && clear ? BAND : NEITHER;
			any |= *kind == BAND;
		}
	return any;
}

int freckle_fill(struct image *rgbw, const uint8_t *mask, double extent, const struct circle *pupil, double limbus,
                 const struct freckle_conf *conf)
{
	int size = rgbw->width, filled = 0;
	int *label = mem_array((size_t)size * (size_t)size, sizeof *label);
	int count = mask_label(label, mask, size, size);
	int(*box)[4] = mem_array((size_t)count + 1, sizeof *box);
	for (int k = 0; k <= count; k++)
		box[k][0] = box[k][1] = size, box[k][2] = box[k][3] = -1;
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			int *b = box[label[(long)y * size + x]];
			b[0] = x < b[0] ? x : b[0], b[2] = x > b[2] ? x : b[2];
			b[1] = y < b[1] ? y : b[1], b[3] = y > b[3] ? y : b[3];
		}
	struct image before = image_new(size, size, 4);
	memcpy(before.px, rgbw->px, (size_t)size * (size_t)size * 4 * sizeof(float));
	for (int k = 1; k <= count; k++) {
		struct patch p = { .rgbw = &before, .mask = mask, .sheet = { size, extent, *pupil, limbus, 0 },
			           .mm = 2 * extent / size, .band = conf->band };
		if (patch_open(&p, label, k, box[k])) {
			struct pattern pattern = find_pattern(&p, conf, conf->search_deg * M_PI / 180);
			if (!isfinite(pattern.cost))
				pattern = find_pattern(&p, conf, M_PI);
			lay_pattern(&p, &pattern);
			paint(rgbw, &p);
			filled++;
		}
		free(p.kind);
		free(p.source);
	}
	image_free(&before);
	free(box);
	free(label);
	return filled;
}
