#include "glasses.h"

#include "scene.h"

struct glasses {
	float half[2], power, rim, rgb[3], down, tint[3];
	float patch[2][6];  // a mirrored bright patch: middle, half extents, slant, strength
	int patches;
};

static struct glasses glasses_make(struct rng *rng)
{
	struct glasses g = { .half = { range_of(rng, 19, 29), range_of(rng, 13, 26) }, .power = range_of(rng, 2, 6), .down = range_of(rng, -6, 2) };
	g.rim = rng_below(rng, 4) ? range_of(rng, 0.6, 6) : 0;
	const float dark = range_of(rng, 0.01, 0.5);
	for (int c = 0; c < 3; c++) {
		g.rgb[c] = dark * range_of(rng, 0.3, 1);
		g.tint[c] = rng_below(rng, 6) ? 1 : range_of(rng, 0.6, 1);
	}
	g.patches = rng_below(rng, 3);
	for (int i = 0; i < g.patches; i++) {
		g.patch[i][0] = range_of(rng, -18, 18);
		g.patch[i][1] = range_of(rng, -14, 14);
		g.patch[i][2] = range_of(rng, 2, 12);
		g.patch[i][3] = range_of(rng, 2, 14);
		g.patch[i][4] = range_of(rng, -0.5, 0.5);
		g.patch[i][5] = range_of(rng, 0.03, 0.9);
	}
	return g;
}

static void before(struct canvas *c, long i, const struct glasses *g, float x, float y, float side, const float white[3])
{
	const float a = fabsf(x) / g->half[0], b = fabsf(y) / g->half[1], r = powf(powf(a, g->power) + powf(b, g->power), 1 / g->power);
	const float off = (r - 1) * fminf(g->half[0], g->half[1]);
	float *rgb = c->rgb + 3 * i;
	if (off < 0) {
		float added = 0;
		for (int k = 0; k < g->patches; k++) {
			const float *p = g->patch[k], dx = x * side - p[0], dy = y - p[1];
			const float in = fminf(p[2] - fabsf(dx + p[4] * dy), p[3] - fabsf(dy - 0.2F * dx));
			added += p[5] * smooth_step(in, 0, 1);
		}
		for (int k = 0; k < 3; k++)
			rgb[k] = rgb[k] * g->tint[k] + added * white[k];
		c->mirror[i] += added * (0.2126F * white[0] + 0.7152F * white[1] + 0.0722F * white[2]);
		if (added > 0.3F && c->label[i] >= EVIDENCE_SCLERA)
			c->label[i] = EVIDENCE_REFLECTION;
	}
	const float cover = fminf(fmaxf((0.5F * g->rim - fabsf(off - 0.5F * g->rim)) / c->mm + 0.5F, 0), 1) * fminf(g->rim / c->mm, 1);
	for (int k = 0; k < 3; k++)
		rgb[k] += cover * (g->rgb[k] * white[k] - rgb[k]);
	if (cover > 0.5F)
		c->label[i] = EVIDENCE_SKIN;
}

void glasses_draw(struct canvas *c, const struct face *f, const float white[3], struct rng *rng)
{
	const struct glasses g = glasses_make(rng);
	for (int j = 0; j < c->height; j++)
		for (int i = 0; i < c->width; i++) {
			const float px = (float)i + 0.5F, py = (float)j + 0.5F;
			const float u = (c->at[0] + c->m[0][0] * px + c->m[0][1] * py) / f->narrow, v = c->at[1] + c->m[1][0] * px + c->m[1][1] * py;
			const float side = u < 0 ? -1 : 1, x = fabsf(u) - 33, y = v - g.down;
			if (x > -33 && fabsf(x) < 36 && fabsf(y) < 34)
				before(c, (long)j * c->width + i, &g, x, y, side, white);
		}
}
