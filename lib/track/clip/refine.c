#include "track/clip/refine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/chol.h"
#include "track/clip/reference.h"
#include "track/clip/trust.h"
#include "track/head/shade_lens.h"

enum { LEAST_FRAMES = 12, LEAST_MARGIN = 20, ROUNDS = 12, REST_ROUNDS = 4, ENDS = 2, LAST_ROBUST = 2 };

static const double margin_weight = 0.05;  // px^-2: errors of margins are correlated (shadows of lashes)
static const double usual_px = 2;          // of a picture 1280 wide, the eyes of usual size: residuals that margins have
static const double earned_aside = 0.5;    // mm: standard deviation, aside and down, of a place that the skin's motion tells
static const double open_enough = 0.8;     // of the usual opening
static const double still_gaze = 0.01, like_v = 0.05;  // radians

/* Each centre found gives two measurements: one along either axis of the head, of its own variance and floor_mm's. */
static int centers(struct head_sight sights[SIDES * 2], double floor_mm, const struct track_result *r, const struct track_clip *clip, const struct track_subject *s,
                   const struct track_conf *conf)
{
	int n = 0;
	for (int e = 0; e < SIDES; e++) {
		const struct eye_globe *g = &r->eyes.globe[e];
		double px[2];
		if (!g->seen || g->frames < LEAST_FRAMES || !head_project(px, &clip->camera, clip->cam_from_head, g->center_in_head))
			continue;
		for (int k = 0; k < 2; k++) {
			double off[3] = { g->center_in_head[0], g->center_in_head[1], g->center_in_head[2] }, there[2];
			off[k] += 1;
			head_project(there, &clip->camera, clip->cam_from_head, off);
			double px_per_mm = hypot(there[0] - px[0], there[1] - px[1]), sigma = px_per_mm * hypot(hypot(s->center_sigma[e] > 0 ? s->center_sigma[e] : conf->center_sigma, g->center_sigma[k]), floor_mm);
			struct head_sight *to = &sights[n++];
			*to = (struct head_sight){ .line = true, .sure = true, .weight = 1 / (sigma * sigma) };
			memcpy(to->head, s->center[e], sizeof to->head);
			memcpy(to->px, px, sizeof px);
			for (int c = 0; c < 2; c++)
				to->normal[c] = (there[c] - px[c]) / px_per_mm;
		}
	}
	return n;
}

/* One control point of a margin (px of the modelling camera) while the eye looks `up` (radians), not aside, and how it moves as that gaze rises. */
struct rest {
	double at[2], slope[2], up;
};

/* Lids follow the eye, by a quarter of a millimetre a degree up and down, and a little sideways: regresses over all frames of open eyes, with robust weights,
 *     place = at + h aside + (v - up) slope,
 * up the reference's vertical gaze (calm 0) or the median one (calm > 0; frames then also weigh by the skin's misfit over calm px). With too few
 * frames `at` is the reference frame's, slope 0. */
static void rest_of(struct rest *out, double calm, const struct track_result *r, const struct track_clip *clip, const struct track_subject *s, int side, int point,
                    const struct track_conf *conf)
{
	const struct eye_state *here = &r->eyes.state[clip->reference / track_every(conf)][side];
	double scale = INFINITY, turn[2][2] = { { 0 } }, up = calm > 0 ? reference_usual_height(r, side) : here->gaze[1], *rest = out->at;
	const int points = conf->eyes.lid_points;  // of a frame without lids NAN
	*out = (struct rest){ .up = up };
	memcpy(rest, here->lid[point / points][point % points], 2 * sizeof *rest);
	for (int round = 0; round < REST_ROUNDS && isfinite(up); round++) {
		double a[3][3] = { { 0 } }, b[2][3] = { { 0 } }, square = 0, weight = 0;
		for (long f = 0; f < r->n; f++) {
			const struct eye_state *state = &r->eyes.state[f][side];
			const double *p = state->lid[point / points][point % points], row[3] = { 1, state->gaze[0], state->gaze[1] - up };
			float at[2];
			double off[2], w = 1;
			if (r->lost_at[f] || state->blink != BLINK_OPEN || !(state->openness > open_enough) || !isfinite(row[1] + p[0]))
				continue;
			track_to_model(at, p, s->opening[side].center, r->pose[f], clip);
			for (int c = 0; c < 2; c++)
				off[c] = round ? (double)at[c] - rest[c] - row[1] * turn[c][0] - row[2] * turn[c][1] : 0;
			// expressions move the lids, too
			double stir = calm > 0 ? r->misfit[f] / calm : 0;
			w = exp(-pow(row[2] / like_v, 2)) / (1 + pow(stir, 4)) * (round ? pow(1 + (off[0] * off[0] + off[1] * off[1]) / (scale * scale), -2) : 1);
			square += w * (off[0] * off[0] + off[1] * off[1]);
			weight += w;
			for (int i = 0; i < 3; i++) {
				for (int j = 0; j < 3; j++)
					a[i][j] += w * row[i] * row[j];
				for (int c = 0; c < 2; c++)
					b[c][i] += w * row[i] * (double)at[c];
			}
		}
		if (!(weight > LEAST_FRAMES / 3))
			return;
		for (int c = 0; c < 2; c++) {
			double m[3][3];
			memcpy(m, a, sizeof m);
			// ridge: a gaze that hardly moves leaves the slopes undetermined
			m[1][1] += weight * still_gaze * still_gaze;
			m[2][2] += weight * still_gaze * still_gaze;
			if (!chol_solve(3, 3, &m[0][0], b[c]))
				return;
			rest[c] = b[c][0];
			turn[c][0] = b[c][1];
			out->slope[c] = turn[c][1] = b[c][2];
		}
		scale = round ? fmax(1, 2 * sqrt(square / weight)) : 8;
	}
}

