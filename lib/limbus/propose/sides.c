#include "limbus/propose/sides.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "limbus/judge.h"
#include "limbus/propose/flank.h"
#include "limbus/propose/flank_settle.h"

enum { FLANK_TRY = 8, ROUND_TRY = 3 };
static const double FLANK_LEAST = 0.03;     // of the longer side: smaller eyes are not looked for by their sides
static const double FLANK_NEAR = 0.25, FLANK_SIZE = 0.16, FLANK_SUPPORT = 0.19;
static const double FLANK_COOLER = 0.25;    // limbus_flank_cooler: 0.01 to 0.19 for eyes of portraits
static const double FLANK_BEHIND = 0.6;     // of the best circle's worth
static const double FLANK_HINT = 0.15;      // natural logarithm of a hint's radius: its sigma
static const double ROUND_SUPPORT = 0.08;   // of what is round a pupil and has it in its middle
static const double RING_GAP = 0.05;        // that of a limbal ring: pale irises are no darker than sclera
static const double ROUND_LEAST = 0.3;      // limbus_flank_around: less is no limbus
static const double LITTLE = 0.37;         // of the limbus seen, where it is not exact
static const double OFF = 0.2;             // limbus_pupil_off: more is none in the middle
static const double SIDES_CLEAR = 0.9;      // the same: of a limbus that must be

/* Value of a settled ellipse: its score, weighted by size, because both sides of a pupil are clear too; with a hint, by the
 * agreement of its radius. */
static double settle(struct seek_found *f, const struct photo *photo, const double *hint)
{
	double before = f->score;
	if (!limbus_flank_settle(f, photo))
		return 0;
	double value = before * f->score * pow(f->e.a, 0.25);
	return hint ? value * exp(-0.5 * pow(log(f->e.a / hint[2]) / FLANK_HINT, 2)) : value;
}

static void sort(int n, struct seek_found pool[], double value[])
{
	for (int i = 1; i < n; i++)
		for (int j = i; j > 0 && value[j] > value[j - 1]; j--) {
			struct seek_found f = pool[j];
			double v = value[j];
			pool[j] = pool[j - 1];
			value[j] = value[j - 1];
			pool[j - 1] = f;
			value[j - 1] = v;
		}
}

static int around(struct seek_found out[FLANK_ROUND], const struct ellipse *e, const struct photo *photo, double gap)
{
	struct seek_found round[FLANK_ROUND];
	int n = 0;
	for (int i = 0, m = limbus_flank_around(round, photo, e, gap); i < m; i++)
		if (round[i].score > ROUND_LEAST && limbus_flank_settle(&round[i], photo))
			out[n++] = round[i];
	return n;
}

/* Settled circles of limbus_flanks, best first; those far behind the best are left out. Then what lies round dark discs
 * among them: pupils have clearer sides than pale irises. */
static int gather_flanks(struct seek_found pool[SEEK_MAX + 2 * ROUND_TRY * FLANK_ROUND], int *rounds, const struct photo *photo,
                         const struct pyramid *pyramid, const double *hint, const struct limbus_conf *conf)
{
	const double longer = fmax(photo->width, photo->height), shorter = fmin(photo->width, photo->height);
	double lo = fmax(conf->seek.min_radius, FLANK_LEAST) * longer, value[SEEK_MAX];
	int n = limbus_flanks(pool, photo, hint, lo, conf->seek.max_radius * shorter);
	*rounds = 0;
	n = n < FLANK_TRY ? n : FLANK_TRY;
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < n; i++)
		value[i] = settle(&pool[i], photo, hint);
	sort(n, pool, value);
	while (n > 0 && value[n - 1] < FLANK_BEHIND * value[0])
		n--;
	for (int i = 0; i < n && i < ROUND_TRY && !hint; i++) {
		if (!limbus_is_dark(&pool[i].e, &pyramid->bright[0]))
			continue;
		for (int k = 0; k < 2; k++)
			*rounds += around(pool + n + *rounds, &pool[i].e, photo, k ? RING_GAP : FLANK_GAP);
	}
	return n;
}

