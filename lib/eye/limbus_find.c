#include "eye/limbus_find.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "eye/limbus_flank.h"
#include "math/stats.h"

static const double OUTER = 0.3;   // least support of a limbus round a pupil, of the pupil's
static const double WHITER = 1.45; // farther out than an edge's outside: that edge is a pupil's
static const double PIXEL_RMS = 0.4;  // px of scatter that pixels and their noise cause in any case
static const double FULL = 0.8, DARK = 0.15;  // share of an edge seen, encoded brightness inside: a pupil's
static const double SIDES_SEEN = 0.55, SIDES_CLEAR = 0.9;  // limbus_flank_around: of a limbus that may be, that must be
static const double CLEAR = 0.55, EXACT = 0.004;  // coverage and scatter at which no other ellipse is tried
static const double FLANK_LEAST = 0.03;     // of the longer side: smaller eyes are not looked for by their sides
static const double FLANK_NEAR = 0.25, FLANK_SIZE = 0.16, FLANK_SUPPORT = 0.19;
static const double FLANK_COOLER = 0.25;     // limbus_flank_cooler: 0.01 to 0.19 for eyes of portraits
static const double FLANK_BEHIND = 0.6;     // of the best circle's worth
static const double FLANK_HINT = 0.15;      // natural logarithm of a hint's radius: its sigma
enum { MIN_SIDE = 96, TRY = 5, FLANK_TRY = 8, MAX_POOL = 2 * SEEK_MAX };

__attribute__((format(printf, 2, 3)))
static bool reject(struct limbus_found *found, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(found->reason, sizeof found->reason, fmt, ap);
	va_end(ap);
	return found->ok = false;
}

static double bright_level(const struct grey *g)
{
	const long n = (long)g->width * g->height;
	double v[1024];
	int count = 0;
	for (long i = 0; i < 1024 && i < n; i++)
		v[count++] = g->px[i * n / (n < 1024 ? n : 1024)];
	return stats_quantile(count, v, 0.9);
}

static bool exposed(struct limbus_found *found, const struct pyramid *pyramid, const struct limbus_conf *conf)
{
	double level = bright_level(&pyramid->bright[pyramid->n - 1]);
	if (pyramid->over > conf->max_over)
		return reject(found, "over-exposed: %.0f %% of it is burnt out; use less light or a shorter exposure",
		              100 * pyramid->over);
	if (level < conf->min_level)
		return reject(found, "under-exposed: nine tenths of it are darker than %.0f %%; use more light or a longer exposure",
		              100 * level);
	return true;
}

/* Ellipses worth measuring, best first: an ellipse round another one (limbus round pupil) goes before it. */
static int gather(struct seek_found pool[MAX_POOL], const struct pyramid *pyramid, const double *hint,
                  const struct limbus_conf *conf)
{
	struct seek_found seen[SEEK_MAX];
	int n = limbus_seek(seen, pyramid, hint, &conf->seek), m = 0;
	for (int i = 0; i < n; i++) {
		struct seek_found outer;
		bool inside = false;
		for (int j = 0; j < m && !inside; j++)
			inside = hypot(seen[i].e.cx - pool[j].e.cx, seen[i].e.cy - pool[j].e.cy) < 0.2 * pool[j].e.b
			         && fabs(seen[i].e.a / pool[j].e.a - 1) < 0.1;
		if (inside)
			continue;
		if (i < TRY && limbus_seek_outer(&outer, pyramid, &seen[i].e, &conf->seek)
		    && outer.score > OUTER * seen[i].score && (!hint || outer.e.b < 1.6 * hint[2]))
			pool[m++] = outer;
		pool[m++] = seen[i];
	}
	return m;
}

static const char COVERED[] = "too much of the limbus is covered by lids or lashes: open the eye wider";

static bool within(const struct ellipse *e, const struct ellipse *around)
{
	return e->a < 0.8 * around->a && hypot(e->cx - around->cx, e->cy - around->cy) < around->b;
}

/* A pupil passes for a limbus but for this: what lies round it is an iris, and farther out it gets whiter. */
static bool is_pupil(const struct rim *rim, const struct grey *white)
{
	enum { RINGS = 6 };
	static const double ring[RINGS] = { 1.6, 2, 2.5, 3, 3.7, 4.5 };
	double near[ARCS], far[RINGS * ARCS];
	int n = 0, m = 0;
	for (int i = 0; i < ARCS; i++) {
		const double dx = rim->p[i][0] - rim->e.cx, dy = rim->p[i][1] - rim->e.cy;
		if (rim->used[i])
			near[n++] = grey_at(white, rim->e.cx + 1.12 * dx, rim->e.cy + 1.12 * dy);
		for (int k = 0; k < RINGS; k++)
			far[m++] = grey_at(white, rim->e.cx + ring[k] * dx, rim->e.cy + ring[k] * dy);
	}
	return stats_quantile(m, far, 0.93) > WHITER * stats_median(n, near);
}

