#include "track/clip/settle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/clip/earn.h"
#include "track/clip/few.h"
#include "track/clip/look.h"
#include "track/clip/moves.h"
#include "track/clip/reference.h"
#include "track/clip/refine.h"
#include "track/clip/trust.h"
#include "track/head/refine.h"

enum { LOOKS = 4, LATER = 15 };

static void tell_worse(struct stage *stage, const struct track_clip *clip, const struct reference_view *view)
{
	const char *what = "the eyes are not open in it";
	char text[120];
	if (view->open) {
		snprintf(text, sizeof text, "in it the eyes look %.0f degrees to the side and %.0f %s from where they mostly do", fabs(view->aside), fabs(view->up),
		         view->up < 0 ? "down" : "up");
		what = text;
	}
	stage_skipped(stage, "%s: track.reference_frame = %ld: %s, and gaze may be off by degrees: take %ld, or leave it to be found", clip->file, clip->reference, what,
	              view->better);
}

/* Makes another frame the reference and finds the head there. Returns false, nothing changed, when it is not found. */
static bool look_anew(struct track_clip *clip, long frame, enum track_way way, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_clip was = *clip;
	struct err none = { 0 };
	if (frame != clip->reference) {
		size_t area = (size_t)clip->info.width * (size_t)clip->info.height;
		clip->luma = mem_array(area + 1, 1);
		clip->rgb = mem_array(3 * area + 1, 1);
	}
	bool ok = (frame == clip->reference || track_clip_take(clip, frame, stage, conf, &none)) && track_look(clip, way, s, conf);
	if (frame != was.reference) {
		free(ok ? was.luma : clip->luma);
		free(ok ? was.rgb : clip->rgb);
	}
	was.faces = clip->faces;
	if (!ok)
		*clip = was;
	return ok;
}

/* Refines again while that still turns the head: eyes were measured, and lids laid, under the pose before. */
static void settle_on(struct track_clip *clip, const double was[4][4], struct stage *stage, const struct track_subject *s, const struct track_conf *few)
{
	enum { MOST = 4 };
	static const double still = M_PI / 180, none[3] = { 0 };
	double last[4][4], d[6];
	memcpy(last, was, sizeof last);
	// one eye alone leads it astray
	for (int i = 0; i < MOST && clip->eye_seen[0] && clip->eye_seen[1]; i++) {
		struct track_result r = { 0 };
		head_motion(d, clip->cam_from_head, last, none);
		if (hypot(d[0], d[1]) < still)
			return;
		memcpy(last, clip->cam_from_head, sizeof last);
		if (track_follow_few(&r, clip, stage, s, few))
			reference_refine(clip, false, &r, s, few);
		track_result_free(&r);
	}
}

/* Refines the pose of a reference that was not doubted: by settle_frames from the clip's start (at 60 a second), where the
 * reference lies among them; else by the frames that it was judged by. */
static void settle(struct track_clip *clip, const struct track_result *judged, struct stage *stage, const struct track_subject *s, const struct track_conf *few,
                   const struct track_conf *conf)
{
	struct track_conf all = track_few_of(conf, clip, conf->settle, conf->settle);
	struct track_result r = { 0 };
	double was[4][4];
	memcpy(was, clip->cam_from_head, sizeof was);
	if (all.limit > few->limit && clip->reference < all.limit * all.every && track_follow_few(&r, clip, stage, s, &all))
		reference_refine(clip, false, &r, s, &all);
	else
		reference_refine(clip, false, judged, s, few);
	track_result_free(&r);
	settle_on(clip, (const double(*)[4])was, stage, s, few);
}

/* What has been tried since the reference was doubted. */
struct doubts {
	enum track_way way;
	bool any, moved, turned, last;  // last: no further frame is tried
};

/* Returns true when the frames followed contradict the reference and the head was found in another frame, or the other way up. */
static bool look_again(struct track_clip *clip, struct doubts *d, const struct track_result *r, const struct reference_view *view, struct stage *stage,
                       const struct track_subject *s, const struct track_conf *conf)
{
	// a frame without open eyes does not show which way up the head is
	if (conf->reference < 0 && view->better >= 0 && (!d->moved || !view->open) && !d->last
	    && (d->moved = look_anew(clip, view->better, d->turned ? d->way : WAY_EITHER, stage, s, conf))) {
		clip->begins_shut = clip->begins_shut || !view->open;
		return true;
	}
	if (d->turned || !reference_is_overturned(r, clip, s))
		return false;
	d->way = clip->cam_from_head[1][1] > 0 ? WAY_UP : WAY_OVER;
	return d->turned = look_anew(clip, clip->reference, d->way, stage, s, conf);
}

