#include "draw/eye/seen.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"

enum { SIDE = SEEN_SIDE, TEXELS = SIDE * SIDE, RINGS = SEEN_RINGS, TURNS = SEEN_TURNS, KNOWN = 8 };  // a ring is known by an eighth of its turns
static const double drawn_mm = 1;            // sigma, at most, below which fibres are drawn
static const double strength[] = { 0.3, 0.8 }; // of drawn fibres, so that they go on as strong as those seen
static const double beside_pupil_mm = 0.25;  // a pupil's margin moves, and is blurred

void scene_seen_free(struct scene_seen *s)
{
	free(s->ln);
	free(s->weight);
	*s = (struct scene_seen){ 0 };
}

/* Mean by a Gaussian of that many texels, over what is seen. */
static bool blur(float *to, const float *from, const float *weight, double sigma)
{
	struct err none = { 0 };
	float (*both)[2] = mem_array(TEXELS, sizeof *both);
	for (int i = 0; i < TEXELS; i++) {
		both[i][0] = weight[i] * from[i];
		both[i][1] = weight[i];
	}
	const bool ok = cv_blur(&both[0][0], &both[0][0], SIDE, SIDE, 2, sigma, &none);
	for (int i = 0; i < TEXELS; i++)
		to[i] = both[i][1] > 1e-6f ? both[i][0] / both[i][1] : 0;
	free(both);
	return ok;
}

/* A place in the map: radius mm, angle. */
static double polar_of(double *turn, const struct scene_seen *s, int i)
{
	const double mm = 2 * s->extent / SIDE, x = (i % SIDE + 0.5) * mm - s->extent, y = (i / SIDE + 0.5) * mm - s->extent;
	*turn = atan2(y, x);
	return hypot(x, y);
}

struct cell {
	double ln[3], weight;
};

static double inner_of(const struct scene_seen *s)
{
	return s->pupil > 0 ? s->pupil + beside_pupil_mm : 0;
}

/* What is seen, in rings; what is not of each ring is taken from the nearest of it on both sides, wider means the farther they are, then from the rings beside it. */
static void rings_of(struct cell cell[RINGS][TURNS], const struct scene_seen *s)
{
	struct cell (*raw)[TURNS] = mem_new(RINGS, sizeof *raw);
	bool known[RINGS];
	for (int i = 0; i < TEXELS; i++) {
		double turn, r = polar_of(&turn, s, i);
		if (!(s->weight[i] > 0) || r >= s->limbus || r < inner_of(s))
			continue;
		struct cell *c = &raw[(int)(r / s->limbus * RINGS)][(int)((turn / (2 * M_PI) + 1) * TURNS) % TURNS];
		for (int k = 0; k < 3; k++)
			c->ln[k] += (double)(s->weight[i] * s->ln[i][k]);
		c->weight += (double)s->weight[i];
	}
	for (int r = 0; r < RINGS; r++) {
		int some = 0;
		for (int t = 0; t < TURNS; t++)
			some += raw[r][t].weight > 0;
		known[r] = some * KNOWN >= TURNS;
		for (int t = 0; t < TURNS && known[r]; t++) {
			struct cell *c = &cell[r][t];
			*c = (struct cell){ 0 };
			for (int width = 1; width <= TURNS && c->weight < 1e-3; width *= 2)
				for (int k = -width < -TURNS / 2 ? -TURNS / 2 : -width; k <= width && k < TURNS / 2; k++) {
					const struct cell *b = &raw[r][(t + k + TURNS) % TURNS];
					const double near = 1 - abs(k) / (width + 1.0);
					for (int j = 0; j < 3; j++)
						c->ln[j] += near * b->ln[j];
					c->weight += near * b->weight;
				}
			for (int j = 0; j < 3; j++)
				c->ln[j] /= c->weight;
		}
	}
	// Rings of which hardly anything is seen: under a pupil, at a limbus that runs into the sclera.
	for (int pass = 0; pass < 2; pass++)
		for (int k = 1; k < RINGS; k++) {
			const int r = pass ? RINGS - 1 - k : k, from = pass ? r + 1 : r - 1;
			if (!known[r] && known[from]) {
				memcpy(cell[r], cell[from], sizeof cell[r]);
				known[r] = true;
			}
		}
	free(raw);
}

