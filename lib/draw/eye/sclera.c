#include "draw/eye/sclera.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "bridge/cv_draw.h"
#include "draw/eye/batch_impl.h"
#include "draw/eye/texels.h"
#include "math/rng.h"

static const double reach = SCENE_SCLERA_REACH;

enum { STEPS_MAX = 160 };

struct grower {
	struct cv_picture picture;
	struct rng rng;
	double limbus;  // angle of the limbus
};

struct vessel {
	double polar, turn;   // where it is: angle from the axis, and round it
	double heading;       // 0: straight towards the limbus; radians
	double width;         // mm
	double sway, phase;   // tortuosity
	int depth;            // of branching
};

static void put(const struct grower *g, float xy[2], double polar, double turn)
{
	double r = polar / reach * g->picture.width / 2;
	xy[0] = (float)(g->picture.width / 2.0 + r * cos(turn));
	xy[1] = (float)(g->picture.width / 2.0 + r * sin(turn));
}

static void vessel_draw(const struct grower *g, int n, const float (*xy)[2], double width, double mm_per_px)
{
	// A vessel thinner than a pixel is drawn a pixel wide and paler. Both ends fade: one rises from the depth, the other runs out.
	enum { PIECE = 5 };
	for (int a = 0; a + 1 < n; a += PIECE) {
		int b = a + PIECE + 1 < n ? a + PIECE + 1 : n;
		double t = (double)a / n, ends = fmin(fmin(t / 0.25, (1 - t) / 0.6), 1), px = width / mm_per_px * (0.35 + 0.65 * ends);
		uint8_t ink = (uint8_t)fmin(235, 235 * fmin(px, 1) * (0.25 + 0.75 * ends));
		cv_draw_line(&g->picture, b - a, xy + a, false, px > 1.5 ? (int)lrint(px) : 1, (const uint8_t[3]){ ink });
	}
}

/* Vessels run towards the limbus, sway, fork, and fade before they reach it (iris paper, section 2.2). */
static void grow(struct grower *g, struct vessel v, double mm_per_px, double radius)
{
	float xy[STEPS_MAX][2];
	int n = 0, steps = (int)rng_range(&g->rng, 50, STEPS_MAX) >> v.depth;
	double step = 0.16 / radius, drift = 0, bend = rng_range(&g->rng, 0.12, 0.3), end = 0.02 + 0.18 * rng_uniform(&g->rng);
	for (; n < steps && v.polar > g->limbus + end; n++) {
		put(g, xy[n], v.polar, v.turn);
		drift = 0.9 * drift + 0.07 * rng_normal(&g->rng);
		double way = v.heading + drift + v.sway * sin(v.phase + bend * n);
		v.polar -= step * cos(way);
		v.turn += step * sin(way) / sin(v.polar);
		v.heading *= 0.985;
		if (v.depth < 2 && n > 6 && rng_uniform(&g->rng) < 0.022) {
			double side = rng_uniform(&g->rng) < 0.5 ? -1 : 1;
			struct vessel w = v;
			w.heading += side * rng_range(&g->rng, 0.35, 0.8);
			w.width *= rng_range(&g->rng, 0.45, 0.7);
			w.phase = rng_range(&g->rng, 0, 6.28);
			w.depth++;
			grow(g, w, mm_per_px, radius);
			v.heading -= side * 0.15;
			v.width *= 0.92;
		}
	}
	vessel_draw(g, n, (const float(*)[2])xy, v.width, mm_per_px);
}

/* A layer of vessels: [size][size], 0..255. free(). */
static uint8_t *layer(const struct scene *s, int size, int seed, int count, double width_lo, double width_hi)
{
	double radius = s->conf.sclera_radius;
	struct grower g = { { mem_new((size_t)size * (size_t)size, 1), size, size, 1 }, { (uint64_t)seed },
	                    asin(s->limbus[0] / radius) };
	for (int i = 0; i < count; i++) {
		// Most come from the canthi, left and right; fewer from above and below. A few are wide, most hair-thin.
		double side = rng_uniform(&g.rng) < 0.5 ? 0 : M_PI, spread = rng_normal(&g.rng) * 0.6, u = rng_uniform(&g.rng);
		struct vessel v = { .polar = g.limbus + rng_range(&g.rng, 0.35, 1.3), .turn = side + spread,
		                    .heading = 0.45 * rng_normal(&g.rng), .width = width_lo + (width_hi - width_lo) * u * u * u,
		                    .sway = rng_range(&g.rng, 0.05, 0.5), .phase = rng_range(&g.rng, 0, 6.28) };
		grow(&g, v, 2 * reach * radius / size, radius);
	}
	return g.picture.px;
}

/* Ripples break up reflections beyond the cornea: slopes from a height map of noise. */
static void film_make(struct scene *s, const struct image *height)
{
	int n = height->width;
	float e = 0.012f * (float)n, from = (float)asin(s->limbus[0] / s->conf.sclera_radius);
	s->film = image_new(n, n, 2);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			float u = (float)x + 0.5f, v = (float)y + 0.5f, r = hypotf(u - 0.5f * (float)n, v - 0.5f * (float)n) * 2 / (float)n;
			float k = 0.22f * smooth(from, from + 0.3f, r * (float)reach), *p = image_at(&s->film, x, y);
			p[0] = k * (image_sample(height, u + e, v, 0) - image_sample(height, u - e, v, 0));
			p[1] = k * (image_sample(height, u, v + e, 0) - image_sample(height, u, v - e, 0));
		}
}

