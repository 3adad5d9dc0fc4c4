#include "track/clip/moves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/clip/points.h"
#include "track/clip/scale.h"
#include "track/head/rigid.h"
#include "track/points/skin_track.h"

enum { HALF = 2, MOVING_POINTS = 200, LEAST_FRAMES = 5 };

static const double rest_mm = 2;                            // a head on a rest moves its skin by less, in the median
static const double reach_mm = 75;                          // of the eyeballs' centres: nose and cheeks, too
static const double off_lid = 1.2, off_brow = 0.6, off_skin = 0.15;  // mm: skin's own motion, about
static const double anchor_mm = 5;                          // of an opening's middle from where it was found
static const double reach_yaw = 36, reach_pitch = 20;       // degrees
static const double robust_mm = 0.3;                       // scale of the weights
static const double most_turned = 85;                       // degrees: of a face that is seen all the while

/* Frames kept: brightness of half the size. */
struct strip {
	int width, height;
	long n, reference, room;
	uint8_t **luma;
};

static void keep(struct strip *s, const uint8_t *luma, int stride)
{
	if (s->n == s->room) {
		s->room = 2 * s->room + 64;
		s->luma = mem_grow(s->luma, (size_t)s->room, sizeof *s->luma);
	}
	uint8_t *to = s->luma[s->n++] = mem_array((size_t)s->width * (size_t)s->height + 1, 1);
	for (int y = 0; y < s->height; y++) {
		const uint8_t *a = luma + (long)HALF * y * stride, *b = a + stride;
		for (int x = 0; x < s->width; x++)
			to[(long)y * s->width + x] = (uint8_t)((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) / 4);
	}
}

static bool read_strip(struct strip *s, long every, long span, const struct track_clip *clip, struct stage *stage, const struct track_conf *conf)
{
	struct video_info info;
	struct err none = { 0 };
	struct video *video = video_open(&info, stage_path(stage, "%s", clip->file), &conf->video, &none);
	bool got = video;
	const long last = span > clip->reference ? span : clip->reference + 1;
	*s = (struct strip){ .width = clip->info.width / HALF, .height = clip->info.height / HALF, .reference = -1 };
	for (long i = 0; got && i < last; i++) {
		struct video_frame f;
		got = video_next(&f, &got, video, &none) && got;
		if (got && i % every == clip->reference % every) {
			if (i == clip->reference)
				s->reference = s->n;
			keep(s, f.luma, f.luma_stride);
		}
		video_frame_free(&f);
	}
	video_close(video);
	return s->reference >= 0;
}

static void strip_free(struct strip *s)
{
	for (long i = 0; i < s->n; i++)
		free(s->luma[i]);
	free(s->luma);
}

static void halve(struct skin_points *to, const struct skin_points *from, uint8_t *mask, const uint8_t *whole, const struct strip *s, int width)
{
	*to = *from;
	to->at = mem_array((size_t)from->n + 1, sizeof *to->at);
	for (int i = 0; i < from->n; i++)
		for (int k = 0; k < 2; k++)
			to->at[i][k] = from->at[i][k] / HALF;
	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++)
			mask[(long)y * s->width + x] = whole[(long)HALF * y * width + HALF * x];
}

/* From the reference to frame `to`, one way. */
static void walk(struct track_moves *m, struct skin_track *skin, const struct strip *s, long to)
{
	struct skin_point_state *state = mem_array((size_t)m->n + 1, sizeof *state);
	const long way = to < s->reference ? -1 : 1;
	for (long f = s->reference; f != to + way; f += way) {
		skin_track_push(skin, s->luma[f], s->width, state);
		for (int i = 0; i < m->n; i++) {
			for (int k = 0; k < 2; k++)
				m->px[f * m->n + i][k] = (float)(HALF * state[i].at[k]);
			m->seen[f * m->n + i] = (float)state[i].confidence;
		}
	}
	free(state);
}

