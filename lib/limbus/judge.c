#include "limbus/judge.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "limbus/propose/flank.h"
#include "math/stats.h"

const char LIMBUS_COVERED[] = "too much of the limbus is covered by lids or lashes: open the eye wider";
const char LIMBUS_UNCLEAR[] = "no clear ellipse: the eye is closed, hidden, or not there; open the eye wide and photograph it straight";
const char LIMBUS_PUPIL[] = "only the pupil stands out, no limbus round it: show the whole iris, evenly lit";

enum { SAMPLES = 48 };
static const double WHITER = 1.45; // farther out than an edge's outside: that edge is a pupil's
static const double FULL = 0.8, DARK = 0.15;  // share of an edge seen, encoded brightness inside: a pupil's
static const double SIDES_SEEN = 0.55;        // limbus_flank_around: of a limbus that may be
/* Edge scatter, share of the semi-axis. On 240 rendered eyes true ellipses scatter less than this or have a pupil less than 0.1
 * off their middle; wrong ones scatter more and have no pupil nearer than 0.17. */
static const double EXACT = 0.0045;
static const double STEEP = 0.62;       // semi-axes of an eye turned by 52 degrees
static const double LITTLE = 0.37, HALF = 0.5;  // of the limbus seen: less of it can be exact and wrong

/* Separates pupil from limbus: a pupil is surrounded by the iris, and farther out it gets whiter. */
static bool is_pupil(const struct rim *rim, const struct grey *white)
{
	enum { RINGS = 6 };
	static const double ring[RINGS] = { 1.6, 2, 2.5, 3, 3.7, 4.5 };
	double near[ARCS], far[RINGS * ARCS];
	int n = 0, m = 0;
	for (int i = 0; i < ARCS; i++) {
		const double dx = rim->p[i][0] - rim->e.cx, dy = rim->p[i][1] - rim->e.cy;
		if (rim->used[i])
			near[n++] = grey_at(white, rim->e.cx + 1.12 * dx, rim->e.cy + 1.12 * dy);
		for (int k = 0; k < RINGS; k++)
			far[m++] = grey_at(white, rim->e.cx + ring[k] * dx, rim->e.cy + ring[k] * dy);
	}
	return stats_quantile(m, far, 0.93) > WHITER * stats_median(n, near);
}

bool limbus_is_dark(const struct ellipse *e, const struct grey *bright)
{
	double in[SAMPLES];
	for (int i = 0; i < SAMPLES; i++) {
		double p[2], normal[2];
		ellipse_point(p, normal, e, 2 * M_PI * i / SAMPLES);
		in[i] = grey_at(bright, e->cx + 0.8 * (p[0] - e->cx), e->cy + 0.8 * (p[1] - e->cy));
	}
	return stats_median(SAMPLES, in) <= DARK;
}

bool limbus_has_sides_around(const struct ellipse *e, const struct photo *photo, double least)
{
	struct seek_found round[FLANK_ROUND];
	return limbus_flank_around(round, photo, e, FLANK_GAP) > 0 && round[0].score > least;
}

static bool is_dark_disc(const struct rim *rim, const struct photo *photo, const struct grey *bright, double sides)
{
	return limbus_is_dark(&rim->e, bright) && limbus_has_sides_around(&rim->e, photo, sides);
}

bool limbus_within(const struct ellipse *e, const struct ellipse *around)
{
	return e->a < 0.8 * around->a && hypot(e->cx - around->cx, e->cy - around->cy) < around->b;
}

/* Most of what lies outside the edge is burnt out: a bright iris round its pupil then passes for sclera, and a ramp
 * cut off by the sensor is no measure of the limbus. */
static bool is_burnt(const struct rim *rim, const struct grey *white)
{
	int burnt = 0, n = 0;
	for (int i = 0; i < ARCS; i++)
		if (rim->used[i]) {
			const double dx = rim->p[i][0] - rim->e.cx, dy = rim->p[i][1] - rim->e.cy;
			burnt += grey_at(white, rim->e.cx + 1.12 * dx, rim->e.cy + 1.12 * dy) > 0.96;
			n++;
		}
	return burnt > 0.8 * n;
}

bool limbus_is_cut(const struct ellipse *e, const struct photo *photo)
{
	const double c = cos(e->angle), s = sin(e->angle), slack = 0.01 * e->a;
	double hx = hypot(e->a * c, e->b * s), hy = hypot(e->a * s, e->b * c);
	return e->cx - hx < -slack || e->cy - hy < -slack || e->cx + hx > photo->width + slack || e->cy + hy > photo->height + slack;
}

const char *limbus_judge(const struct rim *rim, const struct photo *photo, const struct pyramid *pyramid,
                         const struct limbus_conf *conf)
{
	const struct ellipse *e = &rim->e;
	if (limbus_is_cut(e, photo))
		return "the iris is cut by the frame: show all of it with some white around";
	if (rim->contrast < conf->min_contrast)
		return "no clear edge between iris and sclera: light the eye evenly and focus on the iris";
	if (rim->width > conf->max_blur * e->a)
		return "too blurred: focus on the iris and hold the camera still";
	if (rim->rms > conf->max_rms * e->a + LIMBUS_PIXEL_RMS)
		return LIMBUS_UNCLEAR;
	if (is_burnt(rim, &pyramid->level[0]))
		return "over-exposed round the iris: the white of the eye is burnt out; use less light or a shorter exposure";
	if ((!conf->rim.settled && is_pupil(rim, &pyramid->level[0]))
	    || (rim->coverage > FULL && is_dark_disc(rim, photo, &pyramid->bright[0], conf->rim.settled ? 0 : SIDES_SEEN)))
		return LIMBUS_PUPIL;
	double sigma[ELLIPSE_N], worst = 0;
	ellipse_sigma(sigma, e, rim->cov_q);
	for (int i = 0; i < 4; i++)
		worst = fmax(worst, sigma[i]);
	if (rim->coverage < conf->min_coverage || worst > conf->max_sigma * e->a)
		return LIMBUS_COVERED;
	return 0;
}

double limbus_pupil_off(const struct ellipse *e, const struct photo *photo, const struct pyramid *pyramid,
                        const struct limbus_conf *conf)
{
	struct rim *pupil = mem_new(1, sizeof *pupil);
	double off = NAN;
	if (limbus_pupil(pupil, photo, pyramid, e, &conf->rim, &conf->pupil))
		off = hypot(pupil->e.cx - e->cx, pupil->e.cy - e->cy) / e->a;
	free(pupil);
	return off;
}

bool limbus_sure(const struct rim *rim, double pupil_off, const struct photo *photo, const struct pyramid *pyramid)
{
	if (rim->e.b < STEEP * rim->e.a)
		return false;
	if (pupil_off < LIMBUS_CENTRED && (rim->coverage > LITTLE || rim->rms < EXACT * rim->e.a))
		return true;
	return rim->rms < EXACT * rim->e.a && (isnan(pupil_off) || rim->coverage > HALF)
	       && !is_dark_disc(rim, photo, &pyramid->bright[0], SIDES_SEEN);
}
