/* The head's pose at the reference, settled by what the eyes turn about: their centres lie 12 mm behind the lids, so that a head
 * that is thought to be turned wrongly has them in the wrong place beside the lids' outlines. */
#include <math.h>
#include <string.h>

#include "stages/track/track.h"

enum { FEW_POINTS = 120, LEAST_FRAMES = 20, LEAST_MARGIN = 20, ROUNDS = 12 };

static const double margin_weight = 0.05;  // px^-2: margins err together, by what lashes shade

static int centers(struct head_sight sights[SIDES], const struct track_result *r, const struct track_clip *clip, const struct track_subject *s,
                   const struct track_conf *conf)
{
	int n = 0;
	for (int e = 0; e < SIDES; e++) {
		const struct eye_globe *g = &r->eyes.globe[e];
		double p[3];
		if (!g->seen || g->frames < LEAST_FRAMES)
			continue;
		head_from(p, clip->cam_from_head, g->center_in_head);
		double px_per_mm = clip->camera.focal_px / p[2], found = hypot(g->center_sigma[0], g->center_sigma[1]);
		struct head_sight *to = &sights[n];
		*to = (struct head_sight){ .sure = true, .weight = 1 / (px_per_mm * px_per_mm * (conf->center_sigma * conf->center_sigma + found * found)) };
		memcpy(to->head, s->center[e], sizeof to->head);
		n += head_project(to->px, &clip->camera, clip->cam_from_head, g->center_in_head);
	}
	return n;
}

/* The margins found in the reference frame against the mesh's opening under a pose: each control point lies on the outline
 * where that comes nearest. */
static int margins(struct head_sight *sights, const struct track_result *r, const struct track_clip *clip, const struct track_subject *s,
                   int side, const double pose[4][4])
{
	const struct eye_state *state = &r->eyes.state[clip->reference][side];
	const struct eye_opening *o = &s->opening[side];
	double px[OPENING_POINTS][2];
	int n = 0;
	for (int i = 0; i < OPENING_POINTS; i++)
		if (!o->open || !head_project(px[i], &clip->camera, pose, o->edge[i]))
			return 0;
	for (int k = 0; k < LIDS * state->lid_points; k++) {
		const double *p = state->lid[k / state->lid_points][k % state->lid_points];
		double best = INFINITY;
		struct head_sight to = { .line = true, .weight = margin_weight };
		for (int i = 0; i < OPENING_POINTS && isfinite(p[0]); i++) {
			const double *a = px[i], *b = px[(i + 1) % OPENING_POINTS], d[2] = { b[0] - a[0], b[1] - a[1] };
			double length = fmax(hypot(d[0], d[1]), 1e-9), t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (length * length);
			t = fmax(0, fmin(1, t));
			double off = hypot(p[0] - a[0] - t * d[0], p[1] - a[1] - t * d[1]);
			if (off >= best)
				continue;
			best = off;
			to.normal[0] = d[1] / length;
			to.normal[1] = -d[0] / length;
			for (int c = 0; c < 3; c++)
				to.head[c] = (1 - t) * o->edge[i][c] + t * o->edge[(i + 1) % OPENING_POINTS][c];
		}
		memcpy(to.px, p, sizeof to.px);
		if (isfinite(best))
			sights[n++] = to;
	}
	return n;
}

static void refine(struct track_clip *clip, const struct track_result *r, const struct track_subject *s, const struct track_conf *conf)
{
	struct head_sight sights[SIDES * LIDS * LID_POINTS_MAX + SIDES];
	double turn = conf->head.turn_sigma * M_PI / 180, pose[4][4], px = NAN;
	struct head_prior prior = { .sigma = { turn, turn, INFINITY, INFINITY, INFINITY, INFINITY } };
	memcpy(pose, clip->cam_from_head, sizeof pose);
	memcpy(prior.cam_from_head, pose, sizeof pose);
	for (int round = 0; round < ROUNDS; round++) {
		int n = centers(sights, r, clip, s, conf);
		if (!n)
			return;
		for (int e = 0; e < SIDES; e++)
			n += margins(sights + n, r, clip, s, e, pose);
		if (n < LEAST_MARGIN)
			return;
		px = head_pose_fit(pose, n, sights, &clip->camera, fmax(2, 16 - 2 * round), &prior);
		if (isnan(px))
			return;
	}
	memcpy(clip->cam_from_head, pose, sizeof pose);
	clip->pose_px = px;
}

void track_settle(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_conf few = *conf;
	struct track_points points = { 0 };
	struct track_result r = { 0 };
	struct err none = { 0 };
	if (s->assumed || clip->pose_given || !conf->settle)
		return;
	few.points = FEW_POINTS;
	few.limit = conf->settle;
	few.eyes.center_sigma = conf->settle_sigma;
	few.eyes.torsion_rays = 0;
	// what cannot be followed here is said when the whole clip is
	if (track_points_choose(&points, clip, s, &few, &none) && track_follow(&r, stage, clip, s, &points, &few, &none) && clip->reference < r.n)
		refine(clip, &r, s, conf);
	track_result_free(&r);
	track_points_free(&points);
}