bool track_moves(struct track_moves *m, long every, long span, const struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_conf few = *conf;
	struct track_points points = { 0 };
	struct strip strip = { 0 };
	struct err none = { 0 };
	*m = (struct track_moves){ 0 };
	few.points = MOVING_POINTS;
	few.reach_mm = fmax(conf->reach_mm, reach_mm);
	few.skin.every = 2;
	few.skin.sweeps = 1;
	few.skin.radius = 8;
	few.skin.quiet = 0;
	bool ok = track_points_choose(&points, clip, s, &few, &none) && read_strip(&strip, every, span, clip, stage, conf)
	          && strip.n >= LEAST_FRAMES && clip->info.width > 8 && clip->info.height > 8;
	if (ok) {
		struct skin_points half;
		uint8_t *mask = mem_array((size_t)strip.width * (size_t)strip.height + 1, 1);
		halve(&half, &points.points, mask, points.mask, &strip, clip->info.width);
		m->n = points.n;
		m->frames = strip.n;
		m->reference = strip.reference;
		m->every = every;
		m->first_frame = clip->reference % every;
		m->at = points.points.at;
		m->head = points.head;
		points.points.at = 0;
		points.head = 0;
		m->px = mem_array((size_t)m->n * (size_t)m->frames + 1, sizeof *m->px);
		m->seen = mem_array((size_t)m->n * (size_t)m->frames + 1, sizeof *m->seen);
		m->first = mem_array((size_t)m->n + 1, sizeof *m->first);
		struct skin_track *skin = skin_track_new(&half, strip.luma[strip.reference], strip.width, strip.width, strip.height, mask, &few.skin);
		walk(m, skin, &strip, strip.n - 1);
		skin_track_restart(skin);
		walk(m, skin, &strip, 0);
		skin_track_warps(m->first, skin);
		for (int i = 0; i < m->n; i++)
			for (int k = 0; k < 2; k++)
				m->first[i].at[k] *= HALF;
		skin_track_free(skin);
		free(half.at);
		free(mask);
	}
	strip_free(&strip);
	track_points_free(&points);
	return ok;
}

void track_moves_free(struct track_moves *m)
{
	free(m->at);
	free(m->head);
	free(m->px);
	free(m->seen);
	free(m->first);
	free(m->known);
	*m = (struct track_moves){ 0 };
}

bool track_moves_rest(const struct track_moves *m, const struct track_clip *clip, const struct track_subject *s)
{
	double *off = mem_array((size_t)m->n + 1, sizeof *off), most = 0;
	for (long f = 0; f < m->frames; f++) {
		int n = 0;
		for (int i = 0; i < m->n; i++)
			if (m->seen[f * m->n + i] > 0)
				off[n++] = hypot((double)m->px[f * m->n + i][0] - m->at[i][0], (double)m->px[f * m->n + i][1] - m->at[i][1]);
		most = fmax(most, n > m->n / 3 ? stats_median(n, off) : INFINITY);
	}
	free(off);
	return m->n > 0 && most < rest_mm * track_px_per_mm(clip, clip->cam_from_head, s);
}

/* How far skin moves on its own, mm. */
static double own_motion(const double head[3], const struct track_subject *s)
{
	double up = head[1] - 0.5 * (s->center[SIDE_LEFT][1] + s->center[SIDE_RIGHT][1]);
	return track_on_lid(head, s) ? off_lid : up > 0.5 * s->radius ? off_brow : off_skin;
}

static void keep_known(struct track_moves *m, const struct rigid_fit *fit)
{
	m->n_known = fit->n_known;
	m->known = mem_new((size_t)fit->n_known + 1, sizeof *m->known);
	for (int i = 0; i < fit->n_known; i++) {
		m->known[i].frame = m->first_frame + m->every * fit->known[i].frame;
		memcpy(m->known[i].cam_from_head, fit->known[i].cam_from_head, sizeof m->known[i].cam_from_head);
	}
}

