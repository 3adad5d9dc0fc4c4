#include "limbus/cover.h"

#include <math.h>
#include <string.h>

#include "math/stats.h"

enum { GAP_ARCS = 5 };
static const double SCLERA = 0.6;       // chance of sclera beside a limbus that is seen
static const double SEEN = 0.4;         // of the typical step
static const double OUTSIDE = 0.09;     // of the semi-axis: where the colour outside is looked at

void rim_tint(double white[ARCS], const struct ring *ring, const struct grey *tint, bool absolute)
{
	double sorted[ARCS];
	for (int i = 0; i < ARCS; i++) {
		const double s = OUTSIDE * ring->e.a;
		white[i] = tint ? grey_at(tint, ring->p[i][0] + s * ring->normal[i][0], ring->p[i][1] + s * ring->normal[i][1]) : 1;
	}
	memcpy(sorted, white, sizeof sorted);
	double reference = stats_quantile(ARCS, sorted, 0.75);
	if (absolute)
		reference = fmax(reference, SCLERA);
	for (int i = 0; i < ARCS; i++)
		white[i] /= reference;
}

static double typical_step(const struct rim *rim)
{
	double v[ARCS];
	int n = 0;
	for (int i = 0; i < ARCS; i++)
		if (rim->used[i])
			v[n++] = rim->step[i].out - rim->step[i].in;
	return stats_median(n, v);
}

void rim_cover(struct rim *rim, const struct grey *grey, const struct grey *tint, bool absolute, int width, int height)
{
	const double gap = 1.5 * rim->width + grey->scale, depth = fmax(0.03 * rim->e.a, 2 * grey->scale);
	struct ring r = ring_sample(grey, &rim->e, -gap - depth, gap + depth, fmax(grey->scale, depth / 6), 3, width, height);
	bool on[ARCS];
	double white[ARCS];
	int n = 0;
	rim_tint(white, &r, tint, absolute);
	const double typical = typical_step(rim);
	for (int i = 0; i < ARCS; i++) {
		const float *v = r.v + (long)i * r.m;
		double in = 0, out = 0;
		const int end = (int)(depth / r.step);
		for (int j = 0; j < end; j++) {
			in += v[j] / end;
			out += v[r.m - 1 - j] / end;
		}
		on[i] = rim->used[i] || (r.inside[i] && white[i] > RIM_WHITE && out - in > SEEN * typical && out - in < typical / SEEN);
	}
	ring_free(&r);
	for (int i = 0; i < ARCS; i++) {
		int before = 0, after = 0, near = 0;
		for (int j = 0; j <= GAP_ARCS; j++) {
			before |= on[(i - j + ARCS) % ARCS];
			after |= on[(i + j) % ARCS];
			near += on[(i - j + ARCS) % ARCS] + on[(i + j) % ARCS];
		}
		rim->seen[i] = (on[i] || (before && after)) && near > GAP_ARCS;
		n += rim->seen[i];
	}
	rim->coverage = (double)n / ARCS;
}