static void ring_at(float ln[3], struct cell cell[RINGS][TURNS], const struct scene_seen *s, double radius, double turn)
{
	const double y = fmin(fmax(radius / s->limbus * RINGS - 0.5, 0), RINGS - 1.001), x = (turn / (2 * M_PI) + 1) * TURNS - 0.5;
	const int r = (int)y, t = (int)floor(x);
	for (int c = 0; c < 3; c++) {
		double v = 0;
		for (int k = 0; k < 4; k++)
			v += (k / 2 ? y - r : 1 - y + r) * (k % 2 ? x - t : 1 - x + t) * cell[r + k / 2][(t + k % 2) % TURNS].ln[c];
		ln[c] = (float)v;
	}
}

/* Of what differs where it is well seen. */
static double rms_of(const float *a, const float *b, const float *weight)
{
	double sum = 0, n = 0;
	for (int i = 0; i < TEXELS; i++)
		if (weight[i] > 0.5f) {
			const double d = (double)(a[i] - b[i]);
			sum += d * d;
			n++;
		}
	return sqrt(sum / fmax(n, 1));
}

/* Mean of each ring of what is drawn: what is seen of an iris has its own. */
static void ring_means(float mean[RINGS], const float *drawn, const struct scene_seen *s)
{
	double sum[RINGS] = { 0 }, n[RINGS] = { 0 }, turn;
	for (int i = 0; i < TEXELS; i++) {
		const int r = (int)(polar_of(&turn, s, i) / s->limbus * RINGS);
		if (r < RINGS) {
			sum[r] += (double)drawn[i];
			n[r]++;
		}
	}
	for (int r = 0; r < RINGS; r++)
		mean[r] = (float)(sum[r] / fmax(n[r], 1));
}

void scene_seen_fill(struct scene_seen *s, const float *drawn)
{
	const double per_mm = SIDE / (2 * s->extent), sigma = fmin(s->finest, drawn_mm) * per_mm;
	struct cell (*cell)[TURNS] = mem_new(RINGS, sizeof *cell);
	float *green = mem_array(TEXELS, sizeof *green), *fine = mem_new(TEXELS, sizeof *fine), *own = mem_new(TEXELS, sizeof *own), *near = mem_new(TEXELS, sizeof *near), mean[RINGS];
	struct err none = { 0 };
	for (int i = 0; i < TEXELS; i++) {
		double turn;
		if (polar_of(&turn, s, i) < inner_of(s))
			s->weight[i] = 0;
	}
	rings_of(cell, s);
	// How strong fibres are between one and two times the finest that is seen, here and as drawn.
	for (int i = 0; i < TEXELS; i++)
		green[i] = s->ln[i][1];
	bool ok = blur(own, green, s->weight, sigma) && blur(near, green, s->weight, 2 * sigma);
	const double seen = rms_of(own, near, s->weight);
	ok = ok && cv_blur(fine, drawn, SIDE, SIDE, 1, sigma, &none) && cv_blur(near, drawn, SIDE, SIDE, 1, 2 * sigma, &none);
	const double invented = ok ? rms_of(fine, near, s->weight) : 0;
	const float strong = ok ? (float)fmin(fmax(seen / fmax(invented, 1e-6), strength[0]), strength[1]) : 0;  // without: smooth
	ring_means(mean, drawn, s);
	for (int i = 0; i < TEXELS; i++) {
		double turn;
		const double r = polar_of(&turn, s, i);
		float ring[3];
		ring_at(ring, cell, s, r, turn);
		const float w = s->weight[i];
		for (int c = 0; c < 3; c++)
			s->ln[i][c] = w * (s->ln[i][c] + strong * (drawn[i] - fine[i])) + (1 - w) * (ring[c] + strong * (drawn[i] - mean[(int)fmin(r / s->limbus * RINGS, RINGS - 1)]));
	}
	free(cell);
	free(green);
	free(fine);
	free(own);
	free(near);
}
