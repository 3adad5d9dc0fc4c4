#include "limbus/pupil.h"

#include <math.h>

#include "base/mem.h"
#include "limbus/propose/score.h"
#include "limbus/propose/seek.h"
#include "limbus/region.h"
#include "math/stats.h"

enum { RADII = 16, GRID = 2, SAMPLES = 24, DISC_RINGS = 12, DISC_ANGLES = 48, ALIKE_ARCS = 12, CLOSER = 96 };
static const float HIDDEN = 0.85F, FLOOR = 0.02F;  // as of region.c
static const double DOUBT = 0.5;

static double ring_median(const struct grey *g, const struct ellipse *e, double scale, double quantile)
{
	double v[SAMPLES];
	struct ellipse f = *e;
	f.a *= scale;
	f.b *= scale;
	for (int i = 0; i < SAMPLES; i++) {
		double p[2], n[2];
		ellipse_point(p, n, &f, 2 * M_PI * (i + 0.5) / SAMPLES);
		v[i] = grey_at(g, p[0], p[1]);
	}
	return stats_quantile(SAMPLES, v, quantile);
}

/* Edge score, less where the inside is not one dark level from the middle to the margin (collarette, dark ring). 0 where it is no more than `top`. */
static double pupil_score(const struct grey *g, const struct ellipse *e, double contrast, double top)
{
	double edge = score_ellipse_above(g, e, contrast, SCORE_WIDE, top);
	if (!(edge > top))
		return 0;
	double core = ring_median(g, e, 0.4, 0.5), rim = ring_median(g, e, 0.85, 0.6), out = ring_median(g, e, 1.15, 0.5);
	if (!(out > core))
		return 0;
	double even = 1 - fmax(rim - core, 0) / (out - core);
	return edge * fmax(even, 0);
}

/* The best circle, or copy of the limbus' shape, on a grid of centres and radii. */
static double search(struct ellipse *best, const struct pyramid *pyramid, const struct ellipse *limbus, const struct pupil_conf *conf)
{
	const double least = conf->first[0], most = conf->first[1];
	double top = 0;
	for (int i = 0; i < RADII; i++) {
		const double k = least * pow(most / least, (double)i / (RADII - 1)), reach = 0.07 * limbus->b;
		const struct grey *g = &pyramid->bright[pyramid_index(pyramid, k * limbus->a, 40)];
		for (int x = -GRID; x <= GRID; x++)
			for (int y = -GRID; y <= GRID; y++) {
				struct ellipse e = { limbus->cx + x * reach, limbus->cy + y * reach, k * limbus->a, k * limbus->b,
				                     limbus->angle };
				double score = pupil_score(g, &e, conf->first_contrast, top);
				if (score > top) {
					top = score;
					*best = e;
				}
			}
	}
	return top;
}

static bool is_clear(const struct rim *pupil, double share, const struct pupil_conf *conf)
{
	return pupil->coverage > share * conf->clear_coverage && pupil->share_used > share * conf->clear_used;
}

static bool believed(const struct rim *pupil, const struct ellipse *limbus, const struct pupil_conf *conf)
{
	const double off = hypot(pupil->e.cx - limbus->cx, pupil->e.cy - limbus->cy);
	return off + pupil->e.a < limbus->a && pupil->e.a < conf->largest * limbus->a && pupil->contrast > conf->min_contrast && pupil->coverage > conf->min_coverage;
}

bool limbus_pupil(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid,
                  const struct ellipse *limbus, const struct rim_conf *rim_conf, const struct pupil_conf *conf)
{
	struct ellipse e;
	if (search(&e, pyramid, limbus, conf) < conf->first_score)
		return false;
	score_climb(&pyramid->bright[pyramid_index(pyramid, e.a, 60)], &e, 0.08 * e.a, 0.01 * e.a, conf->first_contrast, SCORE_WIDE);
	struct rim_conf grey = *rim_conf;
	grey.grey = true;
	grey.search = fmax(grey.search, 6 / e.a);
	return rim_fit(pupil, photo, 0, &e, &grey) && believed(pupil, limbus, conf);
}

