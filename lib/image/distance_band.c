/* The distance field's own method. Along each column the distance to the nearest edge of skin, by one scan down and
 * one up; then along each row the smallest of k^2 + v^2 over the columns k away, nearest first, until no column
 * farther away can be nearer. Both passes are exact (separability of the squared distance: Saito and Toriwaki 1994). */
#include "image/distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"

enum { LANES = 16, STRIP = 64, OF_STRIP = STRIP / LANES };
static const float FAR = 1e6f;  // px; its square and a little more are still numbers

/* The part of the screen that holds globe, widened by the band on each side and to whole strips of columns. */
struct window {
	int x0, y0, width, height;  // px; width a multiple of STRIP; x0 may lie off the screen
	int band;                   // px
	int from, to;               // blocks of LANES texels that hold globe
	float *v;                   // [height][width] distance to the nearest edge in the column, + downwards; where it is set
	uint8_t *near;              // [height][width / LANES] whether the block has an edge within the band, in its columns
	uint8_t *set;               // [height][width / STRIP] whether the strip has
};

static bool globe_rows(struct window *w, const struct distance_scene *s)
{
	int left = s->width, right = -1, top = s->height, bottom = -1;
	for (int y = 0; y < s->height; y++) {
		const uint8_t *m = s->material + (size_t)y * (size_t)s->width;
		const uint8_t *from = memchr(m, DISTANCE_GLOBE, (size_t)s->width);
		if (!from)
			continue;
		const uint8_t *to = memrchr(m, DISTANCE_GLOBE, (size_t)s->width);
		left = from - m < left ? (int)(from - m) : left;
		right = to - m > right ? (int)(to - m) : right;
		top = top < y ? top : y;
		bottom = y;
	}
	*w = (struct window){ .x0 = left, .y0 = top, .height = bottom - top + 1, .width = right - left + 1 };
	return right >= 0;
}

/* Largest distance in px that `reach` is anywhere on the globe. */
static double reach_px(const struct distance_scene *s, const struct window *w, double reach)
{
	double nearest = INFINITY;
	if (!s->depth)
		return reach;
	for (int y = w->y0; y < w->y0 + w->height; y++)
		for (int x = w->x0; x < w->x0 + w->width && x < s->width; x++) {
			size_t i = (size_t)y * (size_t)s->width + (size_t)x;
			if (s->material[i] == DISTANCE_GLOBE && s->depth[i] > 0)
				nearest = fmin(nearest, s->depth[i]);
		}
	return reach * s->focal_px / nearest;
}

static float *row_of(const struct window *w, int y)
{
	return w->v + (size_t)y * (size_t)w->width;
}

/* n materials from (x0, y) on; what is off the screen is neither skin nor globe. */
static bool material_row(uint8_t *restrict out, const struct distance_scene *s, int y, int x0, int n)
{
	int from = x0 < 0 ? -x0 : 0, to = x0 + n > s->width ? s->width - x0 : n;
	if (to - from < n || y < 0 || y >= s->height)
		memset(out, DISTANCE_OTHER, (size_t)n);
	if (y < 0 || y >= s->height || to <= from)
		return false;
	memcpy(out + from, s->material + (size_t)y * (size_t)s->width + (size_t)(x0 + from), (size_t)(to - from));
	return memchr(out + from, DISTANCE_SKIN, (size_t)(to - from)) != 0;
}

static void cover_row(float *restrict out, const struct distance_scene *s, int y, int x0, int n)
{
	int from = x0 < 0 ? -x0 : 0, to = x0 + n > s->width ? s->width - x0 : n;
	memset(out, 0, (size_t)n * sizeof *out);
	if (y >= 0 && y < s->height && to > from)
		memcpy(out + from, s->coverage + (size_t)y * (size_t)s->width + (size_t)(x0 + from), (size_t)(to - from) * sizeof *out);
}

/* Where the edge runs between four texels of a line, the middle two of which are skin and not: distance from the third
 * one's centre towards skin. A straight edge that leaves the outer two whole lies where their sum says, whatever its
 * slope; a steeper one is a long ramp, and lies where one half is crossed. */
SIMD_INLINE float crossing(float beyond, float skin, float other, float behind)
{
	float drop = skin - other, ramp = (0.5f - other) / (drop > 1e-6f ? drop : 1);
	float t = beyond > 0.99f && behind < 0.01f ? 2.5f - (beyond + skin + other + behind) : ramp;
	return t < 0 ? 0 : t > 1 ? 1 : t;
}

/* One step of a scan: distance to the last edge, from that of the row before. On a mask an edge lies at the centre of
 * the skin's texel, as the discrete transform has it. */
