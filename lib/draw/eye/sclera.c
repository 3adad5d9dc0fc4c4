#include "draw/eye/sclera.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/eye/batch_impl.h"
#include "draw/eye/texels.h"
#include "draw/eye/vessels.h"
#include "math/rng.h"

static const double reach = SCENE_SCLERA_REACH;

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
static const struct layer_of conjunctiva = { SCENE_CONJUNCTIVA_MM, SCENE_VESSEL_MM, SCENE_OXYGEN }, episclera = { 0.35, 0.12, 0.6 };

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

/* A layer's cover, 0..1: [n][n]. seen: the photograph's vessels, which it goes on from, or null. */
static struct image layer(const struct scene *s, struct vessel_habit habit, const struct image *seen, int seed)
{
	struct image cover = image_new(s->conf.veins_px, s->conf.veins_px, 1);
	habit.points = (int)lrint(habit.points * s->conf.vein_density);
	habit.radius = s->conf.sclera_radius;
	habit.limbus = asin(s->limbus[0] / habit.radius);
	habit.seen = seen;
	habit.seen_reach = reach;
	struct vessels vessels = vessels_grow(&habit, (uint64_t)seed);
	vessels_draw(&cover, &vessels, reach, habit.radius);
	vessels_free(&vessels);
	return cover;
}

/* The conjunctiva's are many, fine and winding; the episclera's, from the arteries of the muscles, few, wide and straighter (iris paper, section 2.2). */
static const struct vessel_habit fine_habit = { .points = 1400, .roots = 20, .step = 0.25, .reach = 4, .near = 0.55, .width = 0.017, .sway = 0.5, .wave = 2.4 };
static const struct vessel_habit deep_habit = { .points = 160, .roots = 8, .step = 0.3, .reach = 9, .near = 1.2, .width = 0.06, .sway = 0.6, .wave = 6 };

void scene_veins_make(struct scene *s)
{
	const int n = s->conf.veins_px;
	s->veins = image_new(n, n, 4);
	const struct image *seen = s->conf.vessels;
	struct image fine = layer(s, fine_habit, seen, s->conf.seed), deep = layer(s, deep_habit, 0, s->conf.seed + 1);
	const double mm_per_px = 2 * reach * s->conf.sclera_radius / n;
	struct err err = { 0 };
	cv_blur(deep.px, deep.px, n, n, 1, 0.4 * episclera.depth / mm_per_px, &err);  // light that comes up through the tissue spreads
	float left[2][3];
	scene_vessel(left[0], conjunctiva.depth, conjunctiva.width, conjunctiva.oxygen);
	scene_vessel(left[1], episclera.depth, episclera.width, episclera.oxygen);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			long i = (long)y * n + x;
			float r = hypotf((float)x + 0.5f - 0.5f * (float)n, (float)y + 0.5f - 0.5f * (float)n) * 2 / (float)n;
			const float own = seen ? seen->px[2 * i + 1] : 0, a = own * (seen ? seen->px[2 * i] : 0) + (1 - own) * 0.8f * fine.px[i];
			albedo_put(s->veins.px + 4 * i, s, (const float(*)[3])left, r, a, (1 - own) * 0.5f * deep.px[i]);
		}
	scene_texels_make(&s->white, s->veins.px, n);
	struct image height = ripples(s->conf.seed + 2);
	film_make(s, &height);
	image_free(&height);
	image_free(&fine);
	image_free(&deep);
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