/* Measurements of margins at rest: each control point lies on the nearest segment of the mesh's opening under the pose (ICP).
 * The ends are left out: margins were corrected there by the very pose that is to be refined. */
static int margins(struct head_sight *sights, int points, const struct rest *rest, double straight, const struct track_clip *clip, const struct track_subject *s, int side,
                   const double pose[4][4])
{
	const struct eye_opening *o = &s->opening[side];
	double px[OPENING_POINTS][2], d[OPENING_POINTS][2], length[OPENING_POINTS];
	int n = 0;
	for (int i = 0; i < OPENING_POINTS; i++)
		if (!o->open || !head_project(px[i], &clip->camera, pose, o->edge[i]))
			return 0;
	for (int i = 0; i < OPENING_POINTS; i++) {
		for (int c = 0; c < 2; c++)
			d[i][c] = px[(i + 1) % OPENING_POINTS][c] - px[i][c];
		length[i] = fmax(hypot(d[i][0], d[i][1]), 1e-9);
	}
	for (int k = 0; k < points; k++) {
		const double rises = isnan(straight) ? 0 : straight - rest[k].up, p[2] = { rest[k].at[0] + rises * rest[k].slope[0], rest[k].at[1] + rises * rest[k].slope[1] };
		int along = k % (points / LIDS);
		if (along < ENDS || along >= points / LIDS - ENDS)
			continue;
		double best = INFINITY;
		struct head_sight to = { .line = true, .weight = margin_weight };
		for (int i = 0; i < OPENING_POINTS && isfinite(p[0]); i++) {
			double u = p[0] - px[i][0], v = p[1] - px[i][1], t = (u * d[i][0] + v * d[i][1]) / (length[i] * length[i]);
			t = t < 0 ? 0 : t > 1 ? 1 : t;
			u -= t * d[i][0];
			v -= t * d[i][1];
			// most are further off by far
			if (u * u + v * v > 1.001 * best * best)
				continue;
			const double off = hypot(u, v);
			if (off >= best)
				continue;
			best = off;
			to.normal[0] = d[i][1] / length[i];
			to.normal[1] = -d[i][0] / length[i];
			for (int c = 0; c < 3; c++)
				to.head[c] = (1 - t) * o->edge[i][c] + t * o->edge[(i + 1) % OPENING_POINTS][c];
		}
		memcpy(to.px, p, sizeof to.px);
		if (isfinite(best))
			sights[n++] = to;
	}
	return n;
}

/* What the reference's pose is refined by. */
struct lids {
	struct rest rest[SIDES][LIDS * LID_POINTS_MAX];
	struct head_prior prior;
	double usual;          // radians: the median height of gaze under the prior's pose
};

/* Margins that lie further off the mesh than usual (an expression; lids found wrongly) are as far off in common: they weigh by how far. px: the residual's rms. */
static void weigh_margins(int n, struct head_sight *sights, double px, const struct track_clip *clip, const struct track_subject *s)
{
	const double usual = usual_px * trust_scale(clip, s), share = px > usual ? pow(usual / px, 2) : 1;
	for (int i = 0; i < n; i++)
		sights[i].weight *= share;
}

