#include "track/clip/follow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/clip/chunks.h"
#include "track/clip/follow_impl.h"
#include "track/clip/scale.h"
#include "track/clip/steady.h"
#include "track/clip/together.h"

static const double forget = 1.2;  // rate of that running mean, 1/s
/* Expected motion of skin relative to the head, mm: bridge of the nose, cheeks, brows, lids. */
static const double off_nose = 0.026, off_cheek = 0.13, off_brow = 0.346, off_lids = 0.52;
/* Random walk of the head: standard deviations after a second, degrees, mm. */
static const double turn_step = 1.55, shift_step = 4.65;

static const double least_turned = 1;  // degrees: a head that turns by more is held by its skin alone

static double expected_off(const double head[3], const struct track_subject *s)
{
	double nose = 0.5 * (s->center[SIDE_LEFT][0] + s->center[SIDE_RIGHT][0]);
	if (track_on_lid(head, s))
		return off_lids;
	double up = head[1] - (isnan(s->center[SIDE_LEFT][1]) ? s->center[SIDE_RIGHT][1] : s->center[SIDE_LEFT][1]);
	if (fabs(head[0] - (isnan(nose) ? 0 : nose)) < s->radius && up < 0.5 * s->radius)
		return off_nose;
	return up > 0.5 * s->radius ? off_brow : off_cheek;
}

static struct rigid rigid_new(const struct track_points *points, const struct track_subject *s, double px_per_mm)
{
	struct rigid r = { .n = points->n, .off2 = mem_new((size_t)points->n + 1, sizeof *r.off2), .least = mem_new((size_t)points->n + 1, sizeof *r.least), .sights = mem_new((size_t)points->n + 1, sizeof *r.sights) };
	for (int i = 0; i < r.n; i++) {
		memcpy(r.sights[i].head, points->head[i], sizeof r.sights[i].head);
		r.off2[i] = r.least[i] = pow(px_per_mm * expected_off(points->head[i], s), 2);
	}
	return r;
}

static void rigid_free(struct rigid *r)
{
	free(r->off2);
	free(r->least);
	free(r->sights);
}

/* dt: seconds since the frame before. moves: the head is known to turn. */
static void pose_of(double pose[4][4], struct rigid *r, const struct skin_point_state *state, const struct camera *camera, double robust, double dt, bool moves)
{
	double next[4][4], turn = sqrt(dt) * turn_step * M_PI / 180, shift = sqrt(dt) * shift_step, new = fmin(1, forget * dt);
	struct head_prior prior = { .sigma = { turn, turn, turn, shift, shift, shift } };
	memcpy(next, pose, sizeof next);
	memcpy(prior.cam_from_head, pose, sizeof prior.cam_from_head);
	for (int i = 0; i < r->n; i++) {
		r->sights[i].weight = state[i].confidence / fmax(r->least[i], r->off2[i]);
		memcpy(r->sights[i].px, state[i].at, sizeof r->sights[i].px);
	}
	// what moves far between two frames lies outside of the narrow weights: wide ones first
	for (int wide = 16; moves && wide > 1; wide /= 4)
		head_pose_fit(next, r->n, r->sights, camera, wide * robust, 0);
	if (isnan(head_pose_fit(next, r->n, r->sights, camera, robust, moves ? 0 : &prior)))
		return;
	memcpy(pose, next, sizeof next);
	for (int i = 0; i < r->n; i++) {
		double px[2];
		if (state[i].confidence > 0 && head_project(px, camera, pose, r->sights[i].head))
			r->off2[i] += new * (fmin(100, pow(px[0] - state[i].at[0], 2) + pow(px[1] - state[i].at[1], 2)) - r->off2[i]);
	}
}

static void store(struct track_result *r, const struct skin_point_state *state, const double pose[4][4], bool lost,
                  const struct track_points *points, const struct track_clip *clip)
{
	long at = r->n * r->n_points;
	for (int i = 0; i < r->n_points; i++) {
		r->skin[at + i][0] = (float)state[i].at[0];
		r->skin[at + i][1] = (float)state[i].at[1];
		r->confidence[at + i] = lost || !track_points_face(points, i, pose) ? 0 : (float)state[i].confidence;
		track_to_model(r->skin_model[at + i], state[i].at, points->head[i], pose, clip);
	}
	memcpy(r->pose[r->n], pose, sizeof r->pose[r->n]);
}

/* Tracks the skin in one frame; returns true when it is lost. */
static bool skin_frame(struct track_result *r, struct skin_track *skin, struct skin_point_state *state, const struct video_frame *f,
                       const struct track_conf *conf)
{
	if (!skin)
		return false;
	double seen = skin_track_push(skin, f->luma, f->luma_stride, state);
	r->still += skin_track_was_still(skin);
	if (seen >= conf->cut)
		return false;
	// the camera may have jumped there and back
	skin_track_restart(skin);
	seen = skin_track_push(skin, f->luma, f->luma_stride, state);
	if (seen >= conf->cut)
		return false;
	if (r->cut < 0)
		r->cut = f->index;
	r->lost++;
	return true;
}