SIMD_CLONES static void scan_mask(float *restrict d, const uint8_t *restrict here)
{
	SIMD_LOOP
	for (int i = 0; i < STRIP; i++)
		d[i] = here[i] == DISTANCE_SKIN ? 0 : d[i] + 1;
}

/* With coverage: rows two before, before, here and after. */
SIMD_CLONES static void scan_fine(float *restrict d, const uint8_t *restrict before, const uint8_t *restrict here,
                                  float (*restrict cover)[STRIP])
{
	SIMD_LOOP
	for (int i = 0; i < STRIP; i++) {
		float t = crossing(cover[0][i], cover[1][i], cover[2][i], cover[3][i]);
		d[i] = here[i] == DISTANCE_SKIN ? 0 : before[i] == DISTANCE_SKIN ? t : d[i] + 1;
	}
}

/* Joins the scan up with the one down and marks what lies within the band; the first to come sets the row. */
SIMD_CLONES static void join(float *restrict v, const float *restrict d, bool up, bool first)
{
	SIMD_LOOP
	for (int i = 0; i < STRIP; i++) {
		float old = first ? FAR : fabsf(v[i]), now = up ? d[i] : -d[i];
		v[i] = d[i] < old ? now : first ? FAR : v[i];
	}
}

/* One scan of a strip of columns. Rows farther than the band from any skin of the strip are passed over. */
static void scan(struct window *w, const struct distance_scene *s, int strip, bool up)
{
	int strips = w->width / STRIP, x = w->x0 + strip * STRIP, step = up ? -1 : 1;
	uint8_t rows[2][STRIP], *before = rows[0], *here = rows[1];
	float d[STRIP], cover[4][STRIP];
	bool was = material_row(before, s, w->y0 + (up ? w->height : -1), x, STRIP);
	int since = w->band + 2;  // rows since the last one with skin
	for (int i = 0; i < STRIP; i++)
		d[i] = FAR;
	for (int y = up ? w->height - 1 : 0; y >= 0 && y < w->height; y += step) {
		bool skin = material_row(here, s, w->y0 + y, x, STRIP);
		since = skin || was ? 0 : since + 1;
		if (since <= w->band) {
			uint8_t *set = w->set + (size_t)y * (size_t)strips + (size_t)strip;
			for (int k = 0; s->coverage && was && k < 4; k++)
				cover_row(cover[k], s, w->y0 + y + (k - 2) * step, x, STRIP);
			if (s->coverage && was)
				scan_fine(d, before, here, cover);
			else
				scan_mask(d, here);
			join(row_of(w, y) + strip * STRIP, d, up, !*set);
			*set = 1;
		}
		uint8_t *swap = before;
		before = here;
		here = swap;
		was = skin;
	}
}

/* Both scans of a strip, then the marks of its blocks. */
static void columns(struct window *w, const struct distance_scene *s, int strip)
{
	float band = (float)w->band;
	int strips = w->width / STRIP;
	scan(w, s, strip, false);
	scan(w, s, strip, true);
	for (int y = 0; y < w->height; y++) {
		const float *v = row_of(w, y) + strip * STRIP;
		uint8_t *near = w->near + (size_t)(y * strips + strip) * OF_STRIP;
		for (int b = 0; b < OF_STRIP && w->set[y * strips + strip]; b++) {
			int any = 0;
			for (int i = 0; i < LANES; i++)
				any |= fabsf(v[b * LANES + i]) <= band;
			near[b] = (uint8_t)any;
		}
	}
}

/* A block of texels on its way: squared distance in px, and where across what is nearest lies, relative to each: its
 * column, and the edge in it or before it. */
struct block {
	float best[LANES], column[LANES], edge[LANES];
};

/* The columns k to one side: side is 1 or -1. cover: coverage of the row, aligned with v; null on a mask. */
SIMD_INLINE void look(struct block *restrict b, const float *restrict v, const float *restrict cover, int k, int side)
{
	const float *there = v + side * k;
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float reach = (float)k;
		if (cover) {  // skin in this very row: its edge lies before the texel's centre
			const float *c = cover + i + side * k;
			float t = crossing(c[side], c[0], c[-side], c[-2 * side]);
			reach = there[i] == 0 && there[i - side] != 0 ? (float)(k - 1) + t : reach;
		}
		float d = reach * reach + there[i] * there[i];
		b->edge[i] = d < b->best[i] ? (float)side * reach : b->edge[i];
		b->column[i] = d < b->best[i] ? (float)(side * k) : b->column[i];
		b->best[i] = d < b->best[i] ? d : b->best[i];
	}
}

/* The row pass for one block; returns how many columns were looked at on each side. Whether any farther column can be
 * nearer is asked every ROUND columns. */
