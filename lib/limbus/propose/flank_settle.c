#include "limbus/propose/flank_settle.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "limbus/propose/flank_map.h"
#include "math/stats.h"

enum { POINTS = 96, ROUND = 3 };
static const double RADIUS_PX = 48;              // of the map that is made for it
static const double MOST = 0.8;                  // a step counts no further
static const double NEAR = 0.04, FAR = 0.12;     // of the radius: it is measured over two distances
static const double ASPECT = 0.92, SPREAD = 0.1; // what a limbus looks like, seen within some 35 degrees

static const double DARKER = 0.3;                // ln of green below the picture's median: dark
static const double REDDER = 0.25;               // ln(red / blue) of skin over that of sclera, about

/* ln(red / blue) at (x, y), map px. */
static double warmth(const struct log_map *m, double x, double y)
{
	int i = (int)(x + 0.5), j = (int)(y + 0.5);
	if (i < 0 || j < 0 || i >= m->width || j >= m->height)
		return INFINITY;
	const float *p = m->px[(long)j * m->width + i];
	return (double)(p[0] - p[2]);
}

/* Mean step along the ellipse: the smaller of a near and a far one, so that a dark line is no edge; less where what lies
 * outside is warmer than the sclera, as lids are. Where there is no step it counts as nothing, whatever hides it. */
static double support(const struct log_map *m, const struct ellipse *e, double white)
{
	double sum = 0, c = cos(e->angle), s = sin(e->angle), k = 1 / m->scale;
	for (int i = 0; i < POINTS; i++) {
		double t = 2 * M_PI * i / POINTS, ct = cos(t), st = sin(t);
		double nx = e->b * ct, ny = e->a * st, n = sqrt(nx * nx + ny * ny);
		double ux = (c * nx - s * ny) / n, uy = (s * nx + c * ny) / n;
		double x = (e->cx + c * e->a * ct - s * e->b * st - m->x0) * k - 0.5;
		double y = (e->cy + s * e->a * ct + c * e->b * st - m->y0) * k - 0.5, d = INFINITY;
		for (int j = 0; j < 2; j++) {
			double g = (j ? FAR : NEAR) * e->b * k;
			double step = log_map_step(m, (float)(x - g * ux), (float)(y - g * uy), (float)(x + g * ux), (float)(y + g * uy));
			d = fmin(d, step * (j ? 1 : 1.5));
		}
		double g = FAR * e->b * k, z = fmax(warmth(m, x + g * ux, y + g * uy) - white, 0) / REDDER;
		sum += fmin(fmax(d, 0), MOST) / (1 + z * z);
	}
	return sum / POINTS;
}

/* The warmth of the sclera: of the less warm of what lies beside the circle. */
static double sclera_warmth(const struct log_map *m, const struct ellipse *e)
{
	static const double ring[] = { 1.12, 1.25, 1.4 };
	double v[POINTS * 3];
	int n = 0;
	for (int i = 0; i < POINTS; i++)
		for (int j = 0; j < 3; j++) {
			double t = 2 * M_PI * i / POINTS, r = ring[j] * e->a;
			double w = warmth(m, (e->cx + r * cos(t) - m->x0) / m->scale - 0.5, (e->cy + r * sin(t) - m->y0) / m->scale - 0.5);
			if (isfinite(w))
				v[n++] = w;
		}
	return n ? stats_quantile(n, v, 0.12) : 0;
}

struct climb {
	const struct log_map *map;
	double white;
};

static double worth(const void *ctx, const struct ellipse *e)
{
	const struct climb *c = ctx;
	double z = (e->b / e->a - ASPECT) / SPREAD;
	return support(c->map, e, c->white) - 0.01 * z * z;
}

bool limbus_flank_settle(struct seek_found *found, const struct photo *photo)
{
	const struct ellipse *c = &found->e;
	double reach = 1.7 * c->a, box[4] = { c->cx - reach, c->cy - reach, c->cx + reach, c->cy + reach }, best = -INFINITY;
	struct log_map m = log_map_make(photo, box, c->a / RADIUS_PX);
	struct ellipse top = *c;
	const double white = sclera_warmth(&m, c), least_aspect = 0.6;
	for (int i = 0; i < ROUND * ROUND * ROUND; i++) {
		struct ellipse e = *c;
		e.cx += 0.12 * c->a * (i % ROUND - 1);
		e.cy += 0.12 * c->a * (i / ROUND % ROUND - 1);
		e.a *= pow(1.1, i / ROUND / ROUND - 1);
		e.b = ASPECT * e.a;
		double now = ellipse_climb(&e, 0.06 * c->a, 0.03 * c->a, least_aspect, worth, &(struct climb){ &m, white });
		if (now > best) {
			best = now;
			top = e;
		}
	}
	ellipse_climb(&top, 0.04 * c->a, 0.005 * c->a, least_aspect, worth, &(struct climb){ &m, white });
	found->e = top;
	found->score = support(&m, &top, white);
	free(m.px);
	return found->score > 0;
}

double limbus_flank_cooler(const struct photo *photo, const struct ellipse *e)
{
	double box[4] = { 0, 0, photo->width, photo->height };
	struct log_map m = log_map_make(photo, box, fmax(photo->width, photo->height) / 200.0);
	const long n = (long)m.width * m.height;
	double white = sclera_warmth(&m, e), cooler = 0, light = 0, *green = mem_array((size_t)n, sizeof *green);
	for (long i = 0; i < n; i++)
		green[i] = (double)m.px[i][1];
	double least = stats_median((int)n, green) - DARKER;
	for (long i = 0; i < n; i++)
		if ((double)m.px[i][1] > least) {
			light++;
			cooler += (double)(m.px[i][0] - m.px[i][2]) < white;
		}
	free(green);
	free(m.px);
	return cooler / fmax(light, 1);
}
