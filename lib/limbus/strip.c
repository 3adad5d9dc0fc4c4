#include "limbus/strip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/photo/part.h"
#include "image/plane.h"

enum { PART = 224 };               // px, sides of the part of the photograph that rays cross
static const double REACH = 1.44;  // semi-axes: what the part shows to each side

void strip_place(double p[2], const struct ellipse *e, int ray, double s)
{
	const double phi = 2 * M_PI * ray / STRIP_RAYS;
	double d[2];
	ellipse_span(d, e, cos(phi), sin(phi));
	p[0] = e->cx + s * d[0];
	p[1] = e->cy + s * d[1];
}

/* Where a ray along (dx, dy) from the centre of one ellipse leaves another. */
struct leaving { double c, s, a, b, ou, ov, rest; };

static struct leaving leaving_of(const struct ellipse *e, const struct ellipse *other)
{
	const double c = cos(other->angle), s = sin(other->angle), ox = e->cx - other->cx, oy = e->cy - other->cy;
	const double ou = (c * ox + s * oy) / other->a, ov = (c * oy - s * ox) / other->b;
	return (struct leaving){ c, s, other->a, other->b, ou, ov, ou * ou + ov * ov - 1 };
}

static double leaves(const struct leaving *o, double dx, double dy)
{
	const double du = (o->c * dx + o->s * dy) / o->a, dv = (o->c * dy - o->s * dx) / o->b;
	const double a = du * du + dv * dv, b = du * o->ou + dv * o->ov, left = b * b - a * o->rest;
	return left < 0 ? NAN : (-b + sqrt(left)) / a;
}

/* The ray to the ellipse. */
static void direction(double d[2], const struct ellipse *e, int ray)
{
	double p[2];
	strip_place(p, e, ray, 1);
	d[0] = p[0] - e->cx;
	d[1] = p[1] - e->cy;
}

double strip_crossing(const struct ellipse *e, int ray, const struct ellipse *other)
{
	const struct leaving o = leaving_of(e, other);
	double d[2];
	direction(d, e, ray);
	return leaves(&o, d[0], d[1]);
}

static void ray_samples(float out[STRIP_PLANES][STRIP_ROWS][STRIP_RAYS], int ray, const float *part, double x0, double y0, double scale,
                        const struct photo *photo, const struct evidence *evidence, const struct ellipse *e)
{
	double at[2];
	strip_place(at, e, ray, 1);
	const double dx = at[0] - e->cx, dy = at[1] - e->cy;
	for (int row = 0; row < STRIP_ROWS; row++) {
		const double s = STRIP_FROM + (row + 0.5) * STRIP_STEP, x = e->cx + s * dx, y = e->cy + s * dy;
		for (int c = 0; c < 3; c++)
			out[c][row][ray] = plane_sample(part + c * PART * PART, PART, PART, (x - x0) / scale, (y - y0) / scale);
		float told[EVIDENCE_TOLD];
		evidence_told(told, evidence, x, y);
		for (int k = 0; k < EVIDENCE_TOLD; k++)
			out[3 + k][row][ray] = told[k];
		out[7][row][ray] = x > 0 && y > 0 && x < photo->width && y < photo->height;
	}
}

void strip_sample(float out[STRIP_PLANES][STRIP_ROWS][STRIP_RAYS], const struct photo *photo, const struct evidence *evidence,
                  const struct ellipse *e)
{
	const double scale = 2 * REACH * e->a / PART, x0 = e->cx - REACH * e->a, y0 = e->cy - REACH * e->a;
	float *part = photo_part(photo, x0, y0, scale, PART, PART);
#pragma omp parallel for
	for (int j = 0; j < STRIP_RAYS; j++)
		ray_samples(out, j, part, x0, y0, scale, photo, evidence, e);
	free(part);
}

static double row_of(double s)
{
	return (s - STRIP_FROM) / STRIP_STEP - 0.5;
}

/* Chance of a place of a ray, between rows; 0 beyond the strip. */
static double chance_at(const struct strip *strip, int ray, double row)
{
	if (!(row > 0 && row < STRIP_ROWS - 1))
		return 0;
	const int i = (int)row;
	return strip->row[i][ray] + (row - i) * (strip->row[i + 1][ray] - strip->row[i][ray]);
}

