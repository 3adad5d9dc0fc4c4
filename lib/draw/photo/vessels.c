#include "draw/photo/vessels.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/eye/sclera.h"
#include "image/mask.h"
#include "math/stats.h"
#include "math/vec.h"

/* mm: where white is looked for round a texel, what is round a vessel, what noise is smoothed by; half the length along which a vessel is looked for, how far beside
 * it is none; area of the smallest vessel, mm². */
static const double AROUND = 0.3, GROUND = 0.5, SMOOTH = 0.02, ALONG = 0.35, BESIDE = 0.14, LEAST_MM2 = 0.05;
static const double SIGMAS[2] = { 1.8, 3.2 };  // of a line's redness over what lies beside it, over its noise: all along it, and somewhere
enum { TURNS = 12 };
static const double STEEPEST = 0.35;     // cosine between surface and sight, below which nothing is taken
static const float WHITE_FROM = 0.70f, WHITE_TO = 0.92f;  // share of white round a texel, from which it counts and all of it does
static const float SURE = 0.6f;          // chance of sclera by the evidence, from which a place is white
static const float CARUNCLE = 0.3f;      // its ln R/G over that of the white: less than skin's, more than any white's whose vessels one would count

/* Maps of one channel: ln R/G, whether it is white. */
struct sight {
	struct image red, white;
	double per_texel;   // mm
};

/* Of a texel: the place of the window's image that shows it; false: none does. */
static bool place(double xy[2], int x, int y, const struct shot *shot, const struct eye *eye, double radius, int size)
{
	double u = (x + 0.5) / size - 0.5, v = (y + 0.5) / size - 0.5, flat = hypot(u, v), polar = 2 * SCENE_SCLERA_REACH * flat, per = flat > 0 ? sin(polar) / flat : 0;
	double n[3] = { per * u, per * v, -cos(polar) }, p[3], eye_at[3], d[3], px[2], aspect = isfinite(eye->limbus_aspect) ? eye->limbus_aspect : 1;
	const double edge = eye->limbus_radius;
	if (polar > M_PI / 2 || hypot(radius * n[0] / edge, radius * n[1] / (edge * aspect)) < 1.05)
		return false;
	for (int i = 0; i < 3; i++)
		p[i] = radius * n[i];
	p[2] += eye_limbus_depth(eye) + sqrt(fmax(radius * radius - edge * edge, 0));
	fit_camera_in_eye(eye_at, &shot->fit);
	for (int i = 0; i < 3; i++)
		d[i] = eye_at[i] - p[i];
	if (vec_dot(d, n) < STEEPEST * vec_norm(d) || !fit_project(px, &shot->fit, p))
		return false;
	for (int i = 0; i < 2; i++)
		xy[i] = (px[i] - shot->window[i]) / shot->scale;
	return xy[0] > 1 && xy[1] > 1 && xy[0] < shot->image.width - 1 && xy[1] < shot->image.height - 1;
}

/* Sclera by the evidence, and not clipped. */
static bool is_white(const struct shot *shot, const double xy[2], const float own[3])
{
	const double x = shot->window[0] + xy[0] * shot->scale, y = shot->window[1] + xy[1] * shot->scale;
	return evidence_at(&shot->told, EVIDENCE_SCLERA, x, y) > SURE && fminf(own[0], own[1]) > 0.01f && fmaxf(own[0], own[1]) < 0.98f;
}

static void look(struct sight *s, const struct shot *shot, const struct eye *eye, double radius, int size)
{
	s->red = image_new(size, size, 1);
	s->white = image_new(size, size, 1);
	s->per_texel = 2 * SCENE_SCLERA_REACH * radius / size;
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			double xy[2];
			float own[3];
			if (!place(xy, x, y, shot, eye, radius, size))
				continue;
			for (int c = 0; c < 3; c++)
				own[c] = image_sample(&shot->image, xy[0], xy[1], c);
			*image_at(&s->red, x, y) = logf(fmaxf(own[0], 1e-3f) / fmaxf(own[1], 1e-3f));
			*image_at(&s->white, x, y) = is_white(shot, xy, own) ? 1 : 0;
		}
}

/* Mean of a map round each texel, over what is white; share: of white there. */
static bool mean_round(struct image *mean, struct image *share, const struct sight *s, double sigma, struct err *err)
{
	const int n = s->red.width;
	for (long i = 0; i < (long)n * n; i++)
		mean->px[i] = s->red.px[i] * s->white.px[i];
	if (!cv_blur(mean->px, mean->px, n, n, 1, sigma, err) || !cv_blur(share->px, s->white.px, n, n, 1, sigma, err))
		return false;
	for (long i = 0; i < (long)n * n; i++)
		mean->px[i] /= fmaxf(share->px[i], 1e-3f);
	return true;
}

/* Robust standard deviation of a map about its median where the photograph counts and it is not 0. */
static double noise_of(const struct image *map, const struct image *seen)
{
	enum { MOST = 20000 };
	double *v = mem_array(MOST, sizeof *v);
	int n = 0;
	const long all = (long)map->width * map->height, step = all / (4 * MOST) + 1;
	for (long i = 0; i < all && n < MOST; i += step)
		if (seen->px[2 * i + 1] > 0.5f && map->px[i] != 0)
			v[n++] = map->px[i];
	const double middle = n > 50 ? stats_median(n, v) : 0;
	for (int i = 0; i < n; i++)
		v[i] = fabs(v[i] - middle);
	const double sigma = n > 50 ? 1.4826 * stats_median(n, v) : INFINITY;
	free(v);
	return sigma;
}