/* A dark disc in full sight with the sides of something larger round it. */
static bool is_dark_disc(const struct rim *rim, const struct photo *photo, const struct grey *bright, double sides)
{
	double in[ARCS], around;
	if (rim->coverage < FULL)
		return false;
	for (int i = 0; i < ARCS; i++)
		in[i] = grey_at(bright, rim->e.cx + 0.8 * (rim->p[i][0] - rim->e.cx), rim->e.cy + 0.8 * (rim->p[i][1] - rim->e.cy));
	if (stats_median(ARCS, in) > DARK)
		return false;
	limbus_flank_around(photo, &rim->e, &around);
	return around > sides;
}

/* Most of what lies outside the edge is burnt out: a bright iris round its pupil then passes for sclera, and a ramp
 * cut off by the sensor is no measure of the limbus. */
static bool is_burnt(const struct rim *rim, const struct grey *white)
{
	int burnt = 0, n = 0;
	for (int i = 0; i < ARCS; i++)
		if (rim->used[i]) {
			const double dx = rim->p[i][0] - rim->e.cx, dy = rim->p[i][1] - rim->e.cy;
			burnt += grey_at(white, rim->e.cx + 1.12 * dx, rim->e.cy + 1.12 * dy) > 0.96;
			n++;
		}
	return burnt > 0.8 * n;
}

static bool is_cut(const struct ellipse *e, const struct photo *photo)
{
	const double c = cos(e->angle), s = sin(e->angle), slack = 0.01 * e->a;
	double hx = hypot(e->a * c, e->b * s), hy = hypot(e->a * s, e->b * c);
	return e->cx - hx < -slack || e->cy - hy < -slack || e->cx + hx > photo->width + slack || e->cy + hy > photo->height + slack;
}

/* The first reason against a measured ellipse, or null. */
static const char *judge(const struct rim *rim, const struct photo *photo, const struct pyramid *pyramid,
                         const struct limbus_conf *conf)
{
	const struct ellipse *e = &rim->e;
	if (is_cut(e, photo))
		return "the iris is cut by the frame: show all of it with some white around";
	if (rim->contrast < conf->min_contrast)
		return "no clear edge between iris and sclera: light the eye evenly and focus on the iris";
	if (rim->width > conf->max_blur * e->a)
		return "too blurred: focus on the iris and hold the camera still";
	if (rim->rms > conf->max_rms * e->a + PIXEL_RMS)
		return "no clear ellipse: the eye is closed, hidden, or not there; open the eye wide and photograph it straight";
	if (is_burnt(rim, &pyramid->level[0]))
		return "over-exposed round the iris: the white of the eye is burnt out; use less light or a shorter exposure";
	if ((!conf->rim.settled && is_pupil(rim, &pyramid->level[0]))
	    || is_dark_disc(rim, photo, &pyramid->bright[0], conf->rim.settled ? 0 : SIDES_SEEN))
		return "only the pupil stands out, no limbus round it: show the whole iris, evenly lit";
	double sigma[ELLIPSE_N], worst = 0;
	ellipse_sigma(sigma, e, rim->cov_q);
	for (int i = 0; i < 4; i++)
		worst = fmax(worst, sigma[i]);
	if (rim->coverage < conf->min_coverage || worst > conf->max_sigma * e->a)
		return COVERED;
	return 0;
}

/* around: a limbus that was seen but could not be measured; what lies inside it is none. */
static bool measure(struct limbus_found *found, struct ellipse *around, const struct photo *photo,
                    const struct pyramid *pyramid, const double *hint, const struct limbus_conf *conf)
{
	struct seek_found pool[MAX_POOL];
	int n = gather(pool, pyramid, hint, conf);
	const char *why = 0;
	struct rim *rim = mem_new(1, sizeof *rim);
	double best = 0;
	for (int i = 0; i < n && i < TRY; i++) {
		if (within(&pool[i].e, around))
			continue;  // what lies inside a limbus is its pupil, or a part of it
		if (!rim_fit(rim, photo, &pyramid->tint, &pool[i].e, &conf->rim))
			continue;
		const char *against = judge(rim, photo, pyramid, conf);
		double quality = rim->share_used * rim->e.a;
		if (against == COVERED && rim->rms < EXACT * rim->e.a + PIXEL_RMS && rim->e.a > around->a)
			*around = rim->e;
		if (!against && quality > best) {
			best = quality;
			*around = rim->e;
			found->limbus = *rim;
			found->score = pool[i].score;
			found->ok = true;
		}
		if (!against && rim->coverage > CLEAR && rim->rms < EXACT * rim->e.a)
			break;
		if (!why)
			why = against;
	}
	free(rim);
	if (found->ok)
		return true;
	if (why)
		return reject(found, "%s", why);
	return reject(found, "no eye found: photograph one open eye close up, or say where it is with photo.NAME.hint_px");
}

/* Settled circles of limbus_flanks, best first; those far behind the best are left out. Both sides of a pupil are clear
 * too, but the limbus is larger. */
