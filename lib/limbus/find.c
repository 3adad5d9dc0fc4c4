#include "limbus/find.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/hand.h"
#include "limbus/judge.h"
#include "limbus/propose/sides.h"
#include "math/stats.h"

static const double OUTER = 0.3;   // least support of a limbus round a pupil, of the pupil's
static const double ROUGH = 0.012;  // scatter, share of the semi-axis, from which an ellipse counts less
static const double CLEAR = 0.55;  // coverage at which, if it is exact, no other ellipse is tried
enum { MIN_SIDE = 96, TRY = 5, MAX_POOL = 2 * SEEK_MAX };

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
		if (limbus_within(&pool[i].e, around))
			continue;  // what lies inside a limbus is its pupil, or a part of it
		if (!rim_fit(rim, photo, &pyramid->tint, &pool[i].e, &conf->rim))
			continue;
		const char *against = limbus_judge(rim, photo, pyramid, conf);
		if (against == LIMBUS_COVERED && limbus_measure_centred(rim, &pool[i].e, photo, pyramid, conf))
			against = 0;
		double quality = rim->share_used * rim->e.a * fmin(pow(ROUGH * rim->e.a / rim->rms, 2), 1);
		if (against == LIMBUS_COVERED && rim->rms < LIMBUS_EXACT * rim->e.a + LIMBUS_PIXEL_RMS && rim->e.a > around->a)
			*around = rim->e;
		if (!against && quality > best) {
			best = quality;
			*around = rim->e;
			found->limbus = *rim;
			found->score = pool[i].score;
			found->ok = true;
		}
		if (!against && rim->coverage > CLEAR && rim->rms < LIMBUS_EXACT * rim->e.a)
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

/* An ellipse that the search by whiteness is not sure of is replaced by the one of the limbus' two sides, or rejected. */
static void second_opinion(struct limbus_found *found, const struct photo *photo, const struct pyramid *pyramid,
                           const struct limbus_conf *conf)
{
	const struct rim *rim = &found->limbus;
	if ((rim->coverage > CLEAR && limbus_sure(rim, NAN, photo, pyramid))
	    || limbus_sure(rim, limbus_pupil_off(&rim->e, photo, pyramid, conf), photo, pyramid))
		return;
	struct limbus_found *other = mem_new(1, sizeof *other);
	if (!limbus_measure_flanks(other, (struct ellipse){ 0 }, photo, pyramid, 0, conf))
		reject(found, "%s", LIMBUS_UNCLEAR);
	else if (!limbus_agrees(&found->limbus.e, &other->limbus.e))
		*found = *other;
	free(other);
}

/* What else is measured of a limbus that was found: the band round it, the pupil. */
static void finish(struct limbus_found *found, const struct photo *photo, const struct pyramid *pyramid, const struct limbus_conf *conf)
{
	if (!found->ok)
		return;
	band_sample(&found->band, pyramid, &found->limbus);
	found->has_pupil = limbus_pupil(&found->pupil, photo, pyramid, &found->limbus.e, &conf->rim, &conf->pupil);
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
	if (exposed(found, &pyramid, conf) && !(hint && limbus_measure_flanks(found, around, photo, &pyramid, hint, conf))) {
		if (measure(found, &around, photo, &pyramid, hint, conf) && !hint)
			second_opinion(found, photo, &pyramid, conf);
		else if (!found->ok && !hint)
			limbus_measure_flanks(found, around, photo, &pyramid, 0, conf);
	}
	const struct ellipse meant = hint ? (struct ellipse){ hint[0], hint[1], hint[2], hint[2], 0 } : (struct ellipse){ 0 };
	if (hint && !(found->ok && limbus_hand_near(&found->limbus.e, &meant)))
		limbus_by_hand(found, photo, &pyramid, &meant, conf->hint_sigma, conf);
	finish(found, photo, &pyramid, conf);
	pyramid_free(&pyramid);
}

void limbus_find_drawn(struct limbus_found *found, const struct photo *photo, const struct ellipse *drawn, const struct limbus_conf *conf)
{
	memset(found, 0, sizeof *found);
	struct pyramid pyramid = pyramid_make(photo);
	limbus_by_hand(found, photo, &pyramid, drawn, conf->drawn_sigma, conf);
	finish(found, photo, &pyramid, conf);
	pyramid_free(&pyramid);
}
