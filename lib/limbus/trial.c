#include "limbus/trial.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "limbus/find.h"

struct trials *trials_new(const struct photo *photo, const struct pyramid *pyramid, const struct limbus_conf *conf)
{
	struct trials *t = mem_new(1, sizeof *t);
	t->photo = photo;
	t->pyramid = pyramid;
	t->conf = conf;
	return t;
}

void trials_free(struct trials *t)
{
	for (int i = 0; t && i < t->n_windows; i++) {
		evidence_free(&t->window[i].evidence);
		region_map_free(&t->window[i].map);
		grey_free(&t->window[i].sclera);
		grey_free(&t->window[i].seen);
		free(t->window[i].strip);
	}
	free(t);
}

/* The window round a place, an earlier one where it fits; null where there is no room for more. */
static struct trial_window *window(struct trials *t, double x, double y, double radius, struct err *err)
{
	const struct trial_conf *conf = &t->conf->trial;
	for (int i = 0; i < t->n_windows; i++) {
		struct trial_window *w = &t->window[i];
		if (hypot(w->x - x, w->y - y) < conf->window_place * w->radius && fabs(log(w->radius / radius)) < conf->window_size)
			return w;
	}
	if (t->n_windows == TRIAL_WINDOWS)
		return 0;
	struct trial_window *w = &t->window[t->n_windows];
	if (!evidence_window(&w->evidence, t->conf->net, t->photo, x, y, radius, err))
		return 0;
	t->n_windows++;
	w->x = x;
	w->y = y;
	w->radius = radius;
	w->map = region_map_make(&w->evidence);
	w->sclera = region_sclera(&w->evidence);
	return w;
}

/* The evidence's ellipse as a prior: known less well where no sclera is seen beside it. */
static void region_prior(struct ellipse_prior *known, const struct ellipse *region, const struct trial_window *w, const struct limbus_conf *conf)
{
	const double wider = (1 + conf->region_hidden * (1 - region_shown(region, &w->evidence))) * region->a;
	ellipse_to_q(known->q, region);
	known->alike = conf->trial.prior_arcs;
	for (int i = 0; i < ELLIPSE_N; i++)
		known->sigma[i] = (i < 3 ? conf->region_sigma : conf->region_shape_sigma) * wider;
}

/* A strip read round an ellipse, and the likeliest ellipse that follows. */
struct reading { struct strip *strip; struct ellipse e; struct ellipse_fit fit; bool seen; double worth; };

static bool read_round(struct reading *r, const struct ellipse *start, enum strip_way way, const struct trial_window *w, const struct trials *t, struct err *err)
{
	struct ellipse_prior region;
	r->e = *start;
	if (!strip_read(r->strip, t->conf->strip, t->photo, &w->evidence, start, way, &t->conf->strip_conf, err))
		return false;
	region_prior(&region, start, w, t->conf);
	r->seen = strip_fit(&r->e, &r->fit, r->strip, &w->map, region.sigma);
	r->worth = r->seen ? strip_worth(r->strip, &r->e) : -1;
	return true;
}

/* Reads the strip round the likeliest of n starts, then round the ellipse that follows, and again. */
static bool read_strip(struct trial_window *w, const struct trials *t, int n, const struct ellipse start[n], struct err *err)
{
	struct reading best = { .strip = mem_new(1, sizeof *best.strip) }, other = { .strip = mem_new(1, sizeof *other.strip) };
	bool ok = read_round(&best, &start[0], n == 1 ? STRIP_MIRRORED : STRIP_ONCE, w, t, err);
	for (int i = 1; i < n && ok; i++) {
		ok = read_round(&other, &start[i], STRIP_ONCE, w, t, err);
		if (ok && other.worth > best.worth) {
			const struct reading was = best;
			best = other;
			other = was;
		}
	}
	const int reads = t->conf->trial.reads;
	for (int k = 1; k < reads && ok && best.seen; k++) {
		const struct ellipse from = best.e;
		ok = read_round(&best, &from, k + 1 == reads ? STRIP_MIRRORED : STRIP_ONCE, w, t, err);
		w->moved = ellipse_apart(&best.e, &from);
	}
	if (ok && best.seen) {
		ok = read_round(&other, &best.e, STRIP_BLIND, w, t, err);
		w->blind = other.seen ? ellipse_apart(&other.e, &best.e) : best.e.a;
	}
	free(other.strip);
	w->strip = best.strip;
	if (!ok || !best.seen)
		return ok;
	ellipse_to_q(w->told.q, &best.e);
	for (int i = 0; i < ELLIPSE_N; i++)
		w->told.sigma[i] = hypot(sqrt(best.fit.cov_q[i][i]), (i < 3 ? 1 : 0.4) * t->conf->strip_sigma * best.e.a);
	w->seen = strip_seen(best.strip);
	return true;
}