/* What a ray counts for beside the others. */
static double count_of(const struct strip *strip, int ray)
{
	return strip->seen[ray] / strip->conf.rays + (1 - strip->seen[ray]) / strip->conf.hidden;
}

/* All rays of a strip, and what each counts for: the same for every ellipse that is weighed. */
struct rays { double d[STRIP_RAYS][2], count[STRIP_RAYS]; };

static void rays_of(struct rays *rays, const struct strip *strip)
{
	for (int j = 0; j < STRIP_RAYS; j++) {
		direction(rays->d[j], &strip->e, j);
		rays->count[j] = count_of(strip, j);
	}
}

static double worth_of(const struct strip *strip, const struct rays *rays, const struct ellipse *e)
{
	const struct leaving o = leaving_of(&strip->e, e);
	const double least = strip->conf.least;
	double sum = 0;
	for (int j = 0; j < STRIP_RAYS; j++)
		sum += rays->count[j] * log((1 - least) * STRIP_ROWS * chance_at(strip, j, row_of(leaves(&o, rays->d[j][0], rays->d[j][1]))) + least);
	return sum;
}

double strip_worth(const struct strip *strip, const struct ellipse *e)
{
	struct rays rays;
	rays_of(&rays, strip);
	return worth_of(strip, &rays, e);
}

/* Mean and spread of a ray's place within so many rows of `row`; its chance. */
static double place_near(double *mean, double *spread, const struct strip *strip, int ray, double rows, double row)
{
	double sum = 0, first = 0, second = 0;
	for (int i = (int)fmax(ceil(row - rows), 0); i <= row + rows && i < STRIP_ROWS; i++) {
		const double chance = strip->row[i][ray], d = i - row;
		sum += chance;
		first += chance * d;
		second += chance * d * d;
	}
	*mean = sum > 0 ? first / sum : 0;
	*spread = sum > 0 ? sqrt(fmax(second / sum - *mean * *mean, 0)) : 0;
	return sum;
}

struct search { const struct strip *strip; const struct region_map *map; double start[ELLIPSE_N]; struct rays rays; };

static double worth(const void *ctx, const struct ellipse *e)
{
	const struct search *s = ctx;
	const struct strip_conf *conf = &s->strip->conf;
	const struct ellipse *round = &s->strip->e;
	double q[ELLIPSE_N], off = 0;
	// what lies mostly beyond the strip is not for it to tell
	if (fabs(log(e->a / round->a)) > conf->reach[0] || hypot(e->cx - round->cx, e->cy - round->cy) > conf->reach[1] * round->a)
		return -INFINITY;
	ellipse_to_q(q, e);
	for (int i = 0; i < ELLIPSE_N; i++)
		off += 0.5 * pow((q[i] - s->start[i]) / (conf->start_sigma[i >= 3] * s->start[2]), 2);
	return worth_of(s->strip, &s->rays, e) + region_worth(s->map, e) / conf->pixels - off;
}

bool strip_fit(struct ellipse *e, struct ellipse_fit *fit, const struct strip *strip, const struct region_map *map, const double sigma[ELLIPSE_N])
{
	const struct strip_conf *conf = &strip->conf;
	const double row_px = STRIP_STEP * strip->e.a;
	struct search search = { .strip = strip, .map = map };
	struct ellipse_prior known = { .alike = conf->rays };
	double p[STRIP_RAYS][2], weight[STRIP_RAYS];
	int n = 0, seen = 0;
	rays_of(&search.rays, strip);
	ellipse_to_q(search.start, e);
	ellipse_climb(e, 8 * row_px, 0.1 * row_px, 0.5, worth, &search);
	ellipse_to_q(known.q, e);
	memcpy(known.sigma, sigma, sizeof known.sigma);
	for (int j = 0; j < STRIP_RAYS; j++) {
		const double row = row_of(strip_crossing(&strip->e, j, e));
		double mean, spread;
		if (!isfinite(row))
			continue;
		const bool visible = strip->seen[j] * place_near(&mean, &spread, strip, j, conf->near, row) > conf->seen;
		if (!visible && strip->seen[j] < conf->seen)
			place_near(&mean, &spread, strip, j, STRIP_ROWS, row);
		else if (!visible)
			continue;
		strip_place(p[n], &strip->e, j, STRIP_FROM + (row + mean + 0.5) * STRIP_STEP);
		weight[n++] = conf->rays * count_of(strip, j) / (spread * spread + conf->noise * conf->noise);
		seen += visible;
	}
	if (!seen || !ellipse_fit_near(e, fit, n, (const double (*)[2])p, weight, 0, conf->noise * row_px, &known))
		return false;
	for (int a = 0; a < ELLIPSE_N; a++)
		for (int b = 0; b < ELLIPSE_N; b++)
			fit->cov_q[a][b] = conf->rays * fit->cov_q[a][b] + fit->known_q[a][b];
	return true;
}

