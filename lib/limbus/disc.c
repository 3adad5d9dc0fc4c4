#include "limbus/disc.h"

#include <math.h>

#include "image/plane.h"

/* Middle and radius of the circle of that area, px of the planes; 1 - shorter over longer axis, times cosine and sine of twice the
 * longer's direction: smooth at the circle, too, and about independent of each other. */
enum { X, Y, R, COS, SIN, PARAMETERS };

static double ratio_of(const double p[PARAMETERS])
{
	return 1 - hypot(p[COS], p[SIN]);
}

static double longer_of(const double p[PARAMETERS])
{
	return p[R] / sqrt(ratio_of(p));
}

static double turn_of(const double p[PARAMETERS])
{
	return 0.5 * atan2(p[SIN], p[COS]);
}

struct told { double iris_in, sclera_in, other_in, iris_out; };

/* What the planes say within `reach` longer semi-axes of the middle, by side of the ellipse; a pixel on its edge counts to both. Of every
 * `stride` pixels of a row or a column, one is looked at. */
static struct told tell(const struct evidence *e, const double p[PARAMETERS], double reach, int stride)
{
	struct told t = { 0 };
	const double ratio = ratio_of(p), co = cos(turn_of(p)), si = sin(turn_of(p)), longer = longer_of(p), far = reach * longer;
	const int x0 = (int)fmax(p[X] - far, 0), x1 = (int)fmin(p[X] + far, e->width - 1), y0 = (int)fmax(p[Y] - far, 0), y1 = (int)fmin(p[Y] + far, e->height - 1);
	for (int y = y0; y <= y1; y += stride)
		for (int x = x0; x <= x1; x += stride) {
			const long i = (long)y * e->width + x;
			const double dx = x + 0.5 - p[X], dy = y + 0.5 - p[Y], u = co * dx + si * dy, v = (co * dy - si * dx) / ratio;
			const double in = fmin(fmax(0.5 + (longer - sqrt(u * u + v * v)) * ratio / stride, 0), 1);
			const double iris = (double)e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_PUPIL][i], sclera = e->plane[EVIDENCE_SCLERA][i];
			t.iris_in += in * iris;
			t.sclera_in += in * sclera;
			t.other_in += in * ((double)e->plane[EVIDENCE_SKIN][i] + e->plane[EVIDENCE_LASH][i]);
			t.iris_out += (1 - in) * iris;
		}
	return t;
}

static double cost(const struct evidence *e, const double p[PARAMETERS], double reach, int stride)
{
	const struct told t = tell(e, p, reach, stride);
	return t.sclera_in + t.iris_out + 0.15 * t.other_in;
}

static void search(double p[PARAMETERS], const struct evidence *e)
{
	static const double least = 0.6;
	double step[PARAMETERS] = { 0.25 * p[R], 0.25 * p[R], 0.25 * p[R], 0.15, 0.15 };
	// The same pixels for all sizes.
	const double far = 1.7 * p[R], most = 1.5 * p[R];
	const int stride = (int)fmax(p[R] / 7, 1);
	double best = cost(e, p, far / longer_of(p), stride);
	for (int round = 0; round < 16; round++) {
		bool better = false;
		for (int k = 0; k < PARAMETERS; k++)
			for (int way = -1; way <= 1; way += 2) {
				double q[PARAMETERS] = { p[X], p[Y], p[R], p[COS], p[SIN] };
				q[k] += way * step[k];
				if (ratio_of(q) < least || q[R] < 1.5 || longer_of(q) > most)
					continue;
				const double c = cost(e, q, far / longer_of(q), stride);
				if (c >= best)
					continue;
				best = c;
				p[k] = q[k];
				better = true;
			}
		for (int k = 0; !better && k < PARAMETERS; k++)
			step[k] *= 0.5;
	}
}

/* Mean evidence of sclera round the ellipse, from 1.15 to 1.5 of it. */
static double sclera_beside(const struct evidence *e, const double p[PARAMETERS])
{
	enum { PLACES = 48, RINGS = 3 };
	const double co = cos(turn_of(p)), si = sin(turn_of(p));
	double sum = 0;
	for (int i = 0; i < PLACES; i++)
		for (int r = 0; r < RINGS; r++) {
			const double turn = 2 * M_PI * i / PLACES, at = longer_of(p) * (1.15 + 0.15 * r), u = at * cos(turn), v = at * ratio_of(p) * sin(turn);
			sum += plane_sample(e->plane[EVIDENCE_SCLERA], e->width, e->height, p[X] + co * u - si * v, p[Y] + si * u + co * v);
		}
	return sum / (PLACES * RINGS);
}

void disc_fit(struct evidence_region *region, const struct evidence *e)
{
	double p[PARAMETERS] = { (region->x - e->x0) / e->scale, (region->y - e->y0) / e->scale, region->radius / e->scale, 0, 0 };
	search(p, e);
	const struct told t = tell(e, p, 1.6, 1);
	const double share = t.iris_in / fmax(t.iris_in + t.sclera_in + t.iris_out, 1e-6);
	const double shown = fmin(t.iris_in / (0.35 * M_PI * p[R] * p[R]), 1), beside = fmin(sclera_beside(e, p) / 0.2, 1);
	const double fits = fmin(longer_of(p) / 4, 1) * fmin(26 / longer_of(p), 1);
	*region = (struct evidence_region){ e->x0 + p[X] * e->scale, e->y0 + p[Y] * e->scale, longer_of(p) * e->scale, share * shown * (0.25 + 0.75 * beside) * fits };
}
