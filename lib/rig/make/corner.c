/* The inner corner of an eye: a caruncle, and the fold beside it, the plica semilunaris, as a sheet over the globe that follows both lids. */
#include <math.h>

#include "math/rising.h"
#include "math/vec.h"
#include "rig/deform/opening.h"
#include "rig/make/lining_impl.h"

/* Of an eyeball of 12 mm, mm. */
static const double near_mm[] = { 0.8, 3 }; // skin so far from a place of the margin tells how it moves: of a normal distribution; at most
static const double crest_mm = 0.28, valley_mm = 0.16, mound_mm = 0.75;  // heights over the globe: of the plica, behind it, of the caruncle
static const double tuck_mm = 1.3;          // how far they go on below the lids
static const double white = 0.6;            // of what is seen of the white at that corner, at most, lies below them
static const double limbus_mm = 5.9;

enum { ALONG = 11, ACROSS = 9 };  // columns from the corner towards the iris, rows from the lower lid up

/* The inner corner as the front sees it at rest: mm about the eyeball's centre, the head's axes. */
struct corner {
	const struct rig *rig;
	const struct deform_opening *open;
	int side, inner;      // column of the opening nearest to the nose
	double unit, width;   // of caruncle and plica, mm
};

/* Away from the nose. */
static int away(const struct corner *k)
{
	return k->side ? -1 : 1;
}

/* Heights of the lids' margins s mm from the corner; before it both lids lie at its middle. */
static void lids_at(double y[2], const struct corner *k, double s)
{
	const double i = fmax(s, 0) / k->open->step;
	const int a = k->inner + away(k) * (int)i, b = a + away(k);
	const double u = i - floor(i);
	y[0] = k->open->bottom[a] + u * (k->open->bottom[b] - k->open->bottom[a]);
	y[1] = k->open->top[a] + u * (k->open->top[b] - k->open->top[a]);
}

/* A direction from the front's place. */
static void place_of(double head[3], const struct corner *k, double s, double y)
{
	const double x = k->open->step * (k->inner - DEFORM_COLUMNS / 2) + away(k) * s, most = 0.98 * k->rig->globe[k->side].radius, off = fmax(hypot(x, y) / most, 1);
	head[0] = x / off;
	head[1] = y / off;
	head[2] = sqrt(fmax(k->rig->globe[k->side].radius * k->rig->globe[k->side].radius - head[0] * head[0] - head[1] * head[1], 0));
}

/* How the lid of that margin moves at a place: the mean of its skin near it. share: of all. */
static void follow_lid(struct lining *m, const struct corner *k, double s, bool upper, double share)
{
	const struct rig *rig = k->rig;
	double y[2], head[3], all = 0, middle;
	float at[3];
	lids_at(y, k, s);
	middle = 0.5 * (y[0] + y[1]);
	place_of(head, k, fmax(s, 0), y[upper]);
	double p[3];
	lining_over_globe(p, rig, k->side, head, 0.5 * k->unit);
	for (int c = 0; c < 3; c++)
		at[c] = (float)p[c];
	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < rig->n; i++) {
			double q[3], d[3];
			if (rig->part[i] != RIG_SKIN || rig->side[i] != k->side || rig->gap[i] > near_mm[1] * k->unit)
				continue;
			for (int c = 0; c < 3; c++)
				d[c] = rig->rest[i][c] - at[c];
			const double off = vec_norm(d) / k->unit;
			if (off > near_mm[1])
				continue;
			deform_in_head(q, rig, k->side, rig->rest[i]);
			const double beside = (upper ? q[1] - middle : middle - q[1]) / k->unit, own = fmin(fmax(0.5 + beside, 0.02), 1);
			const double w = own * exp(-0.5 * off * off / (near_mm[0] * near_mm[0]));
			if (pass == 0)
				all += w;
			else if (w > 1e-4 * all)
				lining_follow(m, i, share * w / all);
		}
}

/* Height over the globe: r 0 at the corner, 1 at the plica's edge; t 0 at the lower margin, 1 at the upper one. */
static double height_at(const struct corner *k, double r, double t, double least)
{
	const double along = fmin(fmax(t, 0), 1), round = sqrt(fmax(1 - (2 * along - 1) * (2 * along - 1), 0));
	const double plica = crest_mm * rising(r, 1, 0.86) * (1 - rising(r, 0.86, 0.62)) + valley_mm * (1 - rising(r, 0.6, 0.9));
	const double mound = (mound_mm - valley_mm) * (1 - rising(r, 0.12, 0.62)) * rising(r, -0.5, 0.05);
	return fmax(k->unit * (plica * (0.4 + 0.6 * round) + mound * round), least);
}

static void add_corner(struct lining *m, const struct corner *k, const struct rig_conf *conf)
{
	const double tuck = tuck_mm * k->unit;
	const int32_t first = m->first + m->n;
	for (int j = 0; j < ALONG; j++)
		for (int i = 0; i < ACROSS; i++) {
			// The rows beside the first and the last, and the first column, lie below the lids.
			const double t = (double)(i - 1) / (ACROSS - 3), u = 2 * fmin(fmax(t, 0), 1) - 1, edge = k->width * (0.72 + 0.28 * u * u);
			const double s = j == 0 ? -tuck : edge * (j - 1) / (ALONG - 2);
			double y[2], head[3], at[3];
			lids_at(y, k, s);
			const double inside = fmin(fmax(t, 0), 1), height = y[0] + inside * (y[1] - y[0]) + (t < 0 ? -tuck : t > 1 ? tuck : 0);
			const bool below = t < 0 || t > 1;
			const double gap = below ? conf->least : height_at(k, s / edge, t, conf->least);
			place_of(head, k, s, height);
			lining_over_globe(at, k->rig, k->side, head, gap);
			lining_vertex(m, at, gap);
			if (inside < 1)
				follow_lid(m, k, s, false, 1 - inside);
			if (inside > 0)
				follow_lid(m, k, s, true, inside);
		}
	for (int j = 0; j + 1 < ALONG; j++)
		for (int i = 0; i + 1 < ACROSS; i++) {
			const int32_t a = first + j * ACROSS + i, b = a + ACROSS, c = a + 1, d = b + 1;
			lining_face(m, a, k->side ? c : b, k->side ? b : c);
			lining_face(m, d, k->side ? b : c, k->side ? c : b);
		}
}

void lining_corners(struct lining *m, const struct rig *rig, const struct rig_conf *conf)
{
	enum { LEAST = 20 };
	struct deform_near near = deform_near_of(rig);
	for (int side = 0; side < 2; side++) {
		const struct deform_opening *o = &near.rest[side];
		struct corner k = { rig, o, side, side ? o->last : o->first, rig->globe[side].radius / 12, 0 };
		if (o->last - o->first < LEAST)
			continue;
		const double end = fabs(o->step * (k.inner - DEFORM_COLUMNS / 2)), all = (o->last - o->first) * o->step;
		k.width = fmin(fmin(conf->caruncle * k.unit, white * (end - limbus_mm * k.unit)), 0.3 * all);
		m->side = side;
		if (k.width > 4 * o->step)
			add_corner(m, &k, conf);
	}
	deform_near_free(&near);
}