static struct image ripples(int seed)
{
	enum { N = 256 };
	struct err err = { 0 };
	struct image noise = image_new(N, N, 1);
	struct rng rng = { (uint64_t)seed };
	for (long i = 0; i < (long)N * N; i++)
		noise.px[i] = (float)rng_normal(&rng);
	cv_blur(noise.px, noise.px, N, N, 1, N / 90.0, &err);
	return noise;
}

/* Red, green and blue stand for 610, 550 and 460 nm. Reduced scattering of tissue of collagen: 7.37 l^-0.22 + 1.1e11 l^-4
 * (Bashkatov, Genina, Kochubey and Tuchin 2005; the iris paper's eq. 14 is its double). Absorption of blood, 150 g of haemoglobin
 * in a litre, with all of its oxygen and with none (Prahl 1999). 1/mm. */
static const double wavelength[3] = { 610, 550, 460 };
static const double arterial[3] = { 0.81, 23.0, 23.8 }, without_oxygen[3] = { 5.06, 28.6, 12.5 };

/* A layer of vessels: how deep it lies and how wide they are, mm; the share of their blood's oxygen. */
struct layer_of {
	double depth, width, oxygen;
};
static const struct layer_of conjunctiva = { 0.05, 0.04, 0.95 }, episclera = { 0.35, 0.12, 0.6 };

void scene_vessel(float left[3], double depth, double width, double oxygen)
{
	for (int c = 0; c < 3; c++) {
		double l = wavelength[c], scatter = 7.37 * pow(l, -0.22) + 1.1e11 * pow(l, -4);
		double blood = oxygen * arterial[c] + (1 - oxygen) * without_oxygen[c], seen = 1 / (1 + 0.75 * scatter * depth);
		left[c] = (float)(1 - seen * (1 - exp(-2 * M_PI / 4 * width * blood)));
	}
}

/* Albedo of sclera and vessels. a, b: share of the texel that vessels of the conjunctiva and of the episclera cover. Away from the
 * cornea it gets a little yellower and redder by fat of the orbit. */
static void albedo_put(float p[3], const struct scene *s, const float left[2][3], float r, float a, float b)
{
	float away = smooth(0.35f, 1.1f, r * (float)(reach / 1.3));
	float tint[3] = { 1 - 0.01f * away, 1 - 0.06f * away, 1 - 0.11f * away };
	for (int c = 0; c < 3; c++)
		p[c] = (float)s->conf.sclera_rgb[c] * tint[c] * (1 - a * (1 - left[0][c])) * (1 - b * (1 - left[1][c]));
	p[3] = 1 - (1 - a * (1 - left[0][1])) * (1 - b * (1 - left[1][1]));
}

void scene_veins_make(struct scene *s)
{
	int n = s->conf.veins_px, count = (int)lrint(80 * s->conf.vein_density);
	s->veins = image_new(n, n, 4);
	uint8_t *fine = layer(s, n, s->conf.seed, count, 0.012, 0.07);
	uint8_t *deep = layer(s, n, s->conf.seed + 1, count / 2, 0.08, 0.22);
	float *blurred = mem_array((size_t)n * (size_t)n, sizeof *blurred), mm_per_px = (float)(2 * reach * s->conf.sclera_radius / n);
	for (long i = 0; i < (long)n * n; i++)
		blurred[i] = (float)deep[i] / 255;
	struct err err = { 0 };
	cv_blur(blurred, blurred, n, n, 1, 0.4 * episclera.depth / mm_per_px, &err);  // light that comes up through the tissue spreads
	float left[2][3];
	scene_vessel(left[0], conjunctiva.depth, conjunctiva.width, conjunctiva.oxygen);
	scene_vessel(left[1], episclera.depth, episclera.width, episclera.oxygen);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			long i = (long)y * n + x;
			float r = hypotf((float)x + 0.5f - 0.5f * (float)n, (float)y + 0.5f - 0.5f * (float)n) * 2 / (float)n;
			albedo_put(s->veins.px + 4 * i, s, (const float(*)[3])left, r, 0.66f * (float)fine[i] / 255, 0.5f * blurred[i]);
		}
	scene_texels_make(&s->white, s->veins.px, n);
	struct image height = ripples(s->conf.seed + 2);
	film_make(s, &height);
	image_free(&height);
	free(fine);
	free(deep);
	free(blurred);
}

void scene_sclera(float albedo[3], float normal[3], const struct scene *s, const float point[3])
{
	float x = point[0], y = point[1], z = point[2] - (float)s->sclera_z, flat = sqrtf(x * x + y * y), len = 0;
	float r = atan2f(flat, -z) / (float)reach * 0.5f, per = flat > 1e-6f ? r / flat : 0;  // of the map's width
	int n = s->veins.width, m = s->film.width;
	for (int c = 0; c < 3; c++)
		albedo[c] = channel_at(s->veins.px, n, (float)n, per * x, per * y, 4, c);
	for (int c = 0; c < 2; c++)
		normal[c] += channel_at(s->film.px, m, (float)m, per * x, per * y, 2, c);
	for (int c = 0; c < 3; c++)
		len += normal[c] * normal[c];
	for (int c = 0; c < 3; c++)
		normal[c] /= sqrtf(len);
}