bool track_moves_pose(struct track_clip *clip, struct track_moves *m, const struct track_subject *s, bool near, const struct track_conf *conf)
{
	double *weight = mem_array((size_t)m->n + 1, sizeof *weight), pose[4][4], px_per_mm = track_px_per_mm(clip, clip->cam_from_head, s);
	struct rigid_film film = { m->n, (int)m->frames, (const double(*)[2])m->at, weight, (const float(*)[2])m->px, m->seen };
	struct rigid_anchor anchor[SIDES];
	struct rigid_fit fit = { 0 };
	int anchors = 0;
	for (int i = 0; i < m->n; i++)
		weight[i] = pow(px_per_mm * own_motion(m->head[i], s), -2);
	for (int e = 0; e < SIDES; e++) {
		struct rigid_anchor *a = &anchor[anchors];
		memcpy(a->head, s->opening[e].center, sizeof a->head);
		a->sigma_px = anchor_mm * px_per_mm;
		anchors += s->opening[e].open && clip->eye_seen[e] && head_project(a->px, &clip->camera, clip->cam_from_head, a->head);
	}
	const double reach[2] = { near ? 0 : reach_yaw * M_PI / 180, near ? 0 : reach_pitch * M_PI / 180 };
	memcpy(pose, clip->cam_from_head, sizeof pose);
	bool ok = rigid_fit(pose, &fit, &film, &s->mesh, &clip->camera, anchors, anchor, reach, robust_mm * px_per_mm);
	free(weight);
	m->turned = ok ? fit.turned : 0;
	m->apart = ok ? fit.apart : INFINITY;
	if (!ok || fit.turned < conf->turned * M_PI / 180)
		return false;
	keep_known(m, &fit);
	m->off_mm = fit.off_px / px_per_mm;
	m->sigma = hypot(fit.sigma[0], fit.sigma[1]);
	m->halves = !(m->off_mm > conf->off_mm) && !(fit.turned > most_turned * M_PI / 180) && m->sigma < MOVES_SIGMA_MOST * M_PI / 180;
	m->torn = !m->halves || fit.apart > conf->torn * M_PI / 180;
	memcpy(clip->cam_from_head, pose, sizeof pose);
	clip->pose_px = fit.off_px;
	clip->pose_refined = true;
	return true;
}

/* Point i about the rigid head in a known frame, mm along the picture's axes; false where it is not seen. */
static bool about(double out[2], int i, int known, const struct track_moves *m, const struct track_clip *clip, const struct track_subject *s)
{
	const struct track_known *k = &m->known[known];
	const double(*pose)[4] = (const double(*)[4])k->cam_from_head, seen = 0.3;
	const long at = (k->frame - m->first_frame) / m->every * m->n + i;
	double px[2];
	if (!((double)m->seen[at] > seen) || !head_project(px, &clip->camera, pose, m->head[i]))
		return false;
	for (int c = 0; c < 2; c++)
		out[c] = ((double)m->px[at][c] - px[c]) / track_px_per_mm(clip, pose, s);
	return true;
}

static bool round_eyes(const double head[3], const struct track_subject *s, double reach)
{
	bool near = false;
	for (int e = 0; e < SIDES; e++)
		near = near || hypot(hypot(head[0] - s->center[e][0], head[1] - s->center[e][1]), head[2] - s->center[e][2]) < reach;
	return near;
}

/* The same of a part of the points: the lids' (lids true), or all others. room: [n]. */
static double stirs(int k, bool lids, const double (*usual)[2], const struct track_moves *m, const struct track_clip *clip, const struct track_subject *s, double reach, double *room)
{
	enum { LEAST = 12 };
	double at[2];
	int n = 0;
	for (int i = 0; i < m->n; i++)
		if (track_on_lid(m->head[i], s) == lids && round_eyes(m->head[i], s, reach) && isfinite(usual[i][0]) && about(at, i, k, m, clip, s))
			room[n++] = hypot(at[0] - usual[i][0], at[1] - usual[i][1]);
	return n >= LEAST ? stats_quantile(n, room, 0.75) : NAN;
}

void track_moves_stirred(double *off, const struct track_moves *m, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	const double of_lids = 1.0 / 3;
	double(*usual)[2] = mem_array((size_t)m->n + 1, sizeof *usual), *room = mem_array((size_t)(m->n_known > m->n ? m->n_known : m->n) + 1, sizeof *room), at[2];
	for (int i = 0; i < m->n; i++)
		for (int c = 0; c < 2; c++) {
			int n = 0;
			for (int k = 0; k < m->n_known; k++)
				if (about(at, i, k, m, clip, s))
					room[n++] = at[c];
			usual[i][c] = n > 2 ? stats_median(n, room) : NAN;
		}
	for (int k = 0; k < m->n_known; k++) {
		const double lids = stirs(k, true, (const double(*)[2])usual, m, clip, s, conf->reach_mm, room);
		off[k] = stirs(k, false, (const double(*)[2])usual, m, clip, s, conf->reach_mm, room) + (isnan(lids) ? 0 : of_lids * lids);
	}
	free(usual);
	free(room);
}
