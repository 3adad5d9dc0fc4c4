#include "limbus/posterior.h"

#include <math.h>

static const double OTHER_EYE = 1;      // semi-axes between centres: no rival, but the other eye
static const double MOVED = 0.5;        // chance of being off where the full measurement left its trial

double trial_apart(const struct ellipse *e, const struct ellipse *from)
{
	return fmax(hypot(e->cx - from->cx, e->cy - from->cy), fmax(fabs(e->a - from->a), fabs(e->b - from->b))) / from->a;
}

static bool is_rival(const struct ellipse *e, const struct ellipse *best)
{
	return hypot(e->cx - best->cx, e->cy - best->cy) < OTHER_EYE * fmax(e->a, best->a);
}

/* Chances of the trials given that one of the rivals or none is right: those that say the same as a likelier one get 0. */
static void chances(double chance[TRIALS], const struct trials *t, int best)
{
	double sum = 1;
	for (int i = 0; i < t->n; i++) {
		const struct trial *a = &t->trial[i];
		bool counts = i == best || is_rival(&a->e, &t->trial[best].e);
		for (int k = 0; k < t->n && counts; k++) {
			const struct trial *b = &t->trial[k];
			const bool likelier = b->log_odds > a->log_odds || (b->log_odds == a->log_odds && k < i);
			counts = k == i || !likelier || trial_apart(&a->e, &b->e) > LIMBUS_RIGHT;
		}
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
	p->gross = 1 - chance[p->best];
	p->rival_chance = p->rival < 0 ? 0 : chance[p->rival];
	if (p->rival >= 0)
		p->other = t->trial[p->rival].e;
}

void posterior_settle(struct posterior *p, struct rim *rim, const struct trials *t)
{
	double chance[TRIALS], q[ELLIPSE_N], other[ELLIPSE_N];
	chances(chance, t, p->best);
	ellipse_to_q(q, &rim->e);
	for (int i = 0; i < t->n; i++) {
		if (i == p->best || !(chance[i] > 0))
			continue;
		ellipse_to_q(other, &t->trial[i].e);
		for (int a = 0; a < ELLIPSE_N; a++)
			for (int b = 0; b < ELLIPSE_N; b++)
				rim->cov_q[a][b] += chance[i] * (other[a] - q[a]) * (other[b] - q[b]);
	}
	if (trial_apart(&rim->e, &t->trial[p->best].e) > LIMBUS_RIGHT)
		p->gross = fmax(p->gross, MOVED);
}
