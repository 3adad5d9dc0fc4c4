#include "limbus/posterior.h"

#include <math.h>

static const double LEAST_SIGMA = 1e-6;  // semi-axes

double trial_apart(const struct ellipse *e, const struct ellipse *f)
{
	return fmax(hypot(e->cx - f->cx, e->cy - f->cy), fmax(fabs(e->a - f->a), fabs(e->b - f->b)));
}

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
	const double away = trial_apart(e, f) / e->a;
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
	const struct trial_line line = trial_line_of(rim);
	if (!same(&rim->e, &line, &t->trial[p->best].e, &t->trial[p->best].line, t->trial[p->best].sigma, t->conf))
		p->gross = fmax(p->gross, t->conf->same.moved);
}