/* Mean chance of being seen of the rays round one. */
static double seen_about(const struct strip *strip, int ray)
{
	enum { BESIDE = 6 };  // 17 degrees to each side
	double sum = 0;
	for (int k = -BESIDE; k <= BESIDE; k++)
		sum += strip->seen[(ray + k + STRIP_RAYS) % STRIP_RAYS] / (2 * BESIDE + 1);
	return sum;
}

static double least_end(const struct strip *strip)
{
	double least = 1;
	for (int j = 0; j < STRIP_RAYS / 2; j++)
		least = fmin(least, fmax(seen_about(strip, j), seen_about(strip, j + STRIP_RAYS / 2)));
	return least;
}

struct strip_accord strip_accord_of(const struct strip *strip, const struct ellipse *e)
{
	struct strip_accord a = { .worth = strip_worth(strip, e), .end = least_end(strip) };
	double weight = 0, square = 0, within = 0, beyond = 0;
	for (int j = 0; j < STRIP_RAYS; j++) {
		const double row = row_of(strip_crossing(&strip->e, j, e)), seen = strip->seen[j];
		double mean, spread;
		a.seen += seen;
		for (int i = 0; i < STRIP_ROWS; i++) {
			const double d = isfinite(row) ? fabs(i - row) * STRIP_STEP : 1;
			within += d < 0.025 ? seen * strip->row[i][j] : 0;
			beyond += d > 0.05 ? seen * strip->row[i][j] : 0;
		}
		const double chance = isfinite(row) ? seen * place_near(&mean, &spread, strip, j, strip->conf.near, row) : 0;
		if (chance > strip->conf.seen) {
			weight += chance;
			square += chance * mean * mean;
		}
	}
	a.on = within / (a.seen + 1);
	a.off = beyond / (a.seen + 1);
	a.seen /= STRIP_RAYS;
	a.scatter = weight > 0 ? sqrt(square / weight) * STRIP_STEP : 0;
	return a;
}

struct grey strip_seen(const struct strip *strip)
{
	enum { SIDE = 160, UNIT = 40 };
	const struct ellipse *e = &strip->e;
	const double scale = e->a / UNIT;
	struct grey g = { SIDE, SIDE, e->cx - 0.5 * SIDE * scale, e->cy - 0.5 * SIDE * scale, scale, mem_array(SIDE * SIDE, sizeof *g.px), 0 };
	double q[ELLIPSE_N];
	ellipse_to_q(q, e);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			const double dx = g.x0 + (x + 0.5) * scale - e->cx, dy = g.y0 + (y + 0.5) * scale - e->cy;
			// along S^-1 (dx, dy)
			const double phi = atan2((q[2] + q[3]) * dy - q[4] * dx, (q[2] - q[3]) * dx - q[4] * dy);
			const double at = (phi / (2 * M_PI) + 1) * STRIP_RAYS;
			const int j = (int)at;
			const double f = at - j;
			const double seen = (1 - f) * strip->seen[j % STRIP_RAYS] + f * strip->seen[(j + 1) % STRIP_RAYS];
			g.px[y * SIDE + x] = (float)(seen * seen) + 0.02F;
		}
	return g;
}
