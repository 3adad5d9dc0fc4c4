#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/eye/eye_track_impl.h"
#include "track/gaze/bundle.h"
#include "motion/gaze_sim.h"

/* Collects the frames that have edges, for gaze_bundle_fit(). */
static int frames_of(struct gaze_frame *out, int *index, const struct eye_side *eye)
{
	int n = 0;
	for (long i = 0; i < eye->frames; i++) {
		const struct eye_record *record = &eye->record[i];
		if (!record->edges || record->still)
			continue;
		eye_view(&out[n].view, eye->scene, record->cam_from_head);
		out[n].fick[0] = eye->state[i].gaze[0];
		out[n].fick[1] = eye->state[i].gaze[1];
		out[n].edge = eye->edge + record->first_edge;
		out[n].n = record->edges;
		index[n++] = (int)i;
	}
	return n;
}

/* Adds the errors that frames share, radians: those of the eyeball, of the head's pose and of the line of sight to the eye. */
static void add_common(struct eye_state *state, const struct eye_side *eye, const struct gaze_frame *frame, const struct gaze_bundle_fit *fit)
{
	const double worst = 0.5;
	double cov[2][2];
	gaze_bundle_common(cov, frame, &eye->globe, fit);
	for (int k = 0; k < 2; k++) {
		double common = isfinite(cov[k][k]) ? fmin(worst, sqrt(fmax(0, cov[k][k]))) : worst;
		const double placed = hypot(eye->place_sigma / gaze_plane(&eye->globe), eye->turn_sigma[k]);
		state->sigma[k] = hypot(hypot(hypot(state->sigma[k], common), placed), hypot(eye->scene->head_sigma[k], eye->view_sigma[k]));
	}
}

static void refit(struct eye_state *state, const struct eye_side *eye, const struct gaze_frame *frame, const struct gaze_bundle_fit *common)
{
	struct gaze_fit fit = { .fick = { frame->fick[0], frame->fick[1] } };
	if (!gaze_fit_edges(&fit, frame->n, frame->edge, &eye->globe, &frame->view, 0.05))
		return;
	struct ellipse e;
	for (int k = 0; k < 2; k++) {
		state->gaze[k] = fit.fick[k];
		state->sigma[k] = sqrt(fit.cov[k][k]);
	}
	add_common(state, eye, frame, common);
	if (gaze_ellipse(&e, &eye->globe, &frame->view, fit.fick)) {
		double v[5] = { e.cx, e.cy, e.a, e.b, e.angle };
		memcpy(state->limbus, v, sizeof v);
	}
}

/* Shifts torsion so that its median difference from Listing's law is zero: the first frame's was assumed. Of fewer frames than tell a median it is
 * forgotten. */
static void level_torsion(struct eye_side *eye)
{
	enum { LEAST = 12 };
	double *off = mem_array((size_t)eye->frames + 1, sizeof *off), degree = M_PI / 180;
	int n = 0;
	for (long i = 0; i < eye->frames; i++) {
		const double *g = eye->state[i].gaze;
		if (isfinite(g[2]))
			off[n++] = g[2] - degree * listing_torsion(g[0] / degree, g[1] / degree);
	}
	double middle = n ? stats_median(n, off) : 0;
	for (long i = 0; i < eye->frames; i++)
		eye->state[i].gaze[2] = n < LEAST ? NAN : eye->state[i].gaze[2] - middle;
	free(off);
}

static struct gaze_bundle_conf bundle_of(const struct eye_side *eye)
{
	return (struct gaze_bundle_conf){ eye->center_guess, eye->radius_sigma, eye->conf->limbus_sigma, eye->average ? eye->conf->edge_sigma : 0, eye->average ? eye->conf->edge_px : 0 };
}

bool eye_side_radius(double *radius, double *sigma, const struct eye_side *eye)
{
	struct gaze_frame *frame = bulk_grow(eye->scene->bulk, 0, (size_t)eye->frames + 1, sizeof *frame);
	int *index = mem_array((size_t)eye->frames + 1, sizeof *index), n = frames_of(frame, index, eye);
	const struct gaze_bundle_conf conf = bundle_of(eye);
	struct gaze_bundle_fit fit;
	struct gaze_globe best = eye->first_globe;
	bool ok = gaze_bundle_fit(&best, &fit, n, frame, &conf);
	const double information = ok ? 1 / fit.cov[3][3] - 1 / (conf.radius_sigma * conf.radius_sigma) : 0;
	bulk_free(eye->scene->bulk, frame);
	free(index);
	if (!(information > 0))
		return false;
	*radius = (best.radius / fit.cov[3][3] - eye->first_globe.radius / (conf.radius_sigma * conf.radius_sigma)) / information;
	*sigma = 1 / sqrt(information);
	return true;
}

void eye_side_settle(struct eye_side *eye)
{
	struct gaze_frame *frame = bulk_grow(eye->scene->bulk, 0, (size_t)eye->frames + 1, sizeof *frame);
	int *index = mem_array((size_t)eye->frames + 1, sizeof *index), n = frames_of(frame, index, eye);
	const struct gaze_bundle_conf conf = bundle_of(eye);
	struct gaze_bundle_fit fit;
	struct gaze_globe best = eye->first_globe;
	if (gaze_bundle_fit(&best, &fit, n, frame, &conf)) {
		eye->globe = best;
		eye->rms = fit.rms;
	} else {
		const double prior[GAZE_GLOBE] = { conf.center_sigma, conf.center_sigma, conf.center_sigma, conf.radius_sigma, conf.limbus_sigma };
		fit = (struct gaze_bundle_fit){ .rms = 0 };
		for (int k = 0; k < GAZE_GLOBE; k++)
			fit.cov[k][k] = prior[k] * prior[k];
	}
	for (int k = 0; k < 3; k++)
		eye->center_sigma[k] = sqrt(fit.cov[k][k]);
	for (int i = 0; i < n; i++)
		refit(&eye->state[index[i]], eye, &frame[i], &fit);
	for (long i = 1; i < eye->frames; i++) {
		double time = eye->state[i].time;
		if (eye->record[i].still) {
			eye->state[i] = eye->state[i - 1];
			eye->state[i].time = time;
		}
	}
	level_torsion(eye);
	eye_settle_lids(eye);
	bulk_free(eye->scene->bulk, frame);
	free(index);
}

void eye_side_globe(struct eye_globe *globe, const struct eye_side *eye)
{
	*globe = (struct eye_globe){ .radius = eye->globe.radius, .limbus_radius = eye->globe.limbus, .rms_px = eye->rms, .told_sigma = eye->center_guess };
	memcpy(globe->center_in_head, eye->globe.center, sizeof globe->center_in_head);
	memcpy(globe->center_sigma, eye->center_sigma, sizeof globe->center_sigma);
	for (long i = 0; i < eye->frames; i++)
		globe->frames += eye->state[i].confidence > 0;
	globe->seen = globe->frames > 0;
}