/* Lays the mesh on, its lids where they are while the eyes look so high (radians, under the prior's pose; NAN: as they are in lids). pose: start and result. Returns what is
 * minimised (head_pose_cost), INFINITY, pose undefined, where too little is known. px, turned: the residual's rms, sigmas (head_pose_sigma); NAN where not known. */
static double lay(double pose[4][4], double *px, double turned[3], double straight, const struct lids *lids, const struct track_result *r, const struct track_clip *clip,
                  const struct track_subject *s, const struct track_conf *conf)
{
	struct head_sight sights[SIDES * (LIDS * LID_POINTS_MAX + 2)];
	int n = 0;
	memcpy(pose, lids->prior.cam_from_head, sizeof lids->prior.cam_from_head);
	*px = 0;
	for (int round = 0; round < ROUNDS; round++) {
		n = centers(sights, conf->center_floor, r, clip, s, conf);
		if (!n)
			return INFINITY;
		const int first = n;
		for (int e = 0; e < SIDES; e++)
			n += margins(sights + n, LIDS * conf->eyes.lid_points, lids->rest[e], straight, clip, s, e, (const double(*)[4])pose);
		if (n < LEAST_MARGIN)
			return INFINITY;
		if (clip->moves.n_known)
			weigh_margins(n - first, sights + first, *px, clip, s);
		*px = head_pose_fit(pose, n, sights, &clip->camera, fmax(LAST_ROBUST, 16 - 2 * round), &lids->prior);
		if (isnan(*px))
			return INFINITY;
	}
	if (!head_pose_sigma(turned, (const double(*)[4])pose, n, sights, &clip->camera, LAST_ROBUST, &lids->prior))
		turned[0] = turned[1] = turned[2] = NAN;
	return head_pose_cost((const double(*)[4])pose, n, sights, &clip->camera, LAST_ROBUST, &lids->prior);
}

/* The same and how unlikely so high a straight look is: people look straight on in the median, to trust_straight_deg, and did when the mesh was made, to mesh_straight_deg.
 * That straight on is as high as the pose is turned up. */
static double lay_straight(double pose[4][4], double *px, double turned[3], double straight, const struct lids *lids, const struct track_result *r, const struct track_clip *clip,
                           const struct track_subject *s, const struct track_conf *conf)
{
	double was[3], now[3];
	const double cost = lay(pose, px, turned, straight, lids, r, clip, s, conf), usual = conf->trust[TRUST_STRAIGHT][0] * M_PI / 180, mesh = conf->mesh_straight * M_PI / 180;
	if (!isfinite(cost))
		return INFINITY;
	head_fick(was, lids->prior.cam_from_head);
	head_fick(now, (const double(*)[4])pose);
	return cost + pow((straight - lids->usual) / usual, 2) + pow((straight - (now[1] - was[1])) / mesh, 2);
}

/* How high straight on is: lids that stand open further than the mesh's look up. The likeliest of a range of heights; sigma from the cost's curvature there. NAN: not told. */
static double straight_of(double *sigma, const struct lids *lids, const struct track_result *r, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	enum { STEPS = 8 };
	static const double reach = 16 * M_PI / 180;
	double pose[4][4], px, turned[3], cost[2 * STEPS + 1];
	int best = 0;
	for (int i = 0; i <= 2 * STEPS; i++) {
		cost[i] = lay_straight(pose, &px, turned, lids->usual + reach * (i - STEPS) / STEPS, lids, r, clip, s, conf);
		best = cost[i] < cost[best] ? i : best;
	}
	*sigma = 0;
	if (best == 0 || best == 2 * STEPS || !isfinite(cost[best - 1] + cost[best + 1]))
		return NAN;
	const double bend = cost[best - 1] - 2 * cost[best] + cost[best + 1], off = bend > 0 ? 0.5 * (cost[best - 1] - cost[best + 1]) / bend : 0;
	*sigma = bend > 0 ? sqrt(2 / bend) * reach / STEPS : 0;
	return lids->usual + reach * (best + off - STEPS) / STEPS;
}

