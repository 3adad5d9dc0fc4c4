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

void scene_plain(struct scene *s, const struct eye *eye, const struct scene_conf *conf, const double rgb[3], uint64_t seed)
{
	*s = (struct scene){ .eye = *eye, .conf = *conf, .gain = 1, .plain = true, .photo_white = { 1, 1, 1 }, .extent = extent_mm, .pupil = { 0, 0, plain_pupil_mm } };
	s->conf.albedo_mm = 0;  // all of the drawn colours are the iris' own
	scene_geometry(s);
	int n = conf->map_size < TEXELS ? conf->map_size : TEXELS;
	struct scene_level *l = &s->level[0];
	*l = (struct scene_level){ .n = n, .per_mm = (float)(n / (2 * s->extent)) };
	l->colour = mem_array((size_t)n * (size_t)n * 4, sizeof *l->colour);
	l->relief = mem_array((size_t)n * (size_t)n * 2, sizeof *l->relief);
	float fine[FIBRES], coarse[FIBRES / 6];
	struct rng rng = { seed };
	for (int i = 0; i < FIBRES; i++)
		fine[i] = (float)rng_uniform(&rng);
	for (int i = 0; i < FIBRES / 6; i++)
		coarse[i] = (float)rng_uniform(&rng);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			double u = (x + 0.5) / l->per_mm - s->extent, v = (y + 0.5) / l->per_mm - s->extent, r = hypot(u, v);
			double rho = (r - s->pupil[2]) / (s->limbus[0] - s->pupil[2]);
			float *colour = l->colour + 4 * ((long)y * n + x);
			plain_colour(colour, fmin(fmax(rho, 0), 1), atan2(v, u), fine, coarse, rgb);
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
