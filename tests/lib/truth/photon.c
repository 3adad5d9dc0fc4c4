#include "tests/lib/truth/photon.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* xorshift64*: uniform in (0, 1). */
static double uniform(uint64_t *state)
{
	*state ^= *state >> 12;
	*state ^= *state << 25;
	*state ^= *state >> 27;
	return ((double)((*state * 2685821657736338717ULL) >> 11) + 0.5) * 0x1p-53;
}

struct photon {
	double at[3], dir[3];
	uint64_t random;
};

static int cell_of(const struct photon_slab *s, const double at[3])
{
	if (s->n == 1)
		return 0;
	int x = (int)floor(at[0] / s->cell) % s->n, y = (int)floor(at[1] / s->cell) % s->n;
	return (y < 0 ? y + s->n : y) * s->n + (x < 0 ? x + s->n : x);
}

/* Depth below the local surface, mm; negative above it. */
static double depth(const struct photon_slab *s, const double at[3])
{
	return s->stroma[cell_of(s, at)] + s->abl - at[2];
}

/* Flies to the next scattering by Woodcock's method; false when it has left or has been absorbed. */
static bool fly(struct photon *p, const struct photon_slab *s, double top, double majorant, double *weight, int *layer)
{
	for (;;) {
		double length = -log(uniform(&p->random)) / majorant;
		for (int i = 0; i < 3; i++)
			p->at[i] += length * p->dir[i];
		if (p->at[2] <= 0 || (p->at[2] > top && p->dir[2] > 0))
			return false;
		double d = depth(s, p->at);
		if (d < 0)
			continue;
		*layer = d < s->abl ? 0 : 1;
		double extinction = s->scatter[*layer] + s->absorb[*layer];
		if (uniform(&p->random) * majorant >= extinction)
			continue;
		*weight *= s->scatter[*layer] / extinction;
		if (*weight < 0.05) {
			if (uniform(&p->random) < 0.5)
				return false;
			*weight *= 2;
		}
		return true;
	}
}

static void start(struct photon *p, const struct photon_slab *s, double top, double cos_light)
{
	double azimuth = s->from_x ? M_PI : 2 * M_PI * uniform(&p->random), sine = sqrt(1 - cos_light * cos_light);
	p->at[0] = uniform(&p->random) * s->n * s->cell;
	p->at[1] = uniform(&p->random) * s->n * s->cell;
	p->at[2] = top;
	p->dir[0] = sine * cos(azimuth);
	p->dir[1] = sine * sin(azimuth);
	p->dir[2] = -cos_light;
}

/* Henyey and Greenstein, mean 1. */
static double phase(double g, double cosine)
{
	double d = 1 + g * g - 2 * g * cosine;
	return (1 - g * g) / (d * sqrt(d));
}

/* Turns into a new direction, by that phase function. */
static void scatter(struct photon *p, double g)
{
	double u = uniform(&p->random), a = 2 * M_PI * uniform(&p->random), ratio = (1 - g * g) / (1 - g + 2 * g * u);
	double cosine = g > 1e-3 ? (1 + g * g - ratio * ratio) / (2 * g) : 2 * u - 1, sine = sqrt(fmax(1 - cosine * cosine, 0));
	double *d = p->dir, flat = hypot(d[0], d[1]), side[3] = { 1, 0, 0 }, up[3] = { 0, 1, 0 };
	if (flat > 1e-6) {
		double s[3] = { -d[1] / flat, d[0] / flat, 0 }, t[3] = { -d[2] * s[1], d[2] * s[0], d[0] * s[1] - d[1] * s[0] };
		memcpy(side, s, sizeof s);
		memcpy(up, t, sizeof t);
	}
	for (int i = 0; i < 3; i++)
		d[i] = cosine * d[i] + sine * (cos(a) * side[i] + sin(a) * up[i]);
}

void photon_reflectance(float *out, const struct photon_slab *s, double cos_light, long photons, int orders, uint64_t seed)
{
	double top = 0, majorant = fmax(s->scatter[0] + s->absorb[0], s->scatter[1] + s->absorb[1]);
	for (int i = 0; i < s->n * s->n; i++)
		top = fmax(top, s->stroma[i] + s->abl);
	memset(out, 0, sizeof *out * s->n * s->n);
	double share = (double)s->n * s->n / photons / 4;  // pi / (4 pi), photons a cell
	struct photon p = { .random = seed * 0x9E3779B97F4A7C15ULL + 1 };
	for (long i = 0; i < photons; i++) {
		double weight = 1;
		int layer = 0;
		start(&p, s, top, cos_light);
		for (int order = 1; (!orders || order <= orders) && fly(&p, s, top, majorant, &weight, &layer); order++) {
			double d = depth(s, p.at), abl = fmin(d, s->abl), deep = d - abl;
			double tau = abl * (s->scatter[0] + s->absorb[0]) + deep * (s->scatter[1] + s->absorb[1]);
			out[cell_of(s, p.at)] += (float)(share * weight * phase(s->g, p.dir[2]) * exp(-tau));
			scatter(&p, s->g);
		}
	}
}

double photon_spread(const struct photon_slab *s, double cos_light, long photons, uint64_t seed)
{
	double top = s->stroma[0] + s->abl, majorant = fmax(s->scatter[0] + s->absorb[0], s->scatter[1] + s->absorb[1]);
	double all = 0, mean[2] = { 0 }, square = 0, sine = sqrt(1 - cos_light * cos_light);
	struct photon p = { .random = seed * 0x9E3779B97F4A7C15ULL + 1 };
	for (long i = 0; i < photons; i++) {
		double weight = 1;
		int layer = 0;
		const double at[3] = { 0, 0, top }, dir[3] = { sine, 0, -cos_light };
		memcpy(p.at, at, sizeof at);
		memcpy(p.dir, dir, sizeof dir);
		while (fly(&p, s, top, majorant, &weight, &layer)) {
			double d = depth(s, p.at), abl = fmin(d, s->abl), deep = d - abl;
			double tau = abl * (s->scatter[0] + s->absorb[0]) + deep * (s->scatter[1] + s->absorb[1]), w = weight * phase(s->g, p.dir[2]) * exp(-tau);
			all += w;
			mean[0] += w * p.at[0];
			mean[1] += w * p.at[1];
			square += w * (p.at[0] * p.at[0] + p.at[1] * p.at[1]);
			scatter(&p, s->g);
		}
	}
	return sqrt((square / all - (mean[0] * mean[0] + mean[1] * mean[1]) / (all * all)) / 2);
}