/* Follows the frames that are not followed yet. */
static bool frames(struct follow *f, struct chunks *chunks, struct video *video, const struct video_info *info, struct stage *stage, const struct track_clip *clip,
                   const struct track_points *points, const struct track_conf *conf, struct err *err)
{
	struct track_result *r = f->r;
	struct skin_point_state *state = mem_new((size_t)points->n + 1, sizeof *state);
	const bool moves = clip->moves.turned > least_turned * M_PI / 180;
	const long every = track_every(conf), known = r->n;
	bool ok = true, got = true;
	while (ok && got && (!conf->limit || r->n < conf->limit)) {
		struct video_frame frame;
		ok = video_next(&frame, &got, video, err);
		const bool mine = ok && got && frame.index % every == clip->reference % every;
		if (ok && got && !conf->limit && frame.index < known) {
			// followed by a run before this one
		} else if (ok && got && moves && !mine) {
			skin_track_push(f->skin, frame.luma, frame.luma_stride, state);
		} else if (mine) {
			track_result_room(r, &f->room, r->n + 1);
			bool lost = skin_frame(r, f->skin, state, &frame, conf);
			if (!lost && points->n)
				pose_of(f->pose, &f->rigid, state, &clip->camera, conf->still_pose_px, fmax(1e-4, r->n ? frame.time - r->time[r->n - 1] : 1 / info->fps), moves);
			r->time[r->n] = frame.time;
			r->lost_at[r->n] = lost;
			store(r, state, f->pose, lost, points, clip);
			r->n++;
			background_push(f->background, &frame, (const double(*)[4])f->pose);
			chunks_keep(chunks, f);
			if (!conf->limit)
				stage_progress(stage, (int)r->n, (int)info->frames, "frames");
		}
		video_frame_free(&frame);
	}
	free(state);
	return ok;
}

static void begin(struct follow *f, struct stage *stage, const struct track_clip *clip, const struct track_subject *subject, const struct track_points *points,
                  const struct track_conf *conf)
{
	enum { RESIDENT = 32 << 20 };
	struct track_result *r = f->r;
	*r = (struct track_result){ .n_points = points->n, .cut = -1, .lid_points = conf->eyes.lid_points, .n_au = conf->expression.n };
	r->bulk = !chunks_wanted(clip, conf) ? 0 : bulk_open(stage_path(stage, "work/skin"), RESIDENT);
	f->room = 0;
	f->skin = !points->n ? 0 : skin_track_new(&points->points, clip->luma, clip->info.width, clip->info.width, clip->info.height, points->mask, &conf->skin);
	f->rigid = rigid_new(points, subject, track_px_per_mm(clip, clip->cam_from_head, subject));
	f->eyes = track_eyes_new(clip, subject, r->bulk, conf);
	if (f->skin && clip->moves.n)
		skin_track_begin(f->skin, clip->moves.n, (const double(*)[2])clip->moves.at, clip->moves.first);
	r->film = conf->limit ? 0 : film_new(clip, subject, points);
	r->folds = conf->limit || subject->assumed ? 0 : folds_new(clip, points, conf);
	memcpy(f->pose, clip->cam_from_head, sizeof f->pose);
}

static void end(struct follow *f)
{
	track_eyes_free(f->eyes);
	rigid_free(&f->rigid);
	skin_track_free(f->skin);
}

bool track_follow(struct track_result *r, struct stage *stage, const struct track_clip *clip, const struct track_subject *subject,
                  const struct track_points *points, const struct track_conf *conf, struct err *err)
{
	struct video_info info;
	struct follow f = { .r = r };
	struct video *video = video_open(&info, stage_path(stage, "%s", clip->file), &conf->video, err);
	*r = (struct track_result){ .cut = -1 };
	if (!video)
		return false;
	struct chunks chunks = chunks_of(stage, clip, points, conf);
	begin(&f, stage, clip, subject, points, conf);
	if (!chunks_read(&chunks, &f)) {
		end(&f);
		track_result_free(r);
		begin(&f, stage, clip, subject, points, conf);
	}
	if (r->n)
		stage_note(stage, "%s: goes on from frame %ld, where a run before this one was ended", clip->file, r->n);
	f.background = background_new(f.eyes, r->film, r->folds);
	bool ok = frames(&f, &chunks, video, &info, stage, clip, points, conf, err);
	background_end(f.background);
	if (video_damaged(video))
		stage_skipped(stage, "%s: %ld damaged pictures were left out: copy the file again", clip->file, video_damaged(video));
	if (ok && points->n) {
		const long every = track_every(conf);
		track_steady(r, clip->reference / every < r->n ? clip->reference / every : 0, points, subject, clip, conf->stirs_mm);
		if (!conf->limit)
			track_together(r, points, clip, subject, conf);
	}
	if (ok)
		track_eyes_hold(r, f.eyes, conf);
	ok = ok && (r->n < 2 || track_eyes_finish(r, f.eyes, err));
	end(&f);
	video_close(video);
	return ok;
}