bool trial_measure(struct rim *rim, struct rim *pupil, bool *has_pupil, const struct trial *trial, const struct trials *t, bool coarse)
{
	struct rim_conf conf = t->conf->rim;
	struct ellipse_prior known;
	const bool by_strip = trial->guide == GUIDE_STRIP || trial->guide == GUIDE_STRIP_FIRST;
	if (by_strip) {
		known = trial->window->told;
		if (!coarse)  // refined from what the odds are of, not begun anew
			ellipse_to_q(known.q, &trial->e);
		known.alike = trial->guide == GUIDE_STRIP ? t->conf->trial.prior_arcs : t->conf->trial.strip_arcs;
	} else if (trial->guide != GUIDE_WHITENESS_ALONE) {
		region_prior(&known, &trial->region, trial->window, t->conf);
	}
	conf.known = trial->guide == GUIDE_WHITENESS_ALONE ? 0 : &known;
	conf.absolute = trial->guide == GUIDE_EVIDENCE || by_strip;
	if (coarse) {
		conf.max_axis = t->conf->trial.limbus_px;
		conf.passes = t->conf->trial.passes;
		conf.straying *= conf.coarse_straying;
	}
	const struct grey *tint = trial->guide == GUIDE_EVIDENCE ? &trial->window->sclera : by_strip ? &trial->window->seen : &t->pyramid->tint;
	if (!rim_fit(rim, t->photo, tint, &trial->e, &conf))
		return false;
	if (!pupil)
		return true;
	conf.known = 0;
	conf.absolute = false;
	conf.max_axis = t->conf->trial.pupil_px;
	*has_pupil = limbus_pupil(pupil, t->photo, t->pyramid, &rim->e, &conf, &t->conf->pupil);
	return true;
}

/* Whether a vote's ellipse was measured already. */
static bool known_already(const struct trials *t, const struct ellipse *e)
{
	const double alike = t->conf->trial.start_alike;
	for (int i = 0; i < t->n; i++) {
		const struct ellipse *f = &t->trial[i].e;
		if (hypot(f->cx - e->cx, f->cy - e->cy) < alike * f->a && fabs(log(e->a / f->a)) < alike && fabs(log(e->b / f->b)) < alike)
			return true;
	}
	return false;
}

struct trial_line trial_line_of(const struct rim *rim)
{
	struct trial_line line = { 0 };
	for (int i = 0; i < ARCS; i += ARCS / TRIAL_PLACES) {
		double normal[2];
		if (rim->used[i])
			ellipse_point(line.p[line.n++], normal, &rim->e, rim->t[i]);
	}
	return line;
}

/* A trial on its way: measured, looked at beside what is known of its window, and kept. The first two run side by side with those of others. */
struct attempt { struct trial trial; struct rim rim[2]; bool measured, has_pupil; };

static void measure(struct attempt *a, const struct trials *t)
{
	a->measured = trial_measure(a->rim, a->rim + 1, &a->has_pupil, &a->trial, t, true);
}

static void look(struct attempt *a, const struct trials *t)
{
	struct trial *trial = &a->trial;
	const struct trial_window *w = trial->window;
	const struct odds_view view = { &w->evidence, &w->map, w->strip, &w->told, w->moved, w->blind,
		                        trial->guide == GUIDE_STRIP ? 1 : trial->guide == GUIDE_STRIP_FIRST ? 2 : 0, trial->guide == GUIDE_WHITENESS_ALONE,
		                        t->photo->width, t->photo->height };
	if (!a->measured)
		return;
	odds_traits(trial->x, a->rim, a->has_pupil ? a->rim + 1 : 0, &view);
	trial->e = a->rim->e;
	trial->line = trial_line_of(a->rim);
	trial->sigma = odds_sigma(a->rim);
}

/* Keeps a trial, where there was something to measure. */
static bool keep(struct trials *t, const struct attempt *a, struct err *err)
{
	if (t->n == TRIALS || !a->measured)
		return true;
	struct trial *trial = &t->trial[t->n];
	*trial = a->trial;
	if (trial->guide == GUIDE_STRIP_FIRST && t->n && t->trial[t->n - 1].guide == GUIDE_STRIP)
		trial->x[ODDS_STRIP_APART] = t->trial[t->n - 1].x[ODDS_STRIP_APART];
	const bool ok = odds_of(trial->curve, trial->x, t->conf->odds, err);
	trial->log_odds = ok ? odds_log(trial->curve, t->conf->tolerance) : 0;
	t->n++;
	return ok;
}

/* The evidence's ellipse near one that is told; that itself where nothing there looks like an iris. */
static void of_region(struct ellipse *e, const struct ellipse *told, const struct trial_window *w, const struct trial_conf *conf)
{
	region_fit(e, &w->map);
	if (!(e->a > conf->least_region * told->a))
		*e = *told;
}

