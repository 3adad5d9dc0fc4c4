#include "limbus/hand.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { LEAST_PX = 8 };
static const double NEAR = 0.35;       // of the radius, and of the logarithm of the size's ratio

bool limbus_hand_check(const struct ellipse *e, const char *key, int width, int height, struct err *err)
{
	double most = width > height ? width : height;
	if (!(e->cx >= 0 && e->cx <= width && e->cy >= 0 && e->cy <= height))
		return err_set(err, "%s = %g %g ...: must lie in the photograph, %d x %d px", key, e->cx, e->cy, width, height);
	if (!(e->b >= LEAST_PX && e->a <= most))
		return err_set(err, "%s: semi-axes %g and %g px: must be in [%d, %g]", key, e->a, e->b, LEAST_PX, most);
	return e->a >= e->b || err_set(err, "%s: semi-axes %g and %g px: the major one comes first", key, e->a, e->b);
}

static bool within(const struct ellipse *e, const struct ellipse *meant, double share)
{
	return hypot(e->cx - meant->cx, e->cy - meant->cy) < share * meant->a && fabs(log(e->a / meant->a)) < share
	       && fabs(log(e->b / meant->b)) < share;
}

bool limbus_hand_near(const struct ellipse *e, const struct ellipse *meant)
{
	// A hint is a circle: an eye that looks aside is as wide, and lower.
	return hypot(e->cx - meant->cx, e->cy - meant->cy) < NEAR * meant->a && fabs(log(e->a / meant->a)) < NEAR
	       && e->b < meant->b * (1 + NEAR);
}

bool limbus_hand_agree(const struct ellipse *a, const char *key_a, const struct ellipse *b, const char *key_b, bool same_eye, struct err *err)
{
	const double apart = hypot(a->cx - b->cx, a->cy - b->cy);
	if (same_eye)
		return limbus_hand_near(b, a) || err_set(err, "%s with %s: their centres are %.0f px apart, their radii %.0f and %.0f px: both must mean one limbus",
		                                         key_a, key_b, apart, a->a, b->a);
	return apart > fmax(a->a, b->a) || err_set(err, "%s with %s: their centres are %.0f px apart: two eyes stand further apart than an iris's radius",
	                                           key_a, key_b, apart);
}

/* The ellipse as it was meant: no edge was measured. */
static void take_meant(struct rim *rim, const struct ellipse *meant, double sigma)
{
	*rim = (struct rim){ .e = *meant, .width = 0.02 * meant->a, .rms = sigma * meant->a };
	for (int i = 0; i < ELLIPSE_N; i++)
		rim->cov_q[i][i] = pow(sigma * meant->a, 2);
	for (int i = 0; i < ARCS; i++) {
		rim->t[i] = 2 * M_PI * i / ARCS;
		ellipse_point(rim->p[i], rim->normal[i], meant, rim->t[i]);
		rim->widths[i] = rim->width;
	}
}

void limbus_by_hand(struct limbus_found *found, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *meant,
                    double sigma, const struct limbus_conf *conf)
{
	struct rim *rim = mem_new(1, sizeof *rim);
	struct rim_conf close = conf->rim;
	close.search = fmin(close.search, conf->hand.close);
	bool fits = rim_fit(rim, photo, &pyramid->tint, meant, &close) && within(&rim->e, meant, conf->hand.close)
	            && rim->coverage > conf->hand.seen && rim->rms < conf->max_rms * rim->e.a + 1;
	if (fits) {
		double off = fmax(hypot(rim->e.cx - meant->cx, rim->e.cy - meant->cy), fabs(rim->e.a - meant->a)) / 2;
		off = fmin(off, sigma * meant->a);
		for (int i = 0; i < ELLIPSE_N; i++)
			rim->cov_q[i][i] += off * off;
	} else {
		take_meant(rim, meant, sigma);
	}
	found->limbus = *rim;
	found->ok = found->by_hand = true;
	found->rough = 0;
	*found->reason = 0;
	free(rim);
}