static struct lids lids_of(bool doubted, const struct track_clip *clip, const struct track_result *r, const struct track_subject *s, const struct track_conf *conf)
{
	const int points = LIDS * conf->eyes.lid_points;
	const double turn = conf->head.turn_sigma * M_PI / 180, calm = doubted ? reference_usual_misfit(r) : 0;
	// one eye alone tells no turn aside
	const double yaw = clip->eye_seen[0] && clip->eye_seen[1] ? conf->head.yaw_sigma * M_PI / 180 : turn;
	// the skin's motion tells how the head leans and where it is, too
	const bool earned = clip->moves.n_known;
	const double lean = earned ? conf->earned_deg * M_PI / 180 : INFINITY, aside = earned ? earned_aside : INFINITY;
	const double away = earned ? conf->earned_away * track_eyes_depth(clip->cam_from_head, s) : INFINITY;
	struct lids lids = { .prior = { .sigma = { turn, yaw, lean, aside, aside, away } } };
	int eyes = 0;
	memcpy(lids.prior.cam_from_head, clip->cam_from_head, sizeof lids.prior.cam_from_head);
	for (int i = 0; i < SIDES * points; i++)
		rest_of(&lids.rest[i / points][i % points], calm, r, clip, s, i / points, i % points, conf);
	for (int e = 0; e < SIDES; e++) {
		const double usual = reference_usual_height(r, e);
		lids.usual += isnan(usual) ? 0 : usual;
		eyes += !isnan(usual);
	}
	lids.usual = eyes ? lids.usual / eyes : NAN;
	return lids;
}

/* The pose by eyeballs, lids and, where form is known, shading; straight: how high straight on is (straight_of). Returns false, pose undefined, where too little is
 * known. */
static bool refine_once(double pose[4][4], double *px, double turned[3], double *straight, const struct lids *lids, const struct track_result *r, const struct track_clip *clip,
                        const struct track_subject *s, const struct track_conf *conf)
{
	double sigma = 0;
	// one eye alone leaves it open: its outline tells where the head is and how it is turned
	*straight = conf->mesh_straight > 0 && isfinite(lids->usual) && clip->eye_seen[0] && clip->eye_seen[1] ? straight_of(&sigma, lids, r, clip, s, conf) : NAN;
	if (!isfinite(lay(pose, px, turned, *straight, lids, r, clip, s, conf)))
		return false;
	if (sigma > 0) {
		// what straight on leaves open turns the head, too
		double other[4][4], d[6], none[3] = { 0 }, room[3];
		if (isfinite(lay(other, px, room, *straight + sigma, lids, r, clip, s, conf))) {
			head_motion(d, (const double(*)[4])other, (const double(*)[4])pose, none);
			for (int k = 0; k < 2; k++)
				turned[k] = hypot(turned[k], d[k]);
		}
		lay(pose, px, room, *straight, lids, r, clip, s, conf);
	}
	return true;
}

/* Shading looked at from pose to pose, with eyeballs and lids, until it turns the head no more. pose: start and result; form: of the result. Returns false where
 * shading tells nothing. */
static bool shade_on(double pose[4][4], struct head_form *form, double straight, struct lids *lids, const struct head_picture *picture, const struct track_result *r,
                     const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	enum { MOST = 40 };
	static const double rest = 0.02 * M_PI / 180, none[3] = { 0 };
	for (int i = 0; i < MOST; i++) {
		double d[6], was[4][4], px, turned[3];
		memcpy(was, pose, sizeof was);
		if (!head_shade(form, s->shape, picture, &clip->camera, (const double(*)[4])was, &conf->shade))
			return false;
		lids->prior.form = form;
		if (!isfinite(lay(pose, &px, turned, straight, lids, r, clip, s, conf)))
			return false;
		head_motion(d, (const double(*)[4])pose, (const double(*)[4])was, none);
		if (hypot(d[0], d[1]) < rest)
			break;
	}
	return true;
}

/* The reference's picture, as shading is looked at. Returns false where it is not. */
static bool shaded(struct head_picture *picture, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	const double depth = track_eyes_depth(clip->cam_from_head, s);
	return s->shape && clip->rgb && depth > 0
	       && head_picture_make(picture, clip->rgb, clip->info.width, clip->info.height, conf->shade.blur * clip->camera.focal_px / depth);
}

static void take_pose(struct track_clip *clip, const double pose[4][4], double px, const double turned[3], double skin_mm)
{
	if (isfinite(turned[0]))
		memcpy(clip->turn_sigma, turned, sizeof clip->turn_sigma);
	memcpy(clip->cam_from_head, pose, sizeof clip->cam_from_head);
	clip->pose_px = px;
	clip->skin_mm = skin_mm;
	clip->pose_refined = true;
}

