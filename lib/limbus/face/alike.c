#include "limbus/face/alike.h"

#include <math.h>
#include <string.h>

#include "limbus/posterior.h"
#include "limbus/refuse.h"

static double normal(double x, double sigma)
{
	return exp(-0.5 * x * x / (sigma * sigma)) / sigma;
}

/* Likelihood ratio of the logarithm of two sizes' ratio: both right, against one or both off. */
static double ratio_of(double x, const struct face_conf *conf)
{
	const double right = (1 - conf->unlike) * normal(x, conf->size_sigma) + conf->unlike * normal(x, conf->broad);
	return right / (conf->off_alike * normal(x, conf->off_sigma * conf->size_sigma) + (1 - conf->off_alike) * normal(x, conf->broad));
}

/* Odds of each trial; 0 of those that say the same as a likelier one. */
static void weights_of(double weight[TRIALS], const struct trials *t)
{
	for (int i = 0; i < t->n; i++)
		weight[i] = trial_repeats(t, i) ? 0 : exp(t->trial[i].log_odds);
}

/* What the other eye's trials say of an ellipse. */
static double told_by(const struct ellipse *e, const struct trials *other, const double weight[TRIALS], const struct face_conf *conf)
{
	double with = 1, without = 1;
	for (int k = 0; k < other->n; k++) {
		with += weight[k] * ratio_of(log(e->a / other->trial[k].e.a), conf);
		without += weight[k];
	}
	return log(with / without);
}

void face_alike_odds(struct trials *one, struct trials *other, const struct face_conf *conf)
{
	struct trials *eye[2] = { one, other };
	double weight[2][TRIALS] = { 0 };
	for (int s = 0; s < 2; s++)
		weights_of(weight[s], eye[s]);
	double more[2][TRIALS] = { 0 };
	for (int s = 0; s < 2; s++)
		for (int i = 0; i < eye[s]->n; i++)
			more[s][i] = told_by(&eye[s]->trial[i].e, eye[1 - s], weight[1 - s], conf);
	for (int s = 0; s < 2; s++)
		for (int i = 0; i < eye[s]->n; i++)
			eye[s]->trial[i].log_odds += more[s][i];
}

void face_alike_sizes(struct limbus_found found[2], const struct face_conf *conf)
{
	const struct ellipse *e = &found[0].limbus.e, *f = &found[1].limbus.e;
	double sigma[2][ELLIPSE_N];
	if (!limbus_usable(&found[0]) || !limbus_usable(&found[1]))
		return;
	ellipse_sigma(sigma[0], e, found[0].limbus.cov_q);
	ellipse_sigma(sigma[1], f, found[1].limbus.cov_q);
	const double x = log(f->a / e->a), spread = hypot(conf->size_sigma, hypot(sigma[0][2] / e->a, sigma[1][2] / f->a));
	const int worse = found[0].posterior.gross > found[1].posterior.gross ? 0 : 1;
	if (fabs(x) > conf->far * spread)
		limbus_refuse(&found[worse], "its limbus is %.0f %% %s than the other eye's: light both eyes evenly and open them wide",
		              100 * fabs(exp(worse ? x : -x) - 1), (worse ? x : -x) > 0 ? "larger" : "smaller");
}

static double size_of(const struct limbus_found *f)
{
	return f->pupil.e.a / f->limbus.e.a;
}

void face_alike_pupils(struct limbus_found found[2], const struct photo *photo, const struct limbus_conf *conf)
{
	const double most = conf->face.far * conf->face.pupil_sigma;
	if (!limbus_usable(&found[0]) || !limbus_usable(&found[1]) || !(found[0].has_pupil || found[1].has_pupil))
		return;
	if (found[0].has_pupil && found[1].has_pupil && fabs(log(size_of(&found[1]) / size_of(&found[0]))) < most)
		return;
	const bool first = found[0].has_pupil && (!found[1].has_pupil || found[0].pupil.coverage * found[0].pupil.contrast >= found[1].pupil.coverage * found[1].pupil.contrast);
	const int known = first ? 0 : 1;
	found[1 - known].has_pupil = limbus_pupil_like(&found[1 - known].pupil, photo, &found[1 - known].limbus.e, size_of(&found[known]),
	                                               conf->face.pupil_sigma, &conf->rim, &conf->pupil);
}