static int gather_flanks(struct seek_found pool[SEEK_MAX], const struct photo *photo, const double *hint,
                         const struct limbus_conf *conf)
{
	const double longer = fmax(photo->width, photo->height), shorter = fmin(photo->width, photo->height);
	double lo = fmax(conf->seek.min_radius, FLANK_LEAST) * longer, value[SEEK_MAX];
	int n = limbus_flanks(pool, photo, hint, lo, conf->seek.max_radius * shorter);
	n = n < FLANK_TRY ? n : FLANK_TRY;
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < n; i++) {
		value[i] = pool[i].score;
		value[i] *= limbus_flank_settle(&pool[i], photo) ? pool[i].score * pow(pool[i].e.a, 0.25) : 0;
		if (hint)  // it says how large as well
			value[i] *= exp(-0.5 * pow(log(pool[i].e.a / hint[2]) / FLANK_HINT, 2));
	}
	for (int i = 1; i < n; i++)
		for (int j = i; j > 0 && value[j] > value[j - 1]; j--) {
			struct seek_found f = pool[j];
			double v = value[j];
			pool[j] = pool[j - 1];
			value[j] = value[j - 1];
			pool[j - 1] = f;
			value[j - 1] = v;
		}
	while (n > 0 && value[n - 1] < FLANK_BEHIND * value[0])
		n--;
	return n;
}

/* The blurred step's ellipse says what the sides of the limbus said. */
static bool agrees(const struct ellipse *e, const struct ellipse *settled)
{
	return hypot(e->cx - settled->cx, e->cy - settled->cy) < FLANK_NEAR * settled->a
	       && fabs(e->a / settled->a - 1) < FLANK_SIZE;
}

static bool has_sides_around(const struct photo *photo, const struct ellipse *e)
{
	double sides;
	limbus_flank_around(photo, e, &sides);
	return sides > SIDES_CLEAR;
}

/* around: what lies inside is the pupil of what was tried before.
 * Where the search by whiteness found nothing it could vouch for, or a hint says where the eye is: by the sides of the
 * limbus. Real sclera is shaded and coloured, and lids are at its rim: the edge scatters more than a step should. */
static bool measure_flanks(struct limbus_found *found, struct ellipse around, const struct photo *photo,
                           const struct pyramid *pyramid, const double *hint, const struct limbus_conf *conf)
{
	struct seek_found pool[SEEK_MAX];
	struct limbus_conf loose = *conf;
	struct rim *rim = mem_new(1, sizeof *rim);
	loose.rim.settled = true;
	loose.max_rms = conf->max_flank_rms;
	loose.max_sigma = conf->max_flank_sigma;
	loose.min_coverage = conf->min_flank_coverage;
	int n = gather_flanks(pool, photo, hint, conf);
	for (int i = 0; i < n && i < TRY && !found->ok && !(n && is_cut(&pool[0].e, photo)); i++) {
		if (pool[i].score < FLANK_SUPPORT || within(&pool[i].e, &around))
			continue;
		around = pool[i].e.a > around.a ? pool[i].e : around;
		for (int k = 0; k < 2 && !found->ok; k++) {
			if (!rim_fit(rim, photo, k ? 0 : &pyramid->tint, &pool[i].e, &loose.rim) || !agrees(&rim->e, &pool[i].e))
				continue;
			if (judge(rim, photo, pyramid, &loose) || (!hint && (has_sides_around(photo, &rim->e) || limbus_flank_cooler(photo, &rim->e) > FLANK_COOLER)))
				continue;
			found->limbus = *rim;
			found->score = pool[i].score;
			found->ok = true;
		}
	}
	free(rim);
	return found->ok;
}

/* What the search by whiteness vouches for with half an eye only is asked of the sides of the limbus too. */
static void second_opinion(struct limbus_found *found, const struct photo *photo, const struct pyramid *pyramid,
                           const struct limbus_conf *conf)
{
	const struct rim *rim = &found->limbus;
	if (rim->coverage > CLEAR || rim->rms < EXACT * rim->e.a)
		return;
	struct limbus_found *other = mem_new(1, sizeof *other);
	if (measure_flanks(other, (struct ellipse){ 0 }, photo, pyramid, 0, conf) && !agrees(&rim->e, &other->limbus.e))
		*found = *other;
	free(other);
}

void limbus_find(struct limbus_found *found, const struct photo *photo, const double *hint,
                 const struct limbus_conf *conf)
{
	memset(found, 0, sizeof *found);
	if (photo->width < MIN_SIDE || photo->height < MIN_SIDE) {
		reject(found, "%d x %d px is too small: the iris must be at least 80 px across", photo->width, photo->height);
		return;
	}
	struct pyramid pyramid = pyramid_make(photo);
	struct ellipse around = { 0 };
	if (exposed(found, &pyramid, conf) && !(hint && measure_flanks(found, around, photo, &pyramid, hint, conf))) {
		if (measure(found, &around, photo, &pyramid, hint, conf) && !hint)
			second_opinion(found, photo, &pyramid, conf);
		else if (!found->ok && !hint)
			measure_flanks(found, around, photo, &pyramid, 0, conf);
	}
	if (found->ok) {
		band_sample(&found->band, &pyramid, &found->limbus);
		found->has_pupil = limbus_pupil(&found->pupil, photo, &pyramid, &found->limbus.e, &conf->rim, &conf->pupil);
	}
	pyramid_free(&pyramid);
}
