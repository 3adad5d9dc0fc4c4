#include "limbus/face/face.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/face/alike.h"
#include "limbus/posterior.h"
#include "limbus/refuse.h"

/* Whether two places are those of one face's eyes: of like size, beside each other at the distance that eyes have. */
static bool plausible(const double a[3], const double b[3], const struct face_conf *conf)
{
	const double dx = b[0] - a[0], dy = b[1] - a[1], apart = hypot(dx, dy) / a[2];
	return apart > conf->distance[0] && apart < conf->distance[1] && atan2(fabs(dy), fabs(dx)) < conf->roll && fabs(log(b[2] / a[2])) < conf->region_alike;
}

/* The region of the other eye, -1: there is none. */
static int other_of(const struct trials *t, const struct ellipse *e, const struct face_conf *conf)
{
	int best = -1;
	const double first[3] = { e->cx, e->cy, e->a };
	for (int i = 0; i < t->n_regions; i++) {
		const struct evidence_region *r = &t->region[i];
		if (r->score >= conf->score && plausible(first, (const double[3]){ r->x, r->y, r->radius }, conf) && (best < 0 || r->score > t->region[best].score))
			best = i;
	}
	return best;
}

/* Whether two more regions, both for sure, are the eyes of another face. */
static bool another_face(const struct trials *t, const struct ellipse *e, int other, const struct face_conf *conf)
{
	const struct evidence_region *more[2];
	int n = 0;
	for (int i = 0; i < t->n_regions && n < 2; i++) {
		const struct evidence_region *r = &t->region[i];
		if (i != other && r->score >= conf->sure && hypot(r->x - e->cx, r->y - e->cy) > e->a)
			more[n++] = r;
	}
	return n == 2 && plausible((const double[3]){ more[0]->x, more[0]->y, more[0]->radius }, (const double[3]){ more[1]->x, more[1]->y, more[1]->radius }, conf);
}

/* Ellipses at the other eye: the evidence's; where that leaves a doubt, those of the first eye's size, and of votes. */
static bool try_other(struct limbus_found *found, struct trials *t, const struct evidence_region *r, double size, struct err *err)
{
	if (!trials_of_place(t, r->x, r->y, r->radius, err))
		return false;
	posterior_of(&found->posterior, t);
	if (found->posterior.gross > t->conf->sure_gross) {
		if (!trials_of_hint(t, (const double[3]){ r->x, r->y, size }, err))
			return false;
		posterior_of(&found->posterior, t);
	}
	return true;
}

/* Leaves of the first eye's trials those that are not the other's. */
static void keep_apart(struct trials *t, const struct ellipse *e, const struct evidence_region *other)
{
	int n = 0;
	for (int i = 0; i < t->n; i++) {
		const struct ellipse *f = &t->trial[i].e;
		if (hypot(f->cx - e->cx, f->cy - e->cy) < hypot(f->cx - other->x, f->cy - other->y))
			t->trial[n++] = t->trial[i];
	}
	t->n = n;
}

/* Settles an eye among its trials, whose odds count the other eye. alone: the chance of its being off without that. */
static void settle(struct limbus_found *found, struct trials *t, double alone)
{
	posterior_of(&found->posterior, t);
	limbus_settle(found, t);
	if (!found->ok && alone <= t->conf->max_gross && found->posterior.gross > t->conf->max_gross)
		limbus_refuse(found, "its size contradicts the other eye's: light both eyes evenly and open them wide");
	if (limbus_usable(found))
		band_sample(&found->band, t->pyramid, &found->limbus);
}

/* Both eyes from the trials at each. True: the photograph shows both. */
static bool both(struct limbus_found found[2], struct trials *first, const struct evidence_region *r)
{
	const struct limbus_conf *conf = first->conf;
	struct trials *second = trials_new(first->photo, first->pyramid, conf);
	struct err err = { 0 };
	struct limbus_found *pair = mem_new(2, sizeof *pair);
	const struct ellipse e = found[0].limbus.e;
	bool is = try_other(&pair[1], second, r, e.a, &err) && second->n > 0;
	if (is) {
		double alone[2] = { found[0].posterior.gross, pair[1].posterior.gross };
		keep_apart(first, &e, r);
		face_alike_odds(first, second, &conf->face);
		settle(&pair[0], first, alone[0]);
		settle(&pair[1], second, alone[1]);
		is = limbus_usable(&pair[1]) || r->score >= conf->face.sure;
	}
	if (is) {
		face_alike_sizes(pair, &conf->face);
		limbus_find_pupil(&pair[0], first);
		limbus_find_pupil(&pair[1], second);
		face_alike_pupils(pair, first->photo, conf);
		memcpy(found, pair, 2 * sizeof *found);
	}
	trials_free(second);
	free(pair);
	return is;
}

static void swap_sides(struct limbus_found found[2])
{
	struct limbus_found *kept = mem_new(1, sizeof *kept);
	*kept = found[0];
	found[0] = found[1];
	found[1] = *kept;
	free(kept);
}

int limbus_find_face(struct limbus_found found[2], const struct photo *photo, bool mirrored, const struct limbus_conf *conf)
{
	if (limbus_too_small(&found[0], photo))
		return 1;
	struct pyramid pyramid = pyramid_make(photo);
	struct trials *trials = trials_new(photo, &pyramid, conf);
	limbus_find_in(&found[0], trials, 0);
	const struct ellipse e = found[0].limbus.e;
	const int other = e.a > 0 ? other_of(trials, &e, &conf->face) : -1;
	const bool pair = other >= 0 && both(found, trials, &trials->region[other]);
	if (!pair)
		limbus_find_pupil(&found[0], trials);
	if (pair) {
		if ((trials->region[other].x > e.cx) != mirrored)
			swap_sides(found);
		for (int i = 0; i < 2 && another_face(trials, &e, other, &conf->face); i++)
			limbus_refuse(&found[i], "more than one face is in it: photograph one person");
	}
	trials_free(trials);
	pyramid_free(&pyramid);
	return pair ? 2 : 1;
}