void reference_refine(struct track_clip *clip, bool doubted, const struct track_result *r, const struct track_subject *s, const struct track_conf *conf)
{
	enum { SHADINGS = 2 };
	struct lids lids = lids_of(doubted, clip, r, s, conf);
	struct head_picture picture = { 0 };
	struct head_form form;
	double pose[4][4], px, turned[3], straight;
	bool done = refine_once(pose, &px, turned, &straight, &lids, r, clip, s, conf);
	if (shaded(&picture, clip, s, conf)) {
		// how high straight on is follows from the turn, and the turn from that
		for (int i = 0; i < SHADINGS && done; i++) {
			if (!shade_on(pose, &form, straight, &lids, &picture, r, clip, s, conf))
				lids.prior.form = 0;
			done = refine_once(pose, &px, turned, &straight, &lids, r, clip, s, conf);
		}
	}
	if (done)
		take_pose(clip, (const double(*)[4])pose, px, turned, trust_skin_mm(r, clip, s));
	clip->shade_patches = 0;
	if (picture.ln && head_shade(&form, s->shape, &picture, &clip->camera, (const double(*)[4])clip->cam_from_head, &conf->shade)) {
		clip->shade_off = form.off;
		clip->shade_patches = head_shade_patches(&form, s->shape, &conf->shade);
	}
	free(picture.ln);
}

/* What the clip alone tells of a centre: the estimate is drawn to the mesh's, which is told once more by the sights. */
static void without_prior(struct eye_globe *g, const double told[3])
{
	for (int k = 0; k < 3; k++) {
		const double kept = 1 - pow(g->center_sigma[k] / g->told_sigma, 2);
		if (!(kept > 0.01))
			continue;
		g->center_in_head[k] = told[k] + (g->center_in_head[k] - told[k]) / kept;
		g->center_sigma[k] /= sqrt(kept);
	}
}

/* Weighs margins by how far they are off, at least least_px: where an eye's lids lie sideways is told by their slopes, in which errors that a whole lid has in common (lashes'
 * shadows) cancel; those alike over a quarter of a lid are left. */
static void weigh_alike(int n, struct head_sight *s, const struct track_clip *clip)
{
	enum { ALIKE = 4 };
	const double least_px = 0.5;
	double sum = 0;
	for (int i = 0; i < n; i++) {
		double px[2];
		if (head_project(px, &clip->camera, clip->cam_from_head, s[i].head))
			sum += pow(s[i].normal[0] * (px[0] - s[i].px[0]) + s[i].normal[1] * (px[1] - s[i].px[1]), 2) / n;
	}
	for (int i = 0; i < n; i++)
		s[i].weight = 1 / (ALIKE * fmax(least_px * least_px, sum));
}

void reference_lens(struct track_clip *clip, const struct track_result *whole, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_result r = *whole;
	struct head_sight sights[SIDES * (LIDS * LID_POINTS_MAX + 2)];
	const int points = LIDS * conf->eyes.lid_points;
	struct rest rest[LIDS * LID_POINTS_MAX];
	const bool earned = clip->moves.turned > 0;
	const double turn = (earned ? conf->earned_deg : conf->head.turn_sigma) * M_PI / 180, yaw = (earned ? conf->earned_deg : conf->head.yaw_sigma) * M_PI / 180;
	struct head_prior prior = { .sigma = { turn, yaw, INFINITY, INFINITY, INFINITY, INFINITY } };
	clip->lens = (struct head_lens){ 0 };
	if (s->assumed || !r.has_eyes || !r.misfit || clip->reference >= r.n || !r.eyes.globe[0].seen || !r.eyes.globe[1].seen)
		return;
	for (int e = 0; e < SIDES; e++)
		without_prior(&r.eyes.globe[e], s->center[e]);
	memcpy(prior.cam_from_head, clip->cam_from_head, sizeof prior.cam_from_head);
	int n = centers(sights, 0, &r, clip, s, conf);
	const int first = n;
	for (int e = 0; e < SIDES && n; e++) {
		for (int i = 0; i < points; i++)
			rest_of(&rest[i], reference_usual_misfit(&r), &r, clip, s, e, i, conf);
		n += margins(sights + n, points, rest, NAN, clip, s, e, (const double(*)[4])clip->cam_from_head);
	}
	weigh_alike(n - first, sights + first, clip);
	if (n < LEAST_MARGIN)
		return;
	struct head_picture picture;
	struct head_lens shade;
	const bool told = head_lens_fit(&clip->lens, (const double(*)[4])clip->cam_from_head, n, sights, &clip->camera, LAST_ROBUST, &prior);
	if (told && shaded(&picture, clip, s, conf)) {
		if (head_shade_lens(&shade, s->shape, &picture, &clip->camera, (const double(*)[4])clip->cam_from_head, n, sights, LAST_ROBUST, &prior, &conf->shade))
			head_lens_join(&clip->lens, &shade);
		free(picture.ln);
	}
}
