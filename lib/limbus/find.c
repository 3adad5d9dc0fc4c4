#include "limbus/find.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "limbus/hand.h"
#include "limbus/opening.h"
#include "limbus/posterior.h"
#include "limbus/refuse.h"
#include "math/stats.h"

enum { MIN_SIDE = 96 };

/* Encoded brightness that a tenth of the photograph exceeds. */
static double bright_level(const struct grey *g)
{
	enum { PLACES = 1024 };
	const long n = (long)g->width * g->height;
	double v[PLACES];
	int count = 0;
	for (long i = 0; i < PLACES && i < n; i++)
		v[count++] = g->px[i * n / (n < PLACES ? n : PLACES)];
	return stats_quantile(count, v, 0.9);
}

static bool exposed(struct limbus_found *found, const struct pyramid *pyramid, const struct limbus_conf *conf)
{
	double level = bright_level(&pyramid->bright[pyramid->n - 1]);
	if (pyramid->over > conf->max_over)
		return limbus_refuse(found, "over-exposed: %.0f %% of it is burnt out; use less light or a shorter exposure", 100 * pyramid->over);
	if (level < conf->min_level)
		return limbus_refuse(found, "under-exposed: nine tenths of it are darker than %.0f %%; use more light or a longer exposure", 100 * level);
	return true;
}

/* Weighs what the network finds; where that leaves a doubt, what it finds at other scales and what the votes of edges find as well. */
static bool search(struct limbus_found *found, struct trials *trials, struct err *err)
{
	const struct limbus_conf *conf = trials->conf;
	if (!trials_of_evidence(trials, err))
		return false;
	posterior_of(&found->posterior, trials);
	if (found->posterior.gross > conf->sure_gross) {
		if (!trials_of_scales(trials, err) || !trials_of_votes(trials, err))
			return false;
		posterior_of(&found->posterior, trials);
	}
	return true;
}

static bool hinted(struct limbus_found *found, struct trials *trials, const double *hint, struct err *err)
{
	if (!trials_of_hint(trials, hint, err))
		return false;
	posterior_of(&found->posterior, trials);
	return true;
}

/* What an answer counts beside others that say the same: by the error that its odds expect, so steeply that a poor one hardly does. */
static double count_of(const struct trial *trial)
{
	static const double LEAST = 2.5e-4;  // semi-axes: no error is told to be less
	return pow(fmax(odds_one_sigma(trial->curve), LEAST), -4);
}

/* Measures the likeliest trial in full: rim[0]; and, side by side, all that say the same: rim[i + 1] of trial i where measured[i]. */
static bool measure_all(struct rim rim[1 + TRIALS], bool measured[TRIALS], struct limbus_found *found, const struct trial *best, const struct trials *trials)
{
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = -1; i < trials->n; i++) {
		const struct trial *t = i < 0 ? best : &trials->trial[i];
		const bool same = t != best && t->window == best->window && ellipse_apart(&t->e, &best->e) < trials->conf->same.most * best->e.a;
		if (i < 0)
			found->ok = trial_measure(rim, 0, 0, best, trials, false);
		else
			measured[i] = same && trial_measure(&rim[i + 1], 0, 0, t, trials, false);
	}
	return found->ok;
}

/* Edges err where the limbus is soft or shaded, the strip on eyes unlike those it has learnt from, and which of a window's trials is the likeliest may
 * turn with a few pixels: the answer lies between all that say the same. How far they are apart adds to its covariance. */
static void between(struct rim *rim, const struct rim other[TRIALS], const bool measured[TRIALS], const struct trial *best, const struct trials *trials)
{
	enum { N = ELLIPSE_N };
	double q[N], p[N], sum = count_of(best);
	ellipse_to_q(q, &rim->e);
	for (int i = 0; i < trials->n; i++) {
		if (!measured[i])
			continue;
		const double count = count_of(&trials->trial[i]), share = count / (sum + count);
		sum += count;
		ellipse_to_q(p, &other[i].e);
		for (int a = 0; a < N; a++)
			for (int b = 0; b < N; b++)
				rim->cov_q[a][b] += share * (other[i].cov_q[a][b] - rim->cov_q[a][b]) + share * (1 - share) * (p[a] - q[a]) * (p[b] - q[b]);
		for (int a = 0; a < N; a++)
			q[a] += share * (p[a] - q[a]);
	}
	ellipse_from_q(&rim->e, q);
}

