/* First pass: along each column, by one scan down and one up, a group of blocks at a time. Rows of a group that are all
 * skin, or farther than the band from all its skin, cost one comparison. */
#include <math.h>
#include <string.h>

#include "image/distance/impl.h"
#include "math/simd.h"

enum { LANES = DISTANCE_LANES, GROUP = DISTANCE_GROUP };

/* A scan on its way. */
struct scan {
	const struct distance_field *f;
	int group, step;
	bool up;
	float d[GROUP][LANES];
	int since[GROUP];           // rows since the last one with skin
	uint8_t spare[2][LANES];    // of a cut block: materials of the row before and of this one
	float spare_cover[4][LANES];
};

/* A row of a block's texels, x0 px from the left: from the screen itself, or from `spare` where the screen cuts the block. */
SIMD_INLINE const uint8_t *materials(const struct distance_scene *s, int x0, int y, uint8_t spare[LANES])
{
	const uint8_t *m = s->material + (size_t)y * (size_t)s->width + (size_t)x0;
	int n = s->width - x0;
	if (n >= LANES)
		return m;
	memset(spare, DISTANCE_OTHER, LANES);
	memcpy(spare, m, (size_t)n);
	return spare;
}

/* Their coverage; nothing beyond the screen. */
SIMD_INLINE const float *covers(const struct distance_scene *s, int x0, int y, float spare[LANES])
{
	int n = s->width - x0;
	bool on = y >= 0 && y < s->height;
	const float *cover = s->coverage + (size_t)(on ? y : 0) * (size_t)s->width + (size_t)x0;
	if (n >= LANES && on)
		return cover;
	memset(spare, 0, LANES * sizeof *spare);
	if (on)
		memcpy(spare, cover, (size_t)n * sizeof *spare);
	return spare;
}

/* Materials of a block as one vector, each as wide as a distance. */
SIMD_INLINE void widen(int32_t out[LANES], const uint8_t *material)
{
	SIMD_LOOP
	for (int i = 0; i < LANES; i++)
		out[i] = material[i];
}

/* One step of a scan: distance to the last edge, from that of the row before. Without coverage an edge lies at the centre of
 * the skin's texel, as in the discrete transform. */
SIMD_INLINE void step_mask(float *restrict d, const uint8_t *material)
{
	int32_t here[LANES];
	widen(here, material);
	SIMD_LOOP
	for (int i = 0; i < LANES; i++)
		d[i] = here[i] == DISTANCE_SKIN ? 0 : d[i] + 1;
}

SIMD_INLINE void step_off_skin(float *d)
{
	SIMD_LOOP
	for (int i = 0; i < LANES; i++)
		d[i] += 1;
}

/* With coverage: rows two before, before, here and after. */
SIMD_INLINE void step_fine(float *restrict d, const uint8_t *material_before, const uint8_t *material, const float *const cover[4])
{
	const float *restrict a = cover[0], *restrict b = cover[1], *restrict c = cover[2], *restrict e = cover[3];
	int32_t here[LANES], before[LANES];
	widen(here, material);
	widen(before, material_before);
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float t = distance_crossing(a[i], b[i], c[i], e[i]), on = d[i] + 1, to = before[i] == DISTANCE_SKIN ? t : on;
		d[i] = here[i] == DISTANCE_SKIN ? 0 : to;
	}
}

/* Joins the scan up with the one down; the first scan to reach a row sets it. */
SIMD_INLINE void join(float *restrict v, const float *restrict d, float sign, bool first)
{
	if (first) {
		SIMD_LOOP
		for (int i = 0; i < LANES; i++)
			v[i] = sign * d[i];
		return;
	}
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float old = fabsf(v[i]), now = sign * d[i];
		v[i] = d[i] < old ? now : v[i];
	}
}

