#include "light.h"

#include <string.h>

static float range(struct rng *rng, double lo, double hi)
{
	return (float)rng_range(rng, lo, hi);
}

/* Planck's law at 610, 545 and 465 nm, relative to daylight of 6500 K. */
void light_colour(float rgb[3], float kelvin)
{
	static const double metres[3] = { 610e-9, 545e-9, 465e-9 };
	double p[3];
	for (int c = 0; c < 3; c++) {
		const double x = 1.4388e-2 / metres[c];
		p[c] = (exp(x / 6500) - 1) / (exp(x / (double)kelvin) - 1);
	}
	for (int c = 0; c < 3; c++)
		rgb[c] = (float)(p[c] / p[1]);
}

static void unit(float v[3])
{
	const float n = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int c = 0; c < 3; c++)
		v[c] /= n;
}

void source_axes(float d[3], float e[3], float up[3], float x, float y, float lean)
{
	const float upright[3] = { sinf(lean), cosf(lean), 0 };
	d[0] = x;
	d[1] = y;
	d[2] = 1;
	unit(d);
	e[0] = upright[1] * d[2] - upright[2] * d[1];
	e[1] = upright[2] * d[0] - upright[0] * d[2];
	e[2] = upright[0] * d[1] - upright[1] * d[0];
	unit(e);
	up[0] = d[1] * e[2] - d[2] * e[1];
	up[1] = d[2] * e[0] - d[0] * e[2];
	up[2] = d[0] * e[1] - d[1] * e[0];
}

/* A source in direction (x, y) of the plane z = 1, of so wide a half extent; mirrored radiance, irradiance. */
static void add(struct light *l, struct rng *rng, float x, float y, float w, float h, int shape, float kelvin, float radiance,
                float irradiance)
{
	if (l->n == SOURCES_MAX)
		return;
	struct source *s = &l->source[l->n++];
	*s = (struct source){ .half = { w, h }, .shape = shape, .bars = { 1 + rng_below(rng, 3), 1 + rng_below(rng, 3) } };
	source_axes(s->dir, s->side, s->up, x, y, (float)(0.15 * rng_normal(rng)));
	float colour[3];
	light_colour(colour, kelvin);
	for (int c = 0; c < 3; c++) {
		s->radiance[c] = radiance * colour[c];
		s->irradiance[c] = irradiance * colour[c];
	}
}

static void add_windows(struct light *l, struct rng *rng, float kelvin)
{
	const int n = 1 + rng_below(rng, 3);
	for (int i = 0; i < n; i++)
		add(l, rng, range(rng, -2.2, 2.2), range(rng, -0.4, 1.2), range(rng, 0.12, 0.7), range(rng, 0.2, 0.9), rng_below(rng, 2) ? 3 : 0,
		    kelvin * range(rng, 0.9, 1.2), range(rng, 6, 45), range(rng, 0.2, 0.9));
}

static void add_lamps(struct light *l, struct rng *rng, float kelvin)
{
	const int n = 1 + rng_below(rng, 6);
	for (int i = 0; i < n; i++) {
		const float w = range(rng, 0.03, 0.25);
		add(l, rng, range(rng, -2, 2), range(rng, -0.5, 2), w, w * range(rng, 0.3, 1.5), rng_below(rng, 3) ? 1 : 0, kelvin * range(rng, 0.8, 1.25),
		    range(rng, 20, 120), range(rng, 0.1, 0.7));
	}
}

static void add_boxes(struct light *l, struct rng *rng, float kelvin)
{
	const int n = 1 + rng_below(rng, 3);
	for (int i = 0; i < n; i++)
		add(l, rng, range(rng, -1.5, 1.5), range(rng, -0.8, 1.3), range(rng, 0.15, 0.5), range(rng, 0.15, 0.5), rng_below(rng, 2), kelvin,
		    range(rng, 10, 50), range(rng, 0.3, 1));
}

static void sources(struct light *l, struct rng *rng, float kelvin)
{
	const float w = range(rng, 0.2, 0.5);
	switch (l->kind) {
	case LIGHT_WINDOW: add_windows(l, rng, kelvin); break;
	case LIGHT_SOFTBOX: add_boxes(l, rng, kelvin); break;
	case LIGHT_LAMPS: add_lamps(l, rng, kelvin); break;
	case LIGHT_FLASH:
		add(l, rng, range(rng, -0.15, 0.15), range(rng, -0.1, 0.3), range(rng, 0.02, 0.07), range(rng, 0.02, 0.05), rng_below(rng, 2),
		    5800, range(rng, 60, 200), range(rng, 0.5, 1));
		break;
	case LIGHT_RING: add(l, rng, range(rng, -0.1, 0.1), range(rng, -0.1, 0.1), w, w, 2, kelvin, range(rng, 15, 50), 0.8F); break;
	case LIGHT_SKY:
	case LIGHT_TREES:
		if (rng_below(rng, 2))
			add(l, rng, range(rng, -2, 2), range(rng, 0.5, 3), 0.03F, 0.03F, 1, 5400, range(rng, 200, 600), range(rng, 0.4, 1.5));
		break;
	default: break;
	}
	if (l->kind == LIGHT_ROOM)
		rng_below(rng, 2) ? add_windows(l, rng, kelvin) : add_lamps(l, rng, kelvin);
}