SIMD_INLINE int row_pass(struct block *out, const float *restrict v, const float *restrict cover, int band)
{
	struct block now, *b = &now;
	enum { ROUND = 4 };
	float most = (float)(band * band);
	for (int i = 0; i < LANES; i++) {
		b->best[i] = v[i] * v[i];
		b->column[i] = b->edge[i] = 0;
	}
	for (int from = 1; from <= band; from += ROUND) {
		float worst = 0, least = (float)((from - (cover != 0)) * (from - (cover != 0)));
#pragma omp simd reduction(max : worst)
		for (int i = 0; i < LANES; i++)
			worst = b->best[i] > worst ? b->best[i] : worst;
		if (worst <= least || most < least) {
			band = from - 1;
			break;
		}
		for (int k = from; k < from + ROUND && k <= band; k++) {
			look(b, v, cover, k, 1);
			look(b, v, cover, k, -1);
		}
	}
	*out = now;
	return band;
}

SIMD_CLONES static int row_pass_mask(struct block *out, const float *v, int band)
{
	return row_pass(out, v, 0, band);
}

SIMD_CLONES static int row_pass_fine(struct block *out, const float *v, const float *cover, int band)
{
	return row_pass(out, v, cover, band);
}

/* Between the edges found in two neighbouring columns runs the edge itself: the nearest point of that segment, where
 * both belong to one edge. Only with coverage: a mask's texels are points. */
static void refine(float *d2, float off[2], const float *v, int column)
{
	enum { BREAK = 4 };  // px in one column: steeper is another edge
	float a[2] = { off[0], off[1] };
	if (a[1] == 0)
		return;  // an edge in the texel's own row
	for (int side = -1; side <= 1; side += 2) {
		float b1 = v[column + side];
		if (b1 == 0 || b1 * a[1] < 0 || fabsf(b1 - a[1]) > BREAK)
			continue;
		float ex = (float)side, ey = b1 - a[1];
		float t = -(a[0] * ex + a[1] * ey) / (ex * ex + ey * ey);
		t = t < 0 ? 0 : t > 1 ? 1 : t;
		float x = a[0] + t * ex, y = a[1] + t * ey, d = x * x + y * y;
		if (d < *d2) {
			*d2 = d;
			off[0] = x;
			off[1] = y;
		}
	}
}

/* World distance between a texel and the skin at `off` px from it (eq. 4.21). */
static float in_world(const struct distance_scene *s, int x, int y, const float off[2], float d2)
{
	if (!s->depth)
		return sqrtf(d2);
	float length = sqrtf(d2), out = length > 0 ? 0.5f / length : 0;  // onto the skin's side of its edge
	int u = (int)floorf((float)x + 0.5f + off[0] * (1 + out)), w = (int)floorf((float)y + 0.5f + off[1] * (1 + out));
	u = u < 0 ? 0 : u >= s->width ? s->width - 1 : u;
	w = w < 0 ? 0 : w >= s->height ? s->height - 1 : w;
	double z[2] = { s->depth[(size_t)y * (size_t)s->width + (size_t)x], s->depth[(size_t)w * (size_t)s->width + (size_t)u] };
	double at[2] = { x + 0.5 - s->center_px[0], y + 0.5 - s->center_px[1] }, sum = (z[1] - z[0]) * (z[1] - z[0]);
	for (int k = 0; k < 2; k++) {
		double d = ((at[k] + (double)off[k]) * z[1] - at[k] * z[0]) / s->focal_px;
		sum += d * d;
	}
	return (float)sqrt(sum);
}

struct result {
	float *out, (*nearest)[2];
	double reach;
};

/* What the row pass found, into the texels of one block. */
static void give(const struct result *to, const struct window *w, const struct distance_scene *s, const struct block *b,
                 const float *v, int y, int x)
{
	float most = (float)(w->band * w->band);
	for (int i = 0; i < LANES && x + i < s->width; i++) {
		size_t at = (size_t)y * (size_t)s->width + (size_t)(x + i);
		if (s->material[at] != DISTANCE_GLOBE || b->best[i] > most)
			continue;
		float off[2] = { b->edge[i], v[i + (int)b->column[i]] }, d2 = b->best[i];
		if (s->coverage)
			refine(&d2, off, v + i, (int)b->column[i]);
		float d = in_world(s, x + i, y, off, d2);
		if ((double)d > to->reach)
			continue;
		to->out[at] = d;
		if (to->nearest)
			memcpy(to->nearest[at], off, sizeof off);
	}
}

/* Globe's texels of a row, far from all skin until something nearer is found. */
SIMD_CLONES static void start_row(float *restrict out, const uint8_t *restrict material, int n)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] = material[i] == DISTANCE_GLOBE ? INFINITY : out[i];
}