/* Whether other frames are to be tried: for the residual of its pose, or as its skin is off that of most frames (an expression). */
static bool is_off(const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	return !(clip->pose_px <= conf->pose_most * trust_scale(clip, s)) || trust_odds(TRUST_SKIN, clip->skin_mm, conf) < 0;
}

/* Log odds of another reference against the clip's by their shading: of the same skin in the same light, under the right pose it fits better. */
static double shade_odds(const struct track_clip *other, const struct track_clip *clip)
{
	const double patches = fmin(other->shade_patches, clip->shade_patches);
	return patches > 0 ? patches * log(clip->shade_off / other->shade_off) : 0;
}

/* Exchanges the clip's reference and another's where that is likelier right by its residual, its skin and its shading; frees the other's pictures. */
static void take_better(struct track_clip *clip, struct track_clip *other, bool found, const struct track_subject *s, const struct track_conf *conf)
{
	clip->faces = other->faces;
	if (found && trust_reference(other, s, conf) + shade_odds(other, clip) > trust_reference(clip, s, conf)) {
		struct track_clip t = *clip;
		*clip = *other;
		*other = t;
	}
	free(other->luma);
	free(other->rgb);
}

/* The clip, with pictures of its own. */
static struct track_clip another(const struct track_clip *clip)
{
	size_t area = (size_t)clip->info.width * (size_t)clip->info.height;
	struct track_clip other = *clip;
	other.luma = mem_array(area + 1, 1);
	other.rgb = mem_array(3 * area + 1, 1);
	memcpy(other.luma, clip->luma, area);
	memcpy(other.rgb, clip->rgb, 3 * area);
	other.begins_shut = true;
	return other;
}

/* The pair of eyes that the evidence shows best as the start, where an outline alone was found in the wrong place. */
static bool try_evidence(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	struct track_conf few = track_few_of(conf, clip, conf->doubt.frames, conf->doubt.span);
	struct track_clip other = another(clip);
	struct head_found found = { .seen = { true, true } };
	double was[4][4];
	bool better = track_propose(&other, stage, s, conf, err);
	memcpy(found.cam_from_head, other.cam_from_head, sizeof found.cam_from_head);
	better = better && head_find_refine(&found, other.rgb, other.info.width, other.info.height, &other.camera, s->opening, &conf->head);
	if (better) {
		struct track_result r = { 0 };
		memcpy(was, other.cam_from_head, sizeof was);
		memcpy(other.cam_from_head, found.cam_from_head, sizeof other.cam_from_head);
		memcpy(other.eye_seen, found.seen, sizeof other.eye_seen);
		other.pose_refined = false;
		other.pose_px = INFINITY;
		better = track_follow_few(&r, &other, stage, s, &few);
		if (better)
			reference_refine(&other, true, &r, s, &few);
		track_result_free(&r);
		if (better)
			settle_on(&other, (const double(*)[4])was, stage, s, &few);
	}
	take_better(clip, &other, better, s, conf);
	return !err_is(err);
}

/* Frames spread over the clip, each as the reference: openings, eyeballs and mesh are fitted together, and the likeliest is
 * kept. */
static void try_others(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	enum { TRIES = 5 };
	struct track_conf few = track_few_of(conf, clip, conf->look.frames, conf->doubt.span);
	const enum track_way way = clip->cam_from_head[1][1] > 0 ? WAY_OVER : WAY_UP;
	long span = few.every * few.limit < clip->info.frames ? few.every * few.limit : clip->info.frames;
	for (int i = 0; i < TRIES && is_off(clip, s, conf); i++) {
		struct track_clip other = another(clip);
		struct track_result r = { 0 };
		struct err none = { 0 };
		bool better = track_clip_take(&other, span * (2 * i + 1) / (2 * TRIES), stage, conf, &none) && track_look(&other, way, s, conf)
		              && track_follow_few(&r, &other, stage, s, &few);
		if (better)
			reference_refine(&other, true, &r, s, &few);
		take_better(clip, &other, better, s, conf);
		track_result_free(&r);
	}
}