struct light light_make(struct rng *rng, bool test)
{
	struct light l = { .kind = test && rng_below(rng, 2) ? LIGHT_RING + rng_below(rng, 2) : rng_below(rng, LIGHT_RING) };
	const bool outside = l.kind == LIGHT_SKY || l.kind == LIGHT_TREES;
	const float kelvin = outside ? range(rng, 5000, 8000) : range(rng, 2200, 8000);
	sources(&l, rng, kelvin);
	const float fill = l.n ? range(rng, 0.08, 0.7) : range(rng, 0.6, 1), room = outside ? range(rng, 1, 6) : range(rng, 0, 1.6);
	float colour[3];
	light_colour(colour, kelvin * range(rng, 0.75, 1.3));
	for (int c = 0; c < 3; c++) {
		l.ambient[c] = fill * colour[c];
		l.room[c] = room * colour[c] * range(rng, 0.85, 1.15);
	}
	l.above = outside ? 1 : range(rng, 0, 0.6);
	l.skyline = range(rng, -0.35, 0.35);
	l.clutter = field_of(l.kind == LIGHT_TREES ? FIELD_CELL : rng_below(rng, 2) ? FIELD_SMOOTH : FIELD_CELL, rng_below(rng, FIELD_SEEDS), test);
	l.at[0] = range(rng, 0, 256);
	l.at[1] = range(rng, 0, 256);
	l.scale = range(rng, 15, 90);
	const double turn = rng_range(rng, 0, 6.2831853);
	l.shade_dir[0] = (float)cos(turn);
	l.shade_dir[1] = (float)sin(turn);
	l.shade_at = (float)(20 * rng_normal(rng));
	l.shade_soft = range(rng, 0.6, 9);
	const int cast = rng_below(rng, 10);
	l.shade_depth = cast < 3 ? range(rng, 0.2, 0.8) : 0;
	l.shade_period = cast == 0 ? range(rng, 6, 40) : 0;
	return l;
}

bool source_place(float at[2], const float dir[3], const float side[3], const float up[3], const float half[2], const float d[3])
{
	const float ahead = d[0] * dir[0] + d[1] * dir[1] + d[2] * dir[2];
	if (ahead < 0.05F)
		return false;
	at[0] = (d[0] * side[0] + d[1] * side[1] + d[2] * side[2]) / ahead / half[0];
	at[1] = (d[0] * up[0] + d[1] * up[1] + d[2] * up[2]) / ahead / half[1];
	return true;
}

static bool in_source(const struct source *s, const float d[3])
{
	float at[2];
	if (!source_place(at, s->dir, s->side, s->up, s->half, d))
		return false;
	const float a = at[0], b = at[1], r = a * a + b * b;
	switch (s->shape) {
	case 1: return r < 1;
	case 2: return r < 1 && r > 0.5F;
	case 3: {
		if (fabsf(a) > 1 || fabsf(b) > 1)
			return false;
		const float p = (a + 1) / 2 * (float)(s->bars[0] + 1), q = (b + 1) / 2 * (float)(s->bars[1] + 1);
		return fabsf(p - roundf(p)) > 0.07F && fabsf(q - roundf(q)) > 0.05F;
	}
	default: return fabsf(a) < 1 && fabsf(b) < 1;
	}
}

void light_mirrored(float out[3], const struct light *l, const float d[3])
{
	const float wobble = field_at(l->clutter, l->at[0] + l->scale * d[0], l->at[1] + l->scale * d[1]);
	float high = (d[1] - l->skyline - 0.3F * (wobble - 0.5F)) / 0.06F;
	high = high < 0 ? 0 : high > 1 ? 1 : high;
	const float level = (1 - l->above + l->above * (0.12F + high)) * (0.25F + 1.5F * wobble * wobble);
	for (int c = 0; c < 3; c++)
		out[c] = l->room[c] * level;
	if (l->around.on)
		around_mirrored(out, &l->around, d);
	for (int i = 0; i < l->n; i++)
		if (in_source(&l->source[i], d))
			for (int c = 0; c < 3; c++)
				out[c] += l->source[i].radiance[c];
	const float through = l->around.on ? around_through(&l->around, d) : 1;
	for (int c = 0; c < 3; c++)
		out[c] *= through;
}

void light_on(float out[3], const struct light *l, const float n[3], float wrap)
{
	const float sky = 0.8F + 0.3F * n[1];
	for (int c = 0; c < 3; c++)
		out[c] = l->ambient[c] * sky;
	for (int i = 0; i < l->n; i++) {
		const struct source *s = &l->source[i];
		const float dot = (n[0] * s->dir[0] + n[1] * s->dir[1] + n[2] * s->dir[2] + wrap) / (1 + wrap);
		if (dot > 0)
			for (int c = 0; c < 3; c++)
				out[c] += s->irradiance[c] * dot;
	}
}

float light_shade(const struct light *l, float u, float v)
{
	if (l->shade_depth == 0)
		return 1;
	float s = u * l->shade_dir[0] + v * l->shade_dir[1] - l->shade_at;
	if (l->shade_period > 0) {
		s = fabsf(s - l->shade_period * roundf(s / l->shade_period)) - 0.25F * l->shade_period;
	}
	return 1 - l->shade_depth / (1 + expf(-s / l->shade_soft * 3));
}