SIMD_INLINE void advance(struct scan *c, int k, int y, uint8_t has, uint8_t was)
{
	const struct distance_scene *s = c->f->scene;
	int x0 = (c->group * GROUP + k) * LANES;
	bool crossed = was & DISTANCE_HAS_SKIN && s->coverage;
	if (!(has & DISTANCE_HAS_SKIN) && !crossed) {
		step_off_skin(c->d[k]);
		return;
	}
	const uint8_t *here = materials(s, x0, y, c->spare[1]);
	if (!crossed) {
		step_mask(c->d[k], here);
		return;
	}
	const float *cover[4];
	for (int i = 0; i < 4; i++)
		cover[i] = covers(s, x0, y + (i - 2) * c->step, c->spare_cover[i]);
	step_fine(c->d[k], materials(s, x0, y - c->step, c->spare[0]), here, cover);
}

/* Initial state: the row before the window's first, and nothing before that. Returns what its blocks hold. */
static const uint8_t *begin(struct scan *c, int y)
{
	static const uint8_t nothing[GROUP];
	const struct distance_scene *s = c->f->scene;
	const uint8_t *was = y >= 0 && y < s->height ? distance_has(c->f, y) + c->group * GROUP : nothing;
	for (int k = 0; k < GROUP; k++) {
		for (int i = 0; i < LANES; i++)
			c->d[k][i] = was[k] & DISTANCE_ALL_SKIN ? 0 : DISTANCE_FAR;
		if (was[k] & DISTANCE_HAS_SKIN && !(was[k] & DISTANCE_ALL_SKIN))
			step_mask(c->d[k], materials(s, (c->group * GROUP + k) * LANES, y, c->spare[0]));
		c->since[k] = was[k] & DISTANCE_HAS_SKIN ? 0 : c->f->band + 2;
	}
	return was;
}

/* A row of the group; returns the texture reads. */
SIMD_CLONES static double one_row(struct scan *restrict c, int y, const uint8_t *was, const uint8_t *has)
{
	const struct distance_field *f = c->f;
	size_t at = distance_at(f, c->group * GROUP, y);
	int reads = 0;
	for (int k = 0; k < GROUP; k++) {
		c->since[k] = has[k] & DISTANCE_HAS_SKIN ? 0 : c->since[k] + 1;
		if (has[k] & DISTANCE_ALL_SKIN) {
			if (!(was[k] & DISTANCE_ALL_SKIN))
				memset(c->d[k], 0, sizeof c->d[k]);
		} else if (c->since[k] <= f->band + 1) {
			advance(c, k, y, has[k], was[k]);
			join(f->v + (at + (size_t)k) * LANES, c->d[k], c->up ? 1 : -1, !f->edge[at + (size_t)k]);
			f->edge[at + (size_t)k] = 1;
			reads += LANES * (f->scene->coverage && was[k] & DISTANCE_HAS_SKIN ? 6 : 1);
		}
	}
	return reads;
}

static double run(struct scan *c)
{
	const struct distance_field *f = c->f;
	const uint64_t all = DISTANCE_EACH * DISTANCE_ALL_SKIN, skin = DISTANCE_EACH * DISTANCE_HAS_SKIN;
	int y = c->up ? f->y0 + f->rows - 1 : f->y0, passed = 0;  // rows without skin
	const uint8_t *was = begin(c, y - c->step);
	double reads = 0;
	for (int n = 0; n < f->rows; n++, y += c->step) {
		const uint8_t *has = distance_has(f, y) + c->group * GROUP;
		uint64_t now = distance_group(has);
		passed = now & skin ? 0 : passed + 1;
		if (((now & distance_group(was) & all) != all) & (passed <= f->band + 2))
			reads += one_row(c, y, was, has);
		was = has;
	}
	return reads;
}

double distance_columns(struct distance_field *f, int group)
{
	struct scan down = { .f = f, .group = group, .step = 1 }, up = { .f = f, .group = group, .step = -1, .up = true };
	double reads = run(&down);
	return reads + run(&up);
}
