#include "around.h"

#include "canvas.h"
#include "light.h"

static float logs(struct rng *rng, double lo, double hi)
{
	return expf(range_of(rng, log(lo), log(hi)));
}

static void coloured(float out[3], float level, float kelvin)
{
	light_colour(out, kelvin);
	for (int c = 0; c < 3; c++)
		out[c] *= level;
}

static void pane_make(struct pane *p, struct rng *rng, float x, float y, float w, float h, float level)
{
	*p = (struct pane){ .half = { w, h }, .bars = { rng_below(rng, 4), rng_below(rng, 4) }, .bar_wide = range_of(rng, 0.02, 0.1),
		.skyline = rng_below(rng, 3) ? range_of(rng, -1, 0.8) : -2, .curtain_at = rng_below(rng, 3) ? 2 : range_of(rng, 0.2, 0.9),
		.curtain = range_of(rng, 0.05, 0.6), .below = range_of(rng, 0.05, 0.5) };
	source_axes(p->dir, p->side, p->up, x, y, (float)(0.1 * rng_normal(rng)));
	coloured(p->radiance, level, logs(rng, 3000, 14000));
}

/* Windows beside each other on one wall, or anywhere; now and then one that fills half of what is mirrored. */
static void panes_make(struct around *a, struct rng *rng)
{
	const float level = logs(rng, 2, 40), turn = range_of(rng, -1.6, 1.6), up = range_of(rng, -0.2, 0.9), w = logs(rng, 0.12, 0.8), h = logs(rng, 0.2, 1);
	const bool wall = rng_below(rng, 2);
	a->n = 1 + rng_below(rng, PANES_MAX);
	for (int i = 0; i < a->n; i++)
		if (wall)
			pane_make(&a->pane[i], rng, turn + 2.4F * w * (float)(i - a->n / 2), up, w, h, level);
		else
			pane_make(&a->pane[i], rng, range_of(rng, -2, 2), range_of(rng, -0.4, 1.2), logs(rng, 0.1, 1.3), logs(rng, 0.1, 1.2), level * logs(rng, 0.4, 2));
}

struct around around_make(struct rng *rng, bool test)
{
	struct around a = { .on = true, .open = rng_below(rng, 5) < 2, .lid = 2, .seed = (uint32_t)rng_bits(rng) };
	coloured(a.sky, a.open ? logs(rng, 0.7, 14) : 0, logs(rng, 4500, 16000));
	const float green = range_of(rng, 0.6, 1.1), dark = range_of(rng, 0.03, 0.4);
	for (int c = 0; c < 3; c++) {
		a.ground[c] = a.sky[c] * dark * (c == 1 ? 1 : green) * (c == 2 ? range_of(rng, 0.4, 1) : 1);
		a.walls[c] = range_of(rng, 0.9, 1.1);
	}
	coloured(a.walls, logs(rng, 0.05, 1.2), logs(rng, 2400, 6000));
	a.skyline = range_of(rng, -0.5, 0.5);
	a.rough = rng_below(rng, 3) ? range_of(rng, 0.02, 0.25) : range_of(rng, 0.2, 0.6);
	a.cloud = rng_below(rng, 2) ? range_of(rng, 0, 0.9) : 0;
	a.houses = rng_below(rng, 3) ? 0 : range_of(rng, 0.1, 0.4);
	a.outline = field_of(rng_below(rng, 2) ? FIELD_FINE : FIELD_SMOOTH, rng_below(rng, FIELD_SEEDS), test);
	a.clutter = field_of(rng_below(rng, 2) ? FIELD_SMOOTH : FIELD_CELL, rng_below(rng, FIELD_SEEDS), test);
	a.at[0] = range_of(rng, 0, 256);
	a.at[1] = range_of(rng, 0, 256);
	a.scale = range_of(rng, 12, 80);
	if (!a.open)
		panes_make(&a, rng);
	if (rng_below(rng, 5) < 2) {
		a.person_dark = range_of(rng, 0, 0.35);
		a.person[0] = (float)(0.15 * rng_normal(rng));
		a.person[1] = range_of(rng, -0.15, 0.3);
		a.person[2] = logs(rng, 0.05, 0.3);
		a.person[3] = a.person[1] - 1.3F * a.person[2];
	}
	if (rng_below(rng, 5)) {
		a.lid = range_of(rng, 0.35, 1);
		a.lid_dark = range_of(rng, 0, 0.3);
		a.lash_gap = logs(rng, 0.015, 0.09);
		a.lash_long = rng_below(rng, 4) ? range_of(rng, 0.1, 0.7) : 0;
		a.lash_wide = a.lash_gap * range_of(rng, 0.15, 0.8);
		a.lash_lean = range_of(rng, -0.4, 0.4);
		a.lash_dark = range_of(rng, 0, 0.4);
	}
	return a;
}