/* Whether a mirrored lamp lies round it, brighter than the iris is anywhere farther out. */
static bool mirrors(const struct rim *pupil, const struct pyramid *pyramid, const struct ellipse *limbus, const struct pupil_conf *conf)
{
	static const double shares[] = { 0.65, 0.75, 0.85 };
	const struct grey *g = &pyramid->bright[pyramid_index(pyramid, pupil->e.a, 60)];
	double iris = 0;
	for (int i = 0; i < COUNT(shares); i++)
		iris = fmax(iris, ring_median(g, limbus, shares[i], 0.5));
	return ring_median(g, &pupil->e, 1.15, 0.5) > conf->brightest * iris;
}

/* Of every pixel, whether it is the pupil rather than what is round it; lids and what is mirrored may lie over either. */
static struct region_map map_of(const struct evidence *e)
{
	struct region_map m = { e->width, e->height, e->x0, e->y0, e->scale, 0 };
	m.sum = mem_array((size_t)(m.width + 1) * (size_t)m.height, sizeof *m.sum);
	for (int y = 0; y < m.height; y++) {
		float *row = m.sum + (long)y * (m.width + 1);
		row[0] = 0;
		for (int x = 0; x < m.width; x++) {
			const long i = (long)y * m.width + x;
			const float over = e->plane[EVIDENCE_REFLECTION][i] + e->plane[EVIDENCE_SKIN][i] + e->plane[EVIDENCE_LASH][i];
			const float out = e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_SCLERA][i] + over;
			row[x + 1] = row[x] + logf((e->plane[EVIDENCE_PUPIL][i] + HIDDEN * over + FLOOR) / (out + FLOOR));
		}
	}
	return m;
}

/* Mean chance of pupil in an ellipse, and where its middle lies. */
static double mean_in(double middle[2], const struct evidence *evidence, const struct ellipse *e)
{
	double mass = 0, x = 0, y = 0, in = 0;
	for (int k = 0; k < DISC_RINGS; k++)
		for (int i = 0; i < DISC_ANGLES; i++) {
			double p[2], n[2];
			struct ellipse f = *e;
			const double share = (k + 0.5) / DISC_RINGS;
			f.a *= share;
			f.b *= share;
			ellipse_point(p, n, &f, 2 * M_PI * i / DISC_ANGLES);
			const double w = share * evidence_at(evidence, EVIDENCE_PUPIL, p[0], p[1]);
			mass += w;
			x += w * p[0];
			y += w * p[1];
			in += share;
		}
	middle[0] = x / mass;
	middle[1] = y / mass;
	return mass / in;
}

/* The pupil by the evidence of its pixels: its ellipse, and their mean in it. 0: there is none in the limbus. */
static double told_by(struct ellipse *e, const struct evidence *evidence, const struct ellipse *limbus, const struct pupil_conf *conf)
{
	double middle[2];
	const double size = sqrt(mean_in(middle, evidence, limbus));
	if (!(size > conf->first[0]))
		return 0;
	*e = (struct ellipse){ middle[0], middle[1], size * limbus->a, size * limbus->b, limbus->angle };
	struct region_map map = map_of(evidence);
	region_fit(e, &map);
	region_map_free(&map);
	return mean_in(middle, evidence, e);
}

/* Measures the margin near an ellipse that is known before to `sigma` px. */
static bool measure_near(struct rim *pupil, const struct photo *photo, const struct ellipse *e, double sigma, const struct rim_conf *rim_conf, const struct pupil_conf *conf)
{
	struct rim_conf grey = *rim_conf;
	struct ellipse_prior known = { .alike = ALIKE_ARCS };
	ellipse_to_q(known.q, e);
	for (int i = 0; i < ELLIPSE_N; i++)
		known.sigma[i] = sigma;
	grey.grey = true;
	grey.known = &known;
	grey.least_window = conf->least_window;
	return rim_fit(pupil, photo, 0, e, &grey);
}

static bool agree(const struct ellipse *e, const struct ellipse *f, double within)
{
	return hypot(e->cx - f->cx, e->cy - f->cy) < within && fabs(e->a - f->a) < within;
}