/* Looks at few frames, and settles the reference and its pose. */
static void settle_clip(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_conf few = track_few_of(conf, clip, conf->look.frames, conf->look.span);
	struct doubts d = { .way = WAY_EITHER };
	bool again = true;
	clip->begins_shut = clip->reference > 0;
	for (int round = 0; again && round < LOOKS; round++) {
		struct track_result r = { 0 };
		bool followed = track_follow_few(&r, clip, stage, s, &few);
		struct reference_view view = { .better = -1 };
		again = false;
		d.last = round + 1 == LOOKS;
		if (followed)
			view = reference_judge(&r, clip, few.every);
		if (!d.any && (!followed || view.better >= 0 || reference_is_overturned(&r, clip, s))) {
			// few frames raised a doubt: judge by more
			d.any = again = true;
			few = track_few_of(conf, clip, conf->doubt.frames, conf->doubt.span);
			round = -1;
		} else if (!followed) {
			// no eye was found: the face was a false detection
			for (long later = track_frames_of(clip, LATER), f = clip->reference + later; conf->reference < 0 && !again && f < clip->info.frames && f < track_frames_of(clip, conf->doubt.span); f += later)
				clip->begins_shut = again = look_anew(clip, f, WAY_EITHER, stage, s, conf);
		} else if (!d.any) {
			settle(clip, &r, stage, s, &few, conf);
		} else if (!(again = look_again(clip, &d, &r, &view, stage, s, conf))) {
			reference_refine(clip, true, &r, s, &few);
			// eyes were measured under the old pose: measure and refine once more
			track_result_free(&r);
			if (track_follow_few(&r, clip, stage, s, &few))
				reference_refine(clip, true, &r, s, &few);
			if (conf->reference >= 0 && view.better >= 0)
				tell_worse(stage, clip, &view);
		}
		track_result_free(&r);
	}
}

/* Where halves of the skin tell poses that are far apart, both may still be about right: whether lids, eyeballs and shading alone, which know nothing of the skin's
 * motion, turn the head as all of it does. */
static bool is_confirmed(const struct track_clip *clip, const struct track_result *r, const struct track_subject *s, const struct track_conf *few)
{
	static const double free_deg = 20, none[3] = { 0 };
	struct track_clip alone = *clip;
	struct track_conf free = *few;
	double d[6];
	free.head.turn_sigma = free.head.yaw_sigma = free_deg;
	alone.moves.n_known = 0;
	alone.turn_sigma[0] = alone.turn_sigma[1] = 0;
	alone.pose_refined = false;
	reference_refine(&alone, true, r, s, &free);
	head_motion(d, (const double(*)[4])alone.cam_from_head, clip->cam_from_head, none);
	return s->shape && alone.pose_refined && alone.turn_sigma[0] > 0 && hypot(d[0], d[1]) < few->confirmed * M_PI / 180;
}

/* A pose that was earned by how the skin moves knows the turn better than the place: openings and eyeballs tell that. */
static void settle_earned(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_conf few = track_few_of(conf, clip, conf->doubt.frames, conf->doubt.span);
	struct track_result r = { 0 };
	const double px = clip->pose_px;
	few.head.turn_sigma = few.head.yaw_sigma = conf->earned_deg;
	if (track_follow_few(&r, clip, stage, s, &few)) {
		if (clip->moves.torn && clip->moves.halves && clip->moves.apart < 2 * conf->torn * M_PI / 180)
			clip->moves.torn = !is_confirmed(clip, &r, s, &few);
		reference_refine(clip, true, &r, s, &few);
	}
	clip->pose_px = px;
	track_result_free(&r);
}

bool track_settle(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	if (s->assumed || clip->pose_given || !conf->settle)
		return true;
	if (track_earn(clip, stage, s, conf, err)) {
		clip->begins_shut = true;
		settle_earned(clip, stage, s, conf);
		return true;
	}
	if (err_is(err))
		return false;
	settle_clip(clip, stage, s, conf);
	if (is_off(clip, s, conf) && conf->reference < 0 && !try_evidence(clip, stage, s, conf, err))
		return false;
	if (is_off(clip, s, conf) && conf->reference < 0)
		try_others(clip, stage, s, conf);
	return true;
}

bool track_settled(const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	if (clip->moves.torn)
		return err_set(err, "%s: frame %ld: its skin does not move as %s does (off by %.2f mm, must be at most %.2f: track.off_mm; its halves tell poses %.1f degrees apart, must be at most %.1f: track.torn_deg; its turn is known to %.2f degrees, must be to %.1f): check camera.focal_px and subject.unit_mm, film in softer light, or give track.reference_frame",
		               clip->file, clip->reference, s->file, clip->moves.off_mm, conf->off_mm, clip->moves.apart * 180 / M_PI, conf->torn, clip->moves.sigma * 180 / M_PI, MOVES_SIGMA_MOST);
	const double most = hypot(conf->pose_refused * trust_scale(clip, s), 3 * conf->outline);
	if (s->assumed || clip->pose_given || !conf->settle || clip->pose_px <= most)
		return true;
	return err_set(err, "%s: frame %ld: its lids and eyeballs do not come together with %s (residual %.1f px, must be at most %.1f: track.pose_refused_px): give subject.eye_center.left and .right, subject.eye_radius, camera.focal_px, or a frame from in front (track.reference_frame)",
	               clip->file, clip->reference, s->file, clip->pose_px, most);
}