/* Strips of a row that a block near an edge looks into, but have none themselves. */
static void fill_gaps(struct window *w, int y, int reach)
{
	int strips = w->width / STRIP;
	const uint8_t *set = w->set + (size_t)y * (size_t)strips;
	for (int k = 0; k < strips; k++) {
		int from = k > reach ? k - reach : 0, n = (k + reach < strips ? k + reach + 1 : strips) - from;
		float *v = row_of(w, y) + k * STRIP;
		for (int i = 0; i < STRIP && !set[k] && memchr(set + from, 1, (size_t)n); i++)
			v[i] = FAR;
	}
}

/* The next block from n on that has an edge in it or within `wide` blocks of it; `to` where there is none. */
static int next_near(const uint8_t *near, int n, int wide, int to)
{
	const uint8_t *p = memchr(near + n - wide, 1, (size_t)(to + wide - (n - wide)));
	int at = p ? (int)(p - near) - wide : to;
	return at > n ? at : n;
}

/* Every block of one row that has an edge near it; returns the texture reads. */
static double one_row(const struct result *to, struct window *w, const struct distance_scene *s, int y)
{
	int blocks = w->width / LANES, wide = (w->band + LANES) / LANES, x0 = w->x0 + w->from * LANES, x1 = w->x0 + w->to * LANES;
	const uint8_t *near = w->near + (size_t)y * (size_t)blocks;
	size_t at = (size_t)(w->y0 + y) * (size_t)s->width;
	bool any = memchr(near, 1, (size_t)blocks) != 0;
	float cover[s->coverage && any ? w->width : 1];
	double reads = 0;
	start_row(to->out + at + x0, s->material + at + x0, (x1 < s->width ? x1 : s->width) - x0);
	if (any)
		fill_gaps(w, y, (w->band + LANES) / STRIP + 1);
	if (any && s->coverage)
		cover_row(cover, s, w->y0 + y, w->x0, w->width);
	for (int n = w->from; any && (n = next_near(near, n, wide, w->to)) < w->to; n++) {
		int x = w->x0 + n * LANES;
		const float *v = row_of(w, y) + n * LANES;
		struct block b;
		if (!memchr(s->material + at + x, DISTANCE_GLOBE, (size_t)(s->width - x < LANES ? s->width - x : LANES)))
			continue;
		int k = s->coverage ? row_pass_fine(&b, v, cover + n * LANES, w->band) : row_pass_mask(&b, v, w->band);
		give(to, w, s, &b, v, w->y0 + y, x);
		reads += LANES * (1 + 2.0 * k) * (s->coverage ? 2 : 1);
	}
	return reads;
}

/* The globe's window widened by all that the passes look into. */
static void widen(struct window *w, const struct distance_scene *s, double reach)
{
	int far = s->width > s->height ? s->width : s->height, end;
	double px = ceil(reach_px(s, w, reach));
	w->band = px < far ? (int)px : far;
	int pad = (w->band + 3 * LANES) / LANES * LANES, wide = w->width;
	w->from = pad / LANES;
	w->to = w->from + (wide + LANES - 1) / LANES;
	w->x0 -= pad;
	w->width = (w->to * LANES + pad + STRIP - 1) / STRIP * STRIP;
	end = w->y0 + w->height + w->band;
	w->y0 = w->y0 > w->band ? w->y0 - w->band : 0;
	w->height = (end < s->height ? end : s->height) - w->y0;
}

static void count(struct distance_cost *cost, const struct distance_scene *s, double reads)
{
	size_t n = (size_t)s->width * (size_t)s->height;
	*cost = (struct distance_cost){ .reads = reads };
	for (size_t i = 0; i < n; i++)
		cost->texels += s->material[i] == DISTANCE_GLOBE;
}

void distance_band(float *out, float (*nearest)[2], const struct distance_scene *s, double reach, struct distance_cost *cost)
{
	struct result to = { out, nearest, reach };
	struct window w;
	double reads = 0;
	if (globe_rows(&w, s)) {
		widen(&w, s, reach);
		int strips = w.width / STRIP;
		size_t rows = (size_t)w.height;
		w.v = mem_array(rows * (size_t)w.width, sizeof *w.v);
		w.near = mem_new(rows * (size_t)(w.width / LANES), 1);
		w.set = mem_new(rows * (size_t)strips, 1);
		reads = (s->coverage ? 4.0 : 2.0) * w.width * w.height;
#pragma omp parallel reduction(+ : reads)
		{
#pragma omp for schedule(dynamic)
			for (int k = 0; k < strips; k++)
				columns(&w, s, k);
#pragma omp for schedule(dynamic, 16)
			for (int y = 0; y < w.height; y++)
				reads += one_row(&to, &w, s, y);
		}
		free(w.v);
		free(w.near);
		free(w.set);
	}
	if (cost)
		count(cost, s, reads);
}