/* The ellipse of the evidence, by either guide; then that of the strip, where it is seen, as a prior that edges move easily, or hardly. */
static bool try_window(struct trials *t, struct trial_window *w, const struct ellipse *e, const struct ellipse *told, struct err *err)
{
	static const enum trial_guide guides[] = { GUIDE_EVIDENCE, GUIDE_WHITENESS, GUIDE_STRIP, GUIDE_STRIP_FIRST };
	enum { FIRST = 2, ALL = COUNT(guides) };
	struct attempt *a = mem_new(ALL, sizeof *a);
	struct ellipse likeliest;
	bool ok = true;
	for (int i = 0; i < FIRST; i++)
		a[i].trial = (struct trial){ .guide = guides[i], .window = w, .region = *e, .e = *e };
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = -1; i < FIRST; i++)
		if (i >= 0)
			measure(&a[i], t);
		else if (!w->strip)
			ok = read_strip(w, t, 2, (struct ellipse[]){ *e, *told }, err);
	const int n = ok && w->seen.px && ellipse_from_q(&likeliest, w->told.q) ? ALL : FIRST;
	for (int i = FIRST; i < n; i++)
		a[i].trial = (struct trial){ .guide = guides[i], .window = w, .region = *e, .e = likeliest };
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = n - 1; i >= 0; i--) {  // the first ones are measured already
		if (i >= FIRST)
			measure(&a[i], t);
		if (ok)
			look(&a[i], t);
	}
	for (int i = 0; i < n && ok; i++)
		ok = keep(t, &a[i], err);
	free(a);
	return ok;
}

/* From a window of its own size. */
bool trials_of_place(struct trials *t, double x, double y, double radius, struct err *err)
{
	const struct trial_conf *conf = &t->conf->trial;
	struct trial_window *w = window(t, x, y, radius, err);
	const struct ellipse told = { x, y, radius, radius, 0 };
	struct ellipse e = told;
	if (!w)
		return !*err->msg;
	of_region(&e, &told, w, conf);
	if (fabs(log(e.a / w->radius)) > conf->window_again || hypot(e.cx - w->x, e.cy - w->y) > conf->window_again * w->radius) {
		w = window(t, e.cx, e.cy, e.a, err);
		if (!w)
			return !*err->msg;
		of_region(&e, &told, w, conf);
	}
	for (int i = 0; i < t->n; i++)
		if (t->trial[i].window == w && t->trial[i].guide == GUIDE_EVIDENCE)
			return true;
	return try_window(t, w, &e, &told, err);
}

bool trials_of_evidence(struct trials *t, struct err *err)
{
	const struct evidence_region *region = t->region;
	if (!evidence_find(t->region, &t->n_regions, t->conf->net, t->photo, err))
		return false;
	const int n = t->n_regions;
	for (int i = 0; i < n && i < t->conf->trial.regions; i++)
		if (!trials_of_place(t, region[i].x, region[i].y, region[i].radius, err))
			return false;
	return true;
}

bool trials_of_scales(struct trials *t, struct err *err)
{
	const struct evidence_region *r = t->region;
	for (int i = 0; i < COUNT(t->conf->trial.other_scale) && t->n_regions > 0; i++)
		if (!trials_of_place(t, r->x, r->y, t->conf->trial.other_scale[i] * r->radius, err))
			return false;
	return true;
}

static bool of_vote(struct trials *t, const struct ellipse *e, struct err *err)
{
	if (known_already(t, e))
		return true;
	struct trial_window *w = window(t, e->cx, e->cy, e->a, err);
	if (!w)
		return !*err->msg;
	struct attempt *a = mem_new(1, sizeof *a);
	bool ok = true;
	a->trial = (struct trial){ .guide = GUIDE_WHITENESS_ALONE, .window = w, .e = *e };
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < 2; i++)
		if (i)
			measure(a, t);
		else if (!w->strip)
			ok = read_strip(w, t, 1, e, err);
	if (ok) {
		look(a, t);
		ok = keep(t, a, err);
	}
	free(a);
	return ok;
}

bool trials_of_votes(struct trials *t, struct err *err)
{
	struct seek_found seen[SEEK_MAX], outer[SEEK_MAX];
	bool has_outer[SEEK_MAX] = { 0 };
	const int found = limbus_seek(seen, t->pyramid, 0, &t->conf->seek), n = found < t->conf->trial.votes ? found : t->conf->trial.votes;
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < (n < t->conf->trial.rounds ? n : t->conf->trial.rounds); i++)
		has_outer[i] = limbus_seek_outer(&outer[i], t->pyramid, &seen[i].e, &t->conf->seek);
	for (int i = 0; i < n; i++)
		if (!of_vote(t, &seen[i].e, err) || (has_outer[i] && !of_vote(t, &outer[i].e, err)))
			return false;
	return true;
}

bool trials_of_hint(struct trials *t, const double *hint, struct err *err)
{
	struct seek_found seen[SEEK_MAX];
	if (!trials_of_place(t, hint[0], hint[1], hint[2], err))
		return false;
	const int n = limbus_seek(seen, t->pyramid, hint, &t->conf->seek);
	for (int i = 0; i < n && i < t->conf->trial.votes; i++)
		if (!of_vote(t, &seen[i].e, err))
			return false;
	return true;
}