/* How much redder the reddest line through a texel is than what lies to either side of it. */
static float line_through(const struct image *red, int x, int y, double per_texel)
{
	const double step = 2, half = ALONG / per_texel, off = BESIDE / per_texel;
	float most = -INFINITY;
	for (int k = 0; k < TURNS; k++) {
		const double c = cos(M_PI * k / TURNS), d = sin(M_PI * k / TURNS);
		float sum = 0;
		int n = 0;
		for (double t = -half; t <= half; t += step, n++) {
			const double u = x + 0.5 + t * c, v = y + 0.5 + t * d;
			const float aside = fmaxf(image_sample(red, u - off * d, v + off * c, 0), image_sample(red, u + off * d, v - off * c, 0));
			sum += image_sample(red, u, v, 0) - aside;
		}
		most = fmaxf(most, sum / (float)n);
	}
	return most;
}

static struct image lines(const struct image *red, const struct image *seen, double per_texel)
{
	struct image out = image_new(red->width, red->height, 1);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < red->height; y++)
		for (int x = 0; x < red->width; x++)
			if (image_at(seen, x, y)[1] > 0 && *image_at(red, x, y) > 0)
				*image_at(&out, x, y) = line_through(red, x, y, per_texel);
	return out;
}

/* Keeps lines that are redder than the noise; redness becomes cover, by what of red and green a vessel leaves. */
static void cover(struct image *seen, const struct image *red, double per_texel)
{
	struct image line = lines(red, seen, per_texel);
	const double noise = noise_of(&line, seen);
	const int n = red->width;
	const long all = (long)n * n;
	uint8_t *mask = mem_new((size_t)all, 1);
	int *label = mem_array((size_t)all, sizeof *label);
	float left[3];
	scene_vessel(left, SCENE_CONJUNCTIVA_MM, SCENE_VESSEL_MM, SCENE_OXYGEN);
	for (long i = 0; i < all; i++)
		mask[i] = seen->px[2 * i + 1] > 0 && line.px[i] > SIGMAS[0] * noise;
	const int parts = mask_label(label, mask, n, n);
	struct { long area; float most; } *part = mem_new((size_t)parts + 1, sizeof *part);
	for (long i = 0; i < all; i++) {
		part[label[i]].area++;
		part[label[i]].most = fmaxf(part[label[i]].most, line.px[i]);
	}
	for (long i = 0; i < all; i++)
		mask[i] = label[i] > 0 && (double)part[label[i]].area * per_texel * per_texel >= LEAST_MM2 && part[label[i]].most > SIGMAS[1] * noise;
	mask_grow(mask, n, n, 1.5);  // its soft edge
	for (long i = 0; i < all; i++) {
		const float e = expf(fmaxf(red->px[i], 0));
		seen->px[2 * i] = mask[i] ? fminf((e - 1) / fmaxf(e * (1 - left[1]) - (1 - left[0]), 0.05f), 1) : 0;
	}
	image_free(&line);
	free(part);
	free(label);
	free(mask);
}

/* The caruncle, which is sclera by the evidence, is white no more. */
static void leave_caruncle(struct sight *s, const struct image *ground)
{
	const long all = (long)s->white.width * s->white.height;
	double *v = mem_array((size_t)all, sizeof *v);
	int n = 0;
	for (long i = 0; i < all; i++)
		if (s->white.px[i] > 0)
			v[n++] = (double)ground->px[i];
	const float most = n ? (float)stats_median(n, v) + CARUNCLE : 0;
	free(v);
	for (long i = 0; i < all; i++)
		if (ground->px[i] > most)
			s->white.px[i] = 0;
}

bool vessels_of_photo(struct image *seen, const struct shot *shot, const struct eye *eye, double sclera_radius, int size)
{
	*seen = (struct image){ 0 };
	if (!shot->told.plane[0])
		return false;
	struct sight s;
	struct err err = { 0 };
	look(&s, shot, eye, sclera_radius, size);
	struct image ground = image_new(size, size, 1), share = image_new(size, size, 1);
	*seen = image_new(size, size, 2);
	bool ok = mean_round(&ground, &share, &s, GROUND / s.per_texel, &err);
	leave_caruncle(&s, &ground);
	ok = ok && mean_round(&ground, &share, &s, AROUND / s.per_texel, &err);
	double sum = 0;
	for (long i = 0; i < (long)size * size; i++) {
		const float t = fminf(fmaxf((share.px[i] - WHITE_FROM) / (WHITE_TO - WHITE_FROM), 0), 1);
		seen->px[2 * i + 1] = t * t * (3 - 2 * t);
		sum += seen->px[2 * i + 1];
	}
	ok = ok && sum > 0.01 * size * size && mean_round(&ground, &share, &s, GROUND / s.per_texel, &err);
	if (ok) {
		for (long i = 0; i < (long)size * size; i++)
			s.red.px[i] = seen->px[2 * i + 1] > 0 ? s.red.px[i] - ground.px[i] : 0;
		ok = cv_blur(s.red.px, s.red.px, size, size, 1, SMOOTH / s.per_texel, &err);
		cover(seen, &s.red, s.per_texel);
	}
	image_free(&ground);
	image_free(&share);
	image_free(&s.red);
	image_free(&s.white);
	if (!ok)
		image_free(seen);
	return ok;
}
