/* An eye that nobody photographed: fibres and a collarette from a seed, over a plain tissue. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/levels.h"
#include "draw/eye/make.h"
#include "draw/eye/march/nodes.h"
#include "draw/eye/march/paths.h"
#include "draw/eye/sclera.h"
#include "draw/eye/seen.h"
#include "math/rng.h"

enum { TEXELS = 512, FIBRES = 420 };
static const double extent_mm = 6.6, plain_pupil_mm = 1.7;

static float noise_at(const float *ring, int n, double turn)
{
	double x = turn / (2 * M_PI) * n;
	int i = (int)floor(x);
	float t = (float)(x - i);
	t = t * t * (3 - 2 * t);
	return ring[((i % n) + n) % n] * (1 - t) + ring[(((i + 1) % n) + n) % n] * t;
}

/* Colour of one texel: rho 0 at the pupil's margin, 1 at the limbus. */
static void plain_colour(float rgb[3], double rho, double turn, const float *fine, const float *coarse, const double base[3])
{
	// Fibres run radially, and waver; inside the collarette (a third of the way out) they are shorter and warmer.
	double waver = turn + 0.05 * sin(9 * rho + 3 * sin(5 * turn));
	double fibre = 0.6 * noise_at(fine, FIBRES, waver) + 0.4 * noise_at(coarse, FIBRES / 6, waver + 0.4 * rho);
	double collarette = exp(-pow((rho - 0.32 - 0.03 * noise_at(coarse, FIBRES / 6, 3 * turn)) / 0.06, 2));
	double inner = 1 / (1 + exp((rho - 0.32) / 0.04)), rim = exp(-pow((1 - rho) / 0.13, 2)), light = 0.72 + 0.55 * fibre + 0.35 * collarette;
	static const double warm[3] = { 1.35, 1.0, 0.62 };
	for (int c = 0; c < 3; c++)
		rgb[c] = (float)(base[c] * light * (1 + 0.75 * inner * (warm[c] - 1)) * (1 - 0.62 * rim));
}

struct fibres {
	float fine[FIBRES], coarse[FIBRES / 6];
};

/* The colour at (u, v) mm. */
static void drawn_at(float colour[3], const struct scene *s, const struct fibres *f, const double rgb[3], double u, double v)
{
	const double rho = (hypot(u, v) - s->pupil[2]) / (s->limbus[0] - s->pupil[2]);
	plain_colour(colour, fmin(fmax(rho, 0), 1), atan2(v, u), f->fine, f->coarse, rgb);
}

static void complete(struct scene_seen *seen, const struct scene *s, const struct fibres *f, const double rgb[3])
{
	float *ln = mem_array(SEEN_SIDE * SEEN_SIDE, sizeof *ln);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < SEEN_SIDE * SEEN_SIDE; i++) {
		const double mm = 2 * seen->extent / SEEN_SIDE;
		float colour[3];
		drawn_at(colour, s, f, rgb, (i % SEEN_SIDE + 0.5) * mm - seen->extent, (i / SEEN_SIDE + 0.5) * mm - seen->extent);
		ln[i] = logf(fmaxf(colour[1], 1e-4f));
	}
	scene_seen_fill(seen, ln);
	free(ln);
}

static void seen_at(float colour[3], const struct scene_seen *seen, double u, double v)
{
	// What lies beyond the limbus has the colour of its last texels.
	const double r = hypot(u, v), in = fmin(1, 0.995 * seen->limbus / fmax(r, 1e-9));
	const double x = (in * u + seen->extent) / (2 * seen->extent) * SEEN_SIDE - 0.5, y = (in * v + seen->extent) / (2 * seen->extent) * SEEN_SIDE - 0.5;
	const int i = (int)fmin(fmax(x, 0), SEEN_SIDE - 2), j = (int)fmin(fmax(y, 0), SEEN_SIDE - 2);
	for (int c = 0; c < 3; c++) {
		float ln = 0;
		for (int k = 0; k < 4; k++)
			ln += (float)((k % 2 ? x - i : 1 - x + i) * (k / 2 ? y - j : 1 - y + j)) * seen->ln[(j + k / 2) * SEEN_SIDE + i + k % 2][c];
		colour[c] = fminf(expf(ln), 1);
	}
}

void scene_plain(struct scene *s, const struct eye *eye, const struct scene_conf *conf, const double rgb[3], uint64_t seed, struct scene_seen *seen)
{
	*s = (struct scene){ .eye = *eye, .conf = *conf, .gain = 1, .plain = true, .photo_white = { 1, 1, 1 }, .extent = extent_mm, .pupil = { 0, 0, plain_pupil_mm } };
	s->conf.albedo_mm = 0;  // all of the drawn colours are the iris' own
	scene_geometry(s);
	s->filmed = seen && seen->pupil > 0;
	if (s->filmed)
		s->pupil[2] = seen->pupil;
	int n = conf->map_size < TEXELS ? conf->map_size : TEXELS;
	struct scene_level *l = &s->level[0];
	*l = (struct scene_level){ .n = n, .per_mm = (float)(n / (2 * s->extent)) };
	l->colour = mem_array((size_t)n * (size_t)n * 4, sizeof *l->colour);
	l->relief = mem_array((size_t)n * (size_t)n * 2, sizeof *l->relief);
	struct fibres fibres;
	struct rng rng = { seed };
	for (int i = 0; i < FIBRES; i++)
		fibres.fine[i] = (float)rng_uniform(&rng);
	for (int i = 0; i < FIBRES / 6; i++)
		fibres.coarse[i] = (float)rng_uniform(&rng);
	if (seen)
		complete(seen, s, &fibres, rgb);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			const double u = (x + 0.5) / l->per_mm - s->extent, v = (y + 0.5) / l->per_mm - s->extent;
			float *colour = l->colour + 4 * ((long)y * n + x);
			if (seen)
				seen_at(colour, seen, u, v);
			else
				drawn_at(colour, s, &fibres, rgb, u, v);
			colour[3] = 1;
			l->relief[2 * ((long)y * n + x)] = 0;
			l->relief[2 * ((long)y * n + x) + 1] = (float)scene_plain_stroma;
		}
	scene_set_tissue(s, &scene_plain_tissue);
	scene_levels_make(s);
	scene_nodes_make(s);
	scene_rim_make(s);
	scene_veins_make(s);
	s->paths = scene_paths_make(s);
}