bool limbus_pupil_like(struct rim *pupil, const struct photo *photo, const struct ellipse *limbus, double size, double sigma,
                       const struct rim_conf *rim_conf, const struct pupil_conf *conf)
{
	struct ellipse e = *limbus;
	struct pupil_conf less = *conf;
	e.a *= size;
	e.b *= size;
	less.min_contrast *= conf->other_eye;
	less.min_coverage *= conf->other_eye;
	return measure_near(pupil, photo, &e, sigma * e.a, rim_conf, conf) && believed(pupil, limbus, &less) && is_clear(pupil, conf->other_eye, conf)
	       && agree(&pupil->e, &e, conf->other_far * sigma * e.a);
}

/* What the iris' own network says, in the form of the pixels' evidence. evidence_free. */
static struct evidence closer_of(const struct occlusion *o, const struct ellipse *limbus)
{
	const enum evidence_class of[OCCLUSION_CLASSES] = { [OCCLUSION_IRIS] = EVIDENCE_IRIS, [OCCLUSION_PUPIL] = EVIDENCE_PUPIL,
		[OCCLUSION_MIRROR] = EVIDENCE_REFLECTION, [OCCLUSION_LID] = EVIDENCE_SKIN };
	const double reach = OCCLUSION_REACH * limbus->a;
	struct evidence e = { .width = CLOSER, .height = CLOSER, .x0 = limbus->cx - reach, .y0 = limbus->cy - reach, .scale = 2 * reach / CLOSER };
	e.plane[0] = mem_new((size_t)EVIDENCE_CLASSES * CLOSER * CLOSER, sizeof **e.plane);
	for (int c = 1; c < EVIDENCE_CLASSES; c++)
		e.plane[c] = e.plane[0] + (long)c * CLOSER * CLOSER;
	for (int i = 0; i < CLOSER * CLOSER; i++)
		for (int c = 0; c < OCCLUSION_CLASSES; c++)
			e.plane[of[c]][i] = occlusion_at(o, c, e.x0 + (i % CLOSER + 0.5) * e.scale, e.y0 + (i / CLOSER + 0.5) * e.scale);
	return e;
}

/* An edge may be another than the pupil's where the network has it a little aside: half of how far they are apart adds to its sigma. Counts too much where the
 * network is off, which a pupil's own wandering about the axis (pose.h) hides. */
static void doubt(struct rim *pupil, const struct ellipse *told)
{
	double q[ELLIPSE_N], p[ELLIPSE_N];
	ellipse_to_q(q, &pupil->e);
	ellipse_to_q(p, told);
	const double centre = hypot(q[0] - p[0], q[1] - p[1]);
	for (int i = 0; i < ELLIPSE_N; i++)
		pupil->cov_q[i][i] += pow(DOUBT * (i < 2 ? centre : p[i] - q[i]), 2);
}

/* By edge and networks. */
static bool told(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *limbus,
                 const struct evidence *evidence, const struct evidence *closer, const struct rim_conf *rim_conf, const struct pupil_conf *conf)
{
	struct ellipse e = { 0 }, f = { 0 };
	if (!(told_by(&e, closer, limbus, conf) >= conf->told_sure))
		return false;
	const double within = conf->told_within * limbus->a, sigma = conf->told_sigma[0] * limbus->a + conf->told_sigma[1] * e.a;
	bool is = limbus_pupil(pupil, photo, pyramid, limbus, rim_conf, conf) && agree(&pupil->e, &e, within);
	if (!is)
		is = told_by(&f, evidence, limbus, conf) > 0 && agree(&e, &f, conf->told_apart * limbus->a) && measure_near(pupil, photo, &e, sigma, rim_conf, conf)
		     && believed(pupil, limbus, conf) && pupil->share_used > conf->told_used && agree(&pupil->e, &e, within);
	if (is)
		doubt(pupil, &e);
	return is;
}

bool limbus_pupil_told(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *limbus, const struct evidence *evidence,
                       const struct occlusion *occlusion, const struct rim_conf *rim_conf, const struct pupil_conf *conf)
{
	struct evidence closer = closer_of(occlusion, limbus);
	const bool is = told(pupil, photo, pyramid, limbus, evidence, &closer, rim_conf, conf) && !mirrors(pupil, pyramid, limbus, conf);
	evidence_free(&closer);
	return is;
}
