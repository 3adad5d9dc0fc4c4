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
	double azimuth = 2 * M_PI * uniform(&p->random), sine = sqrt(1 - cos_light * cos_light);
	p->at[0] = uniform(&p->random) * s->n * s->cell;
	p->at[1] = uniform(&p->random) * s->n * s->cell;
	p->at[2] = top;
	p->dir[0] = sine * cos(azimuth);
	p->dir[1] = sine * sin(azimuth);
	p->dir[2] = -cos_light;
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
			out[cell_of(s, p.at)] += (float)(share * weight * exp(-tau));
			double z = 2 * uniform(&p.random) - 1, a = 2 * M_PI * uniform(&p.random), sine = sqrt(1 - z * z);
			p.dir[0] = sine * cos(a);
			p.dir[1] = sine * sin(a);
			p.dir[2] = z;
		}
	}
}
