#include "limbus/posterior.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static const double LEAST_SIGMA = 1e-6;  // semi-axes

static bool follows(const struct ellipse *e, const struct trial_line *line, double within)
{
	for (int i = 0; i < line->n; i++) {
		double t;
		if (fabs(ellipse_distance(&t, e, line->p[i])) > within * e->a)
			return false;
	}
	return true;
}

/* Answers so many sigmas apart say the same, at least those within the tolerance. */
static bool same(const struct ellipse *e, const struct trial_line *line, const struct ellipse *f, const struct trial_line *other, double sigma,
                 const struct limbus_conf *conf)
{
	const double within = fmax(conf->tolerance, fmin(conf->same.sigmas * sigma, conf->same.most));
	const double away = ellipse_apart(e, f) / e->a;
	return away < within || (away < conf->same.unseen && line->n + other->n > 0 && follows(e, other, within) && follows(f, line, within));
}

bool trial_repeats(const struct trials *t, int i)
{
	const struct trial *a = &t->trial[i];
	for (int k = 0; k < t->n; k++) {
		const struct trial *b = &t->trial[k];
		const bool likelier = b->log_odds > a->log_odds || (b->log_odds == a->log_odds && k < i);
		if (k != i && likelier && same(&a->e, &a->line, &b->e, &b->line, fmax(a->sigma, b->sigma), t->conf))
			return true;
	}
	return false;
}

static bool is_rival(const struct ellipse *e, const struct ellipse *best, const struct limbus_conf *conf)
{
	return hypot(e->cx - best->cx, e->cy - best->cy) < conf->same.other_eye * fmax(e->a, best->a);
}

/* Chances of the trials given that one of the rivals or none is right: those that say the same as a likelier one get 0. */
static void chances(double chance[TRIALS], const struct trials *t, int best)
{
	double sum = 1;
	for (int i = 0; i < t->n; i++) {
		const struct trial *a = &t->trial[i];
		const bool counts = (i == best || is_rival(&a->e, &t->trial[best].e, t->conf)) && !trial_repeats(t, i);
		chance[i] = counts ? exp(a->log_odds) : 0;
		sum += chance[i];
	}
	for (int i = 0; i < t->n; i++)
		chance[i] /= sum;
}

void posterior_of(struct posterior *p, const struct trials *t)
{
	*p = (struct posterior){ .best = -1, .rival = -1, .gross = 1 };
	for (int i = 0; i < t->n; i++)
		if (p->best < 0 || t->trial[i].log_odds > t->trial[p->best].log_odds)
			p->best = i;
	if (p->best < 0)
		return;
	double chance[TRIALS];
	chances(chance, t, p->best);
	for (int i = 0; i < t->n; i++)
		if (i != p->best && chance[i] > 0 && (p->rival < 0 || chance[i] > chance[p->rival]))
			p->rival = i;
	if (t->conf->tolerance > LIMBUS_RIGHT)
		p->beyond_right = 1 / (1 + exp(odds_log(t->trial[p->best].curve, LIMBUS_RIGHT)));
	p->rival_chance = p->rival < 0 ? 0 : chance[p->rival];
	// a trial's odds are those among photographs that have rivals, too: none of them is right, or the rival is, whichever is likelier
	p->gross = fmax(1 / (1 + exp(t->trial[p->best].log_odds)), p->rival_chance / (p->rival_chance + chance[p->best]));
	if (p->rival >= 0)
		p->other = t->trial[p->rival].e;
}

/* Whether the full measurement is another ellipse than its trial. */
static bool moved(const struct rim *rim, const struct trial *trial, const struct limbus_conf *conf)
{
	const struct trial_line line = trial_line_of(rim);
	return !same(&rim->e, &line, &trial->e, &trial->line, trial->sigma, conf);
}

void posterior_settle(struct posterior *p, struct rim *rim, const struct trials *t)
{
	double chance[TRIALS], q[ELLIPSE_N], other[ELLIPSE_N];
	chances(chance, t, p->best);
	ellipse_to_q(q, &rim->e);
	// The odds are of the rough measure. The full one's own sigma is less, but it knows no more of what lids hide or where the limbus is ragged.
	const double wider = odds_wider(fmax(odds_sigma(rim), LEAST_SIGMA), t->trial[p->best].curve);
	for (int a = 0; a < ELLIPSE_N; a++)
		for (int b = 0; b < ELLIPSE_N; b++)
			rim->cov_q[a][b] *= wider * wider;
	for (int i = 0; i < t->n; i++) {
		if (i == p->best || !(chance[i] > 0))
			continue;
		ellipse_to_q(other, &t->trial[i].e);
		for (int a = 0; a < ELLIPSE_N; a++)
			for (int b = 0; b < ELLIPSE_N; b++)
				rim->cov_q[a][b] += chance[i] * (other[a] - q[a]) * (other[b] - q[b]);
	}
	if (moved(rim, &t->trial[p->best], t->conf))
		p->gross = fmax(p->gross, t->conf->same.moved);
}

/* The chance that the answer is off by more than another tolerance: 1 where another of the trials would be the likeliest that lies farther off than that. */
static double gross_at(const struct posterior *p, const struct rim *rim, const struct trials *t, double tolerance)
{
	struct trials *at = mem_new(1, sizeof *at);
	struct limbus_conf conf = *t->conf;
	struct posterior posterior;
	*at = *t;
	at->conf = &conf;
	conf.tolerance = tolerance;
	for (int i = 0; i < at->n; i++) {
		// what the other eye of the face has added to a trial's odds stays
		struct trial *trial = &at->trial[i];
		trial->log_odds += odds_log(trial->curve, tolerance) - odds_log(trial->curve, t->conf->tolerance);
	}
	posterior_of(&posterior, at);
	const struct trial *own = &at->trial[p->best], *best = &at->trial[posterior.best];
	const bool other = ellipse_apart(&best->e, &own->e) > tolerance * own->e.a || moved(rim, own, &conf);
	const double gross = other ? 1 : fmax(posterior.gross, 1 / (1 + exp(own->log_odds)));
	free(at);
	return gross;
}

double posterior_taken_at(const struct posterior *p, const struct rim *rim, const struct trials *t)
{
	for (int i = 0; i < ODDS_CURVE; i++) {
		const double tolerance = odds_tolerance[i];
		if (tolerance > t->conf->tolerance && tolerance <= t->conf->rough_tolerance && gross_at(p, rim, t, tolerance) <= t->conf->rough_gross)
			return tolerance;
	}
	return 0;
}