bool limbus_agrees(const struct ellipse *e, const struct ellipse *settled)
{
	return hypot(e->cx - settled->cx, e->cy - settled->cy) < FLANK_NEAR * settled->a
	       && fabs(e->a / settled->a - 1) < FLANK_SIZE;
}

static struct limbus_conf loosened(const struct limbus_conf *conf)
{
	struct limbus_conf loose = *conf;
	loose.rim.settled = true;
	loose.max_rms = conf->max_flank_rms;
	loose.max_sigma = conf->max_flank_sigma;
	loose.min_coverage = conf->min_flank_coverage;
	return loose;
}

bool limbus_measure_centred(struct rim *rim, const struct ellipse *start, const struct photo *photo,
                            const struct pyramid *pyramid, const struct limbus_conf *conf)
{
	const struct limbus_conf loose = loosened(conf);
	struct rim *again = mem_new(1, sizeof *again);
	bool ok = false;
	for (int k = 0; k < 2 && !ok; k++)
		ok = rim_fit(again, photo, k ? 0 : &pyramid->tint, start, &loose.rim) && limbus_agrees(&again->e, start)
		     && !limbus_judge(again, photo, pyramid, &loose)
		     && limbus_pupil_off(&again->e, photo, pyramid, conf) < LIMBUS_CENTRED;
	if (ok)
		*rim = *again;
	free(again);
	return ok;
}

/* True for a pupil (a larger circle round it has clear sides), an ellipse without white beside it, or one whose pupil lies far
 * from its middle. */
static bool is_doubtful(const struct rim *rim, bool strict, const struct photo *photo, const struct pyramid *pyramid,
                        const struct limbus_conf *conf)
{
	double off = limbus_pupil_off(&rim->e, photo, pyramid, conf);
	if (strict && !(off < LIMBUS_CENTRED))
		return true;
	if (limbus_sure(rim, off, photo, pyramid))
		return false;
	return off > OFF || rim->coverage < LITTLE || limbus_has_sides_around(&rim->e, photo, SIDES_CLEAR)
	       || limbus_flank_cooler(photo, &rim->e) > FLANK_COOLER;
}

static bool is_like(const struct ellipse *e, const struct ellipse *pupil)
{
	return e->a < 1.3 * pupil->a && hypot(e->cx - pupil->cx, e->cy - pupil->cy) < 0.5 * pupil->a;
}

/* Real sclera is shaded and coloured, and lids touch its rim: the edge scatters more than a clean step does, hence the looser
 * limits. */
bool limbus_measure_flanks(struct limbus_found *found, struct ellipse around, const struct photo *photo,
                           const struct pyramid *pyramid, const double *hint, const struct limbus_conf *conf)
{
	struct seek_found pool[SEEK_MAX + 2 * ROUND_TRY * FLANK_ROUND];
	struct ellipse pupil = { 0 };  // one that was measured: it is looked at once
	const struct limbus_conf loose = loosened(conf);
	struct rim *rim = mem_new(1, sizeof *rim);
	int rounds, n = gather_flanks(pool, &rounds, photo, pyramid, hint, conf);
	for (int i = 0; i < n + rounds && !found->ok && !limbus_is_cut(&pool[0].e, photo); i++) {
		bool strict = i >= n || limbus_within(&pool[i].e, &around);  // its pupil must be in it
		if (pool[i].score < (i < n ? FLANK_SUPPORT : ROUND_SUPPORT) || (strict && hint) || is_like(&pool[i].e, &pupil))
			continue;
		around = pool[i].e.a > around.a ? pool[i].e : around;
		for (int k = 0; k < 2 && !found->ok; k++) {
			if (!rim_fit(rim, photo, k ? 0 : &pyramid->tint, &pool[i].e, &loose.rim) || !limbus_agrees(&rim->e, &pool[i].e))
				continue;
			const char *against = limbus_judge(rim, photo, pyramid, &loose);
			if (against == LIMBUS_PUPIL)
				pupil = rim->e;
			if (against || (!hint && is_doubtful(rim, strict, photo, pyramid, conf)))
				continue;
			found->limbus = *rim;
			found->score = pool[i].score;
			found->ok = true;
		}
	}
	free(rim);
	return found->ok;
}
