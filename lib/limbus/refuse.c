#include "limbus/refuse.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "limbus/posterior.h"

bool limbus_refuse(struct limbus_found *found, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(found->reason, sizeof found->reason, fmt, ap);
	va_end(ap);
	found->rough = 0;
	return found->ok = false;
}

static bool is_cut(const struct ellipse *e, const struct photo *photo)
{
	const double c = cos(e->angle), s = sin(e->angle), slack = 0.01 * e->a;
	double hx = hypot(e->a * c, e->b * s), hy = hypot(e->a * s, e->b * c);
	return e->cx - hx < -slack || e->cy - hy < -slack || e->cx + hx > photo->width + slack || e->cy + hy > photo->height + slack;
}

/* A trait that lowers the odds of a limbus, how a clear photograph of an open eye has it, whether more of it is worse (1) or less (-1), whether it
 * speaks against there being an eye at all, and what to do about it. */
struct fault {
	enum odds_trait trait;
	double usual, worse;
	bool no_eye;
	const char *words;
};

static const char covered[] = "too much of the limbus is covered by lids or lashes: open the eye wider";
static const char no_edge[] = "no clear edge between iris and sclera: light the eye evenly and focus on the iris";
static const char soft[] = "the limbus is soft or in shadow: open the eye wider, light it evenly and focus on the iris";

static const struct fault faults[] = {
	{ ODDS_EYE, 0.9, -1, true, "nothing in it looks like an iris: photograph one open eye close up" },
	{ ODDS_COVERAGE, 0.7, -1, false, covered },
	{ ODDS_STRIP_SEEN, 0.7, -1, false, covered },
	{ ODDS_STRIP_ON, 0.85, -1, false, no_edge },
	{ ODDS_SIGMA, -5.5, 1, false, "too little of the limbus stands out: open the eye wider and light it evenly" },
	{ ODDS_CONTRAST, -0.5, -1, false, no_edge },
	{ ODDS_BLUR, 0.03, 1, false, "too blurred: focus on the iris and hold the camera still" },
	{ ODDS_SCATTER, -5.5, 1, true, "no clear ellipse: the eye is closed, hidden, or not there; open the eye wide and photograph it straight" },
	{ ODDS_SCATTER, -5.5, 1, false, soft },
	{ ODDS_SCLERA_OUTSIDE, 0.8, -1, false, "no white of the eye beside the iris: open the eye wide and light it evenly" },
	{ ODDS_IRIS_OUTSIDE, 0, 1, false, "only the pupil or a part of the iris stands out: show the whole iris, evenly lit" },
	{ ODDS_PUPIL_OFF, 0, 1, false, "the pupil does not lie in the middle of the iris: photograph the eye straight, without strong reflections" },
	{ ODDS_ROUND, -0.05, -1, false, "the eye is turned too far aside: photograph it from nearer to the front" },
	{ ODDS_IRIS_EVEN, -1.5, -1, true, "the iris has no pattern, as painted eyes have none: focus on the iris" },
};

/* The fault without which the odds would be highest; eye: of those that an eye can have. */
static const char *words_of(const struct trial *trial, bool eye, const struct limbus_conf *conf)
{
	const char *words = eye ? soft : faults[0].words;
	double most = 0;
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
		const struct fault *f = &faults[i];
		if ((eye && f->no_eye) || f->worse * (trial->x[f->trait] - f->usual) <= 0)
			continue;
		struct trial mended = *trial;
		mended.x[f->trait] = f->usual;
		struct err unread = { 0 };
		const bool read = odds_of(mended.curve, mended.x, conf->odds, &unread);
		const double cost = read ? odds_log(mended.curve, conf->tolerance) - odds_log(trial->curve, conf->tolerance) : 0;
		if (cost > most) {
			most = cost;
			words = f->words;
		}
	}
	return words;
}

/* To how much of the semi-axis the ellipse is known: the least tolerance beyond which it is off in one case of ten, say; 0: to none. */
static double known_to(const struct trial *trial)
{
	const double rarely = 0.1;
	for (int i = 0; i < ODDS_CURVE; i++)
		if (1 / (1 + exp(trial->curve[i])) < rarely)
			return odds_tolerance[i];
	return 0;
}

void limbus_refuse_doubtful(struct limbus_found *found, const struct trials *trials)
{
	const struct limbus_conf *conf = trials->conf;
	const struct posterior *p = &found->posterior;
	const struct trial *trial = &trials->trial[p->best];
	const double known = known_to(trial);
	const double taken_at = p->gross > conf->max_gross ? posterior_taken_at(p, &found->limbus, trials) : 0;
	if (is_cut(&found->limbus.e, trials->photo))
		limbus_refuse(found, "the iris is cut by the frame: show all of it with some white around");
	else if (taken_at > 0) {
		limbus_refuse(found, "its ellipse may be more than %.2g %% off (chance %.0f %%), hardly more than %.2g %%: %s", 100 * conf->tolerance, 100 * p->gross, 100 * taken_at,
		              words_of(trial, true, conf));
		found->rough = taken_at;
	} else if (p->gross > conf->max_gross && p->rival_chance > 0.5 * p->gross)
		limbus_refuse(found, "two ellipses may be the limbus (chance that the likelier is wrong: %.0f %%): light the eye evenly and show all of the iris", 100 * p->gross);
	else if (p->gross > conf->max_gross && known > conf->tolerance)
		limbus_refuse(found, "its ellipse is known to %.2g %% only, %.2g %% is asked for: %s", 100 * known, 100 * conf->tolerance, words_of(trial, true, conf));
	else if (p->gross > conf->max_gross)
		limbus_refuse(found, "%s", words_of(trial, known > 0, conf));
}
