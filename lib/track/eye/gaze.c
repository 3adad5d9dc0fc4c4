#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "track/eye/eye_track_impl.h"
#include "track/gaze/seek.h"
#include "motion/gaze_sim.h"

// Grey levels of the step from iris to sclera, at least.
static const double CONTRAST_LEAST = 10;
// Seconds over which that step is averaged.
static const double CONTRAST_S = 1 / 6.0;
// Score of gaze_seek() below which an eye counts as lost.
static const double LOST = 0.15;

struct seen {
	const struct lid_track *lids;
	double rows;
};

static bool is_seen(const void *ctx, const double px[2])
{
	const struct seen *seen = ctx;
	return lid_track_inside(seen->lids, px, seen->rows);
}

double eye_seek(struct eye_side *eye, const struct luma *luma, const struct gaze_view *view, const struct evidence *evidence, bool anywhere)
{
	double degree = M_PI / 180, fick[2] = { eye->fick[0], eye->fick[1] }, score = NAN;
	struct seen seen = { &eye->lids, 0 };
	struct gaze_sight sight = { luma, &eye->globe, view, eye->contrast, eye->lids.known ? is_seen : NULL, &seen, evidence };
	if (eye->have && !anywhere)
		score = gaze_seek(fick, &sight, 9 * degree, 1.5 * degree, 0.5 * degree);
	if (!(score > EYE_FOUND)) {
		double wide[2] = { 0, 0 };
		double s = gaze_seek(wide, &sight, 36 * degree, 3 * degree, 0.5 * degree);
		if (!(score >= s - 0.1)) {
			score = s;
			fick[0] = wide[0];
			fick[1] = wide[1];
		}
	}
	if (score > LOST) {
		eye->fick[0] = fick[0];
		eye->fick[1] = fick[1];
	}
	return score;
}

/* Gaze from the limbus edges in the opening, in three rounds of ever narrower search. */
static bool measure(struct gaze_fit *fit, struct gaze_edge edge[GAZE_ARCS_MAX], int *n, struct eye_side *eye,
                    const struct luma *luma, const struct gaze_view *view, double limbus_px)
{
	struct seen seen = { &eye->lids, lid_track_rows(&eye->lids, 0.12 * limbus_px) };
	static const double range[3] = { 0.2, 0.1, 0.06 };
	fit->fick[0] = eye->fick[0];
	fit->fick[1] = eye->fick[1];
	for (int k = 0; k < 3; k++) {
		struct gaze_search search = { .arcs = eye->conf->limbus_arcs, .range = fmax(2, range[k] * limbus_px),
			.half = fmax(1.5, 0.06 * limbus_px), .least = 0.2 * eye->contrast, .seen = is_seen, .ctx = &seen };
		*n = gaze_edges(edge, luma, &eye->globe, view, fit->fick, &search);
		if (!gaze_fit_edges(fit, *n, edge, &eye->globe, view, 0.05))
			return false;
	}
	return fit->inliers > 0.11 * eye->conf->limbus_arcs && fit->rms < fmax(1.2, 0.04 * limbus_px);
}

static double clear_height(const struct lid_chart *chart, const struct lid_curves *curves, const double px[2],
                           double *below)
{
	double col, row, high = hypot(chart->dv[0], chart->dv[1]);
	lid_chart_of(&col, &row, chart, px);
	int i = (int)lround(fmin(fmax(col, 0), chart->cols - 1));
	*below = (curves->row[1][i] - row) * high;
	return (row - curves->row[0][i]) * high;
}

static void fill_gaze(struct eye_state *state, struct eye_side *eye, const struct gaze_fit *fit,
                      const struct gaze_view *view)
{
	for (int k = 0; k < 2; k++) {
		eye->fick[k] = state->gaze[k] = fit->fick[k];
		state->sigma[k] = sqrt(fit->cov[k][k]);
	}
	double share = fit->inliers / eye->conf->limbus_arcs, limbus_px = eye->globe.limbus * eye_scale(&eye->globe, view);
	double sharp = exp(-0.5 * pow(fit->rms / fmax(1, 0.03 * limbus_px), 2));
	state->confidence = fmin(1, share / 0.5) * sharp;
	struct ellipse e;
	if (gaze_ellipse(&e, &eye->globe, view, fit->fick)) {
		double v[5] = { e.cx, e.cy, e.a, e.b, e.angle };
		memcpy(state->limbus, v, sizeof v);
	}
}

static void fill_torsion(struct eye_state *state, struct eye_side *eye, const struct luma *luma,
                         const struct gaze_view *view, double limbus_px)
{
	struct seen seen = { &eye->lids, lid_track_rows(&eye->lids, 0.08 * limbus_px) };
	struct torsion_look look = { luma, &eye->globe, view, &eye->scene->eye, { state->gaze[0], state->gaze[1] }, is_seen,
		&seen };
	double degree = M_PI / 180, first = degree * listing_torsion(state->gaze[0] / degree, state->gaze[1] / degree);
	double torsion, sigma;
	if (!gaze_torsion(&torsion, &sigma, &eye->torsion, &look, first))
		return;
	state->gaze[2] = torsion;
	state->sigma[2] = sigma;
}

static void keep_edges(struct eye_side *eye, struct eye_record *record, int n, const struct gaze_edge edge[])
{
	eye_side_room(eye, 0, eye->edges + n);
	record->first_edge = eye->edges;
	record->edges = n;
	memcpy(eye->edge + eye->edges, edge, (size_t)n * sizeof *edge);
	eye->edges += n;
}

/* True when the pupil's centre is visible: a circle extrapolated from the part that a lid leaves is no measurement. */
static bool pupil_seen(const struct eye_side *eye, const struct gaze_view *view, const double fick[2], double limbus_px)
{
	double pupil[2], below, above, in_eye[3] = { 0, 0, gaze_plane(&eye->globe) };
	if (!gaze_pixel(pupil, &eye->globe, view, (double[3]){ fick[0], fick[1], 0 }, in_eye))
		return false;
	above = clear_height(&eye->lids.chart, &eye->lids.margins, pupil, &below);
	return above >= 0.05 * limbus_px && below >= 0.05 * limbus_px;
}

void eye_measure(struct eye_state *state, struct eye_record *record, struct eye_side *eye, const struct luma *luma,
                 const struct gaze_view *view, const struct evidence *evidence)
{
	struct gaze_edge edge[GAZE_ARCS_MAX];
	struct gaze_fit fit;
	double limbus_px = record->mm * eye->globe.limbus, rise = 0;
	int n = 0;
	// A second search, anywhere, with the lids of this frame.
	if (!measure(&fit, edge, &n, eye, luma, view, limbus_px)
	    && (!(eye_seek(eye, luma, view, evidence, true) > EYE_FOUND) || !measure(&fit, edge, &n, eye, luma, view, limbus_px)))
		return;
	if (!pupil_seen(eye, view, fit.fick, limbus_px))
		return;
	for (int i = 0; i < n; i++)
		rise += edge[i].strength / n;
	eye->contrast = fmax(CONTRAST_LEAST, eye->contrast + fmin(1, 1 / (CONTRAST_S * eye->scene->fps)) * (rise - eye->contrast));
	fill_gaze(state, eye, &fit, view);
	keep_edges(eye, record, n, edge);
	fill_torsion(state, eye, luma, view, limbus_px);
}