void limbus_settle(struct limbus_found *found, struct trials *trials)
{
	const struct posterior *p = &found->posterior;
	if (p->best < 0) {
		limbus_refuse(found, "no eye found: photograph one open eye close up, or say where it is with photo.NAME.hint_px");
		return;
	}
	const struct trial *trial = &trials->trial[p->best];
	struct rim *rim = mem_new(1 + TRIALS, sizeof *rim);
	bool measured[TRIALS];
	const bool any = measure_all(rim, measured, found, trial, trials);
	found->limbus = rim[0];
	if (any)
		between(&found->limbus, rim + 1, measured, trial, trials);
	free(rim);
	if (!any) {
		limbus_refuse(found, "no clear edge between iris and sclera: light the eye evenly and focus on the iris");
		return;
	}
	posterior_settle(&found->posterior, &found->limbus, trials);
	limbus_refuse_doubtful(found, trials);
}

void limbus_find_in(struct limbus_found *found, struct trials *trials, const double *hint)
{
	struct err err = { 0 };
	const struct photo *photo = trials->photo;
	const struct pyramid *pyramid = trials->pyramid;
	const struct limbus_conf *conf = trials->conf;
	const struct ellipse meant = hint ? (struct ellipse){ hint[0], hint[1], hint[2], hint[2], 0 } : (struct ellipse){ 0 };
	*found = (struct limbus_found){ .posterior = { .best = -1, .rival = -1, .gross = 1 } };
	if (exposed(found, pyramid, conf)) {
		if (hint ? hinted(found, trials, hint, &err) : search(found, trials, &err))
			limbus_settle(found, trials);
		else
			limbus_refuse(found, "%s", err.msg);
	}
	if (hint && !(found->ok && limbus_hand_near(&found->limbus.e, &meant)))
		limbus_by_hand(found, photo, pyramid, &meant, conf->hint_sigma, conf);
	if (limbus_usable(found))
		band_sample(&found->band, pyramid, &found->limbus);
}

/* The evidence in whose window an ellipse was tried; null: it was not. */
static const struct evidence *evidence_of(const struct ellipse *e, const struct trials *trials)
{
	static const double near = 0.1;  // semi-axes: the window suits it
	const struct evidence *evidence = 0;
	double least = near * e->a;
	for (int i = 0; i < trials->n; i++) {
		const double apart = ellipse_apart(&trials->trial[i].e, e);
		if (apart < least) {
			least = apart;
			evidence = &trials->trial[i].window->evidence;
		}
	}
	return evidence;
}

void limbus_find_pupil(struct limbus_found *found, const struct trials *trials)
{
	const struct limbus_conf *conf = trials->conf;
	const struct ellipse *e = &found->limbus.e;
	const struct evidence *evidence = evidence_of(e, trials);
	struct occlusion *occlusion = mem_new(1, sizeof *occlusion);
	struct evidence own = { 0 };
	struct err err = { 0 };
	found->has_pupil = false;
	if (limbus_usable(found) && (evidence || evidence_window(&own, conf->net, trials->photo, e->cx, e->cy, e->a, &err))) {
		evidence = evidence ? evidence : &own;
		opening_reach(found->reach, evidence, e, trials->photo->width);
		found->has_pupil = occlusion_read(occlusion, conf->occlusion, trials->photo, evidence, e, &err)
		                   && limbus_pupil_told(&found->pupil, trials->photo, trials->pyramid, e, evidence, occlusion, &conf->rim, &conf->pupil);
	}
	evidence_free(&own);
	free(occlusion);
}

bool limbus_too_small(struct limbus_found *found, const struct photo *photo)
{
	*found = (struct limbus_found){ .posterior = { .best = -1, .rival = -1, .gross = 1 } };
	const bool small = photo->width < MIN_SIDE || photo->height < MIN_SIDE;
	if (small)
		limbus_refuse(found, "%d x %d px is too small: the iris must be at least 80 px across", photo->width, photo->height);
	return small;
}

void limbus_find(struct limbus_found *found, const struct photo *photo, const double *hint, const struct limbus_conf *conf)
{
	if (limbus_too_small(found, photo))
		return;
	struct pyramid pyramid = pyramid_make(photo);
	struct trials *trials = trials_new(photo, &pyramid, conf);
	limbus_find_in(found, trials, hint);
	limbus_find_pupil(found, trials);
	trials_free(trials);
	pyramid_free(&pyramid);
}

void limbus_find_drawn(struct limbus_found *found, const struct photo *photo, const struct ellipse *drawn, const struct limbus_conf *conf)
{
	*found = (struct limbus_found){ .posterior = { .best = -1, .rival = -1 } };
	struct pyramid pyramid = pyramid_make(photo);
	limbus_by_hand(found, photo, &pyramid, drawn, conf->drawn_sigma, conf);
	band_sample(&found->band, &pyramid, &found->limbus);
	struct trials *none = trials_new(photo, &pyramid, conf);
	limbus_find_pupil(found, none);
	trials_free(none);
	pyramid_free(&pyramid);
}