/* Where the land ends: trees are rough, houses are steps. */
static float skyline_at(const struct around *a, float x)
{
	const float wave = field_at(a->outline, a->at[0] + a->scale * x, a->at[1]) - 0.5F;
	const float step = a->houses > 0 ? a->houses * (field_at(a->clutter, a->at[1] + 60 * floorf(6 * x), a->at[0]) - 0.3F) : 0;
	return a->skyline + a->rough * wave + step;
}

static void outside_at(float out[3], const struct around *a, const float d[3])
{
	const float level = smooth_step(d[1] - skyline_at(a, atan2f(d[0], fabsf(d[2]) + 0.3F)), -0.01F, 0.02F);
	const float cloud = 1 + a->cloud * 2 * (field_at(a->clutter, a->at[0] + a->scale * d[0], a->at[1] + a->scale * d[1]) - 0.5F);
	const float patch = 0.4F + 1.2F * field_at(a->clutter, a->at[1] + 2 * a->scale * d[0], a->at[0] + 2 * a->scale * d[1]);
	for (int c = 0; c < 3; c++)
		out[c] = level * a->sky[c] * cloud + (1 - level) * a->ground[c] * patch;
}

/* What is seen through a window at (x, y) of it, -1 to 1, against its radiance. */
static float pane_at(const struct around *a, const struct pane *p, float x, float y)
{
	const float u = (x + 1) / 2 * (float)(p->bars[0] + 1), v = (y + 1) / 2 * (float)(p->bars[1] + 1);
	if (fabsf(u - roundf(u)) < p->bar_wide || fabsf(v - roundf(v)) < 0.7F * p->bar_wide)
		return 0.08F;
	const float edge = p->skyline + 0.4F * (field_at(a->outline, a->at[0] + 20 * x, a->at[1]) - 0.5F);
	const float patch = 0.5F + field_at(a->clutter, a->at[1] + 30 * x, a->at[0] + 30 * y);
	const float seen = p->skyline < -1 ? 1 : p->below * patch + (1 - p->below * patch) * smooth_step(y - edge, -0.03F, 0.05F);
	return seen * (fabsf(x) > p->curtain_at ? p->curtain * (0.7F + 0.6F * field_at(a->clutter, 200 * x, 3)) : 1);
}

void around_mirrored(float out[3], const struct around *a, const float d[3])
{
	if (a->open) {
		outside_at(out, a, d);
		return;
	}
	const float clutter = field_at(a->clutter, a->at[0] + a->scale * d[0], a->at[1] + a->scale * d[1]);
	for (int c = 0; c < 3; c++)
		out[c] = a->walls[c] * (0.2F + 1.6F * clutter * clutter);
	for (int i = 0; i < a->n; i++) {
		const struct pane *p = &a->pane[i];
		float at[2];
		if (source_place(at, p->dir, p->side, p->up, p->half, d) && fabsf(at[0]) < 1 && fabsf(at[1]) < 1) {
			const float seen = pane_at(a, p, at[0], at[1]);
			for (int c = 0; c < 3; c++)
				out[c] = p->radiance[c] * seen;
		}
	}
}

static float random_of(uint32_t seed, int k, int which)
{
	struct rng rng = { ((uint64_t)seed << 20) + (uint64_t)(k * 16 + which + 4096) };
	rng_bits(&rng);
	return (float)rng_uniform(&rng);
}

/* Lashes hang from the lid's margin into what is mirrored: strokes that taper. */
static float lashes(const struct around *a, float x, float y)
{
	const float below = a->lid - y;
	float through = 1;
	if (!(a->lash_long > 0) || below > a->lash_long || below < -0.05F)
		return 1;
	const int at = (int)floorf(x / a->lash_gap);
	for (int k = at - 6; k <= at + 6; k++) {
		const float length = a->lash_long * (0.4F + 0.6F * random_of(a->seed, k, 0)), share = below / length;
		if (share > 1)
			continue;
		const float root = a->lash_gap * ((float)k + random_of(a->seed, k, 1)), lean = a->lash_lean * x + 0.5F * (random_of(a->seed, k, 2) - 0.5F);
		const float off = fabsf(x - root - lean * below * (0.5F + 0.5F * share)), half = 0.5F * a->lash_wide * (1 - 0.8F * share);
		if (off < half)
			through = a->lash_dark;
	}
	return through;
}

float around_through(const struct around *a, const float d[3])
{
	float through = 1;
	if (a->person[2] > 0) {
		const float x = (d[0] - a->person[0]) / a->person[2], y = (d[1] - a->person[1]) / (1.35F * a->person[2]);
		const bool head = x * x + y * y < 1, body = d[1] < a->person[3] && fabsf(x) < 1 + 1.8F * fminf((a->person[3] - d[1]) / a->person[2], 1);
		if (head || body)
			through = a->person_dark;
	}
	const float arch = a->lid - 0.3F * d[0] * d[0];
	if (d[1] > arch)
		return through * a->lid_dark;
	return through * lashes(a, d[0], d[1] + a->lid - arch);
}
