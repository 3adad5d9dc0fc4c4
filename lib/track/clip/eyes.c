#include "track/clip/eyes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/evidence.h"
#include "track/clip/hold.h"
#include "track/clip/trust.h"
#include "track/eye/events.h"
#include "track/head/propose.h"

struct track_eyes {
	struct eye_track *track;
	const struct track_clip *clip;
	const struct track_subject *subject;
	uint8_t *rgb;          // [height][3 width]; only what lies round the eyes is filled
	double limbus;         // mm, of an average eye
	double evidence_px;    // conf's
	struct evidence_net *net;      // null: it is not
	struct photo photo;            // what lies round the eyes, for it
	struct evidence seen[SIDES];   // of the last frame
	struct hold *hold;     // null: skin alone tells the head's pose
	double time;           // of the last frame
};

/* Where the distance was assumed, the line of sight to an eye aside of the camera's axis is off in proportion to its angle. */
static void view_sigma(double sigma[2], const struct track_clip *clip, const struct track_subject *subject, int side, const struct track_conf *conf)
{
	double p[3];
	head_from(p, clip->cam_from_head, subject->center[side]);
	for (int k = 0; k < 2; k++)
		sigma[k] = subject->assumed && clip->focal_assumed ? conf->distance_sigma * fabs(p[k] / p[2]) : 0;
}

/* Middle and radius of an iris that looks straight on, px. */
static bool iris_of(double place[3], const struct track_eyes *eyes, int side, const double pose[4][4])
{
	const struct track_subject *s = eyes->subject;
	const double limbus = s->limbus[side] > 0 ? s->limbus[side] : eyes->limbus;
	double p[3];
	if (!s->opening[side].open || !head_project(place, &eyes->clip->camera, pose, s->opening[side].center))
		return false;
	head_from(p, pose, s->opening[side].center);
	place[2] = eyes->clip->camera.focal_px * limbus / p[2];
	return place[2] > 0;
}

/* What the network is shown of an iris. */
static void fill_photo(struct photo *photo, const uint8_t *rgb, const double place[3])
{
	const double reach = 0.5 * EVIDENCE_GLANCE_WIDE / EVIDENCE_GLANCE * place[2] + 2;
	const int x0 = (int)fmax(0, place[0] - reach), x1 = (int)fmin(photo->width, place[0] + reach), y0 = (int)fmax(0, place[1] - reach), y1 = (int)fmin(photo->height, place[1] + reach);
	for (int y = y0; y < y1; y++)
		for (long i = 3 * ((long)y * photo->width + x0); i < 3 * ((long)y * photo->width + x1); i++)
			photo->rgb[i] = (uint16_t)(257 * rgb[i]);
}

/* What the evidence tells of a frame's eyes. */
struct telling { struct eye_told told[SIDES]; const struct eye_told *known[SIDES]; double radius; };

static void tell(struct telling *t, const struct eye_frame *frame, const struct track_eyes *eyes)
{
	const struct track_subject *s = eyes->subject;
	*t = (struct telling){ .radius = 0 };
	for (int e = 0; e < SIDES; e++) {
		double place[3], from[2], to[2];
		if (!frame->evidence[e] || !iris_of(place, eyes, e, frame->cam_from_head) || !head_project(from, &eyes->clip->camera, frame->cam_from_head, s->opening[e].canthus[0])
		    || !head_project(to, &eyes->clip->camera, frame->cam_from_head, s->opening[e].canthus[1]))
			continue;
		const double wide = fmax(1e-9, hypot(to[0] - from[0], to[1] - from[1])), across[2] = { (to[0] - from[0]) / wide, (to[1] - from[1]) / wide };
		if (eye_told_of(&t->told[e], frame->evidence[e], place, across))
			t->known[e] = &t->told[e];
		t->radius = place[2];
	}
}

/* Fills the frame's evidence of the eyes that are in it, whose irises are small, or which may hold the head. */
static void look_at(struct eye_frame *frame, struct track_eyes *eyes, const bool in[SIDES])
{
	double place[SIDES][3];
	int side[SIDES], n = 0;
	struct evidence seen[SIDES];
	struct err none = { 0 };
	for (int e = 0; e < SIDES; e++) {
		evidence_free(&eyes->seen[e]);
		if (!eyes->net || !in[e] || !iris_of(place[n], eyes, e, frame->cam_from_head) || !(eyes->hold || place[n][2] < eyes->evidence_px))
			continue;
		fill_photo(&eyes->photo, frame->rgb, place[n]);
		side[n++] = e;
	}
	// a network that does not run says so where the reference is looked for
	if (!n || !evidence_glance(seen, n, (const double(*)[3])place, eyes->net, &eyes->photo, &none))
		return;
	for (int i = 0; i < n; i++) {
		eyes->seen[side[i]] = seen[i];
		frame->evidence[side[i]] = &eyes->seen[side[i]];
	}
}

/* Opens the network where the reference shows an iris that is small, or there is no mesh. */
static void begin_to_look(struct track_eyes *eyes)
{
	const struct video_info *info = &eyes->clip->info;
	struct err none = { 0 };
	bool wanted = eyes->subject->assumed && eyes->evidence_px > 0;
	for (int e = 0; e < SIDES; e++) {
		double place[3];
		wanted = wanted || (eyes->clip->eye_seen[e] && iris_of(place, eyes, e, eyes->clip->cam_from_head) && place[2] < eyes->evidence_px);
	}
	if (!wanted || !evidence_open_shipped(&eyes->net, &none))
		return;
	if (eyes->subject->assumed)
		eyes->hold = hold_new(eyes->clip, eyes->subject, eyes->evidence_px);
	eyes->photo = (struct photo){ .width = info->width, .height = info->height, .bits = 8, .rgb = mem_new(3 * (size_t)info->width * (size_t)info->height, sizeof *eyes->photo.rgb) };
}

/* Looks for the eyes in all of a frame. */
static void look_for(struct track_eyes *eyes, const struct video_frame *f)
{
	struct head_eyes found;
	struct err none = { 0 };
	video_frame_rgb(eyes->rgb, 3 * f->width, f, 0, 0, f->width, f->height);
	const bool any = head_propose(&found, eyes->net, eyes->rgb, f->width, f->height, &none);
	hold_found(eyes->hold, any ? (const double(*)[2])found.eye : 0);
}

/* The eyes that the evidence tells hold the head in the frame. f: null for the reference, which is no part of the clip. */
static void held(struct eye_frame *frame, struct track_eyes *eyes, const bool in[SIDES], const double skin_pose[4][4], const struct video_frame *f)
{
	struct telling t;
	const bool lost = f && eyes->clip->eye_seen[0] && eyes->clip->eye_seen[1] && hold_lost(eyes->hold);
	if (lost) {
		look_for(eyes, f);
		hold_guess(frame->cam_from_head, eyes->hold, skin_pose);
	}
	look_at(frame, eyes, lost ? eyes->clip->eye_seen : in);
	tell(&t, frame, eyes);
	hold_push(eyes->hold, t.known, t.radius, f ? fmax(0, frame->time - eyes->time) : 0, f);
	hold_guess(frame->cam_from_head, eyes->hold, skin_pose);
	eyes->time = frame->time;
}

struct track_eyes *track_eyes_new(const struct track_clip *clip, const struct track_subject *subject, struct bulk *bulk, const struct track_conf *conf)
{
	struct eye_scene scene = { .width = clip->info.width, .height = clip->info.height, .fps = clip->info.fps / (double)track_every(conf),
		                       .camera = clip->camera, .eye = conf->eye, .head_known = true,
		                       .head_sigma = { clip->turn_sigma[1], clip->turn_sigma[0] }, .bulk = bulk };
	struct eye_track_conf free_centers = conf->eyes;
	struct track_eyes *eyes = mem_new(1, sizeof *eyes);
	*eyes = (struct track_eyes){ .clip = clip, .subject = subject, .limbus = conf->eye.limbus_radius, .evidence_px = conf->eyes.evidence_px };
	begin_to_look(eyes);
	// eyes of an average face: a wider prior
	if (subject->assumed)
		free_centers.center_sigma = fmax(free_centers.center_sigma, conf->settle_sigma);
	for (int e = 0; e < SIDES; e++) {
		struct eye_prior *p = &scene.prior[e];
		p->absent = !clip->eye_seen[e];
		p->radius = subject->assumed ? conf->eyes.free_radius[0] : subject->radius;
		p->limbus = subject->limbus[e];
		p->average = subject->assumed;
		view_sigma(p->view_sigma, clip, subject, e, conf);
		// centres from capture.conf are as certain here as when the reference pose is refined by them
		p->center_sigma = subject->center_given[e] && !conf->limit ? fmin(conf->center_sigma, free_centers.center_sigma) : 0;
		if (subject->center_sigma[e] > 0)
			p->center_sigma = fmax(subject->center_sigma[e], free_centers.center_sigma);
		for (int k = 0; k < 3; k++) {
			p->limbus_px[k] = NAN;
			p->center_in_head[k] = subject->center[e][k];
			for (int c = 0; c < 2; c++)
				p->canthus_in_head[c][k] = !subject->opening[e].open ? NAN : subject->opening[e].canthus[c][k];
		}
	}
	eyes->track = eye_track_new(&scene, &free_centers);
	eyes->rgb = mem_new(3 * (size_t)clip->info.width * (size_t)clip->info.height, 1);
	// else the first frames are learnt from, which lowers the error of gaze by 0.4 degrees
	struct eye_frame frame = { .luma = clip->luma, .rgb = clip->rgb, .luma_stride = clip->info.width, .rgb_stride = 3 * clip->info.width };
	memcpy(frame.cam_from_head, clip->cam_from_head, sizeof frame.cam_from_head);
	if (eyes->hold)
		held(&frame, eyes, clip->eye_seen, clip->cam_from_head, 0);
	else
		look_at(&frame, eyes, clip->eye_seen);
	for (int e = 0; e < SIDES && clip->begins_shut; e++)
		if (clip->eye_seen[e])
			eye_track_learn(eyes->track, e, &frame);
	return eyes;
}

/* The part of the picture that eye_track reads: the opening and the skin that lids move over. Returns false when it is not in
 * the picture. */
static bool box_of(int box[4], const struct track_eyes *eyes, int side, const double pose[4][4])
{
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	const struct eye_opening *o = &eyes->subject->opening[side];
	for (int i = 0; i < OPENING_POINTS; i++) {
		double px[2];
		if (!o->open || !head_project(px, &eyes->clip->camera, pose, o->edge[i]))
			return false;
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], px[k]);
			high[k] = fmax(high[k], px[k]);
		}
	}
	double wide = high[0] - low[0], size[2] = { eyes->clip->info.width, eyes->clip->info.height };
	for (int k = 0; k < 2; k++) {
		box[k] = (int)fmax(0, fmin(size[k], low[k] - (k ? 0.4 : 0.3) * wide));
		box[2 + k] = (int)fmax(0, fmin(size[k], high[k] + (k ? 0.4 : 0.3) * wide));
	}
	return box[2] > box[0] && box[3] > box[1];
}

void track_eyes_push(struct track_eyes *eyes, const struct video_frame *f, const double skin_pose[4][4])
{
	double pose[4][4];
	memcpy(pose, skin_pose, sizeof pose);
	if (eyes->hold)
		hold_guess(pose, eyes->hold, skin_pose);
	struct eye_frame frame = { .luma = f->luma, .rgb = eyes->rgb, .luma_stride = f->luma_stride, .rgb_stride = 3 * f->width, .time = f->time };
	int box[SIDES][4];
	bool in[SIDES];
	for (int e = 0; e < SIDES; e++)
		in[e] = eyes->clip->eye_seen[e] && box_of(box[e], eyes, e, (const double(*)[4])pose);
	// boxes that share columns are filled one after the other
	const bool one_by_one = eyes->net || (in[0] && in[1] && !(box[SIDE_RIGHT][2] <= box[SIDE_LEFT][0] || box[SIDE_LEFT][2] <= box[SIDE_RIGHT][0]));
	for (int e = 0; e < SIDES && one_by_one; e++)
		if (in[e])
			video_frame_rgb(eyes->rgb, 3 * f->width, f, box[e][0], box[e][1], box[e][2], box[e][3]);
	memcpy(frame.cam_from_head, pose, sizeof frame.cam_from_head);
	if (eyes->hold)
		held(&frame, eyes, in, skin_pose, f);
	else
		look_at(&frame, eyes, in);
#pragma omp parallel for schedule(static, 1) num_threads(SIDES)
	for (int e = 0; e < SIDES; e++) {
		if (in[e] && !one_by_one)
			video_frame_rgb(eyes->rgb, 3 * f->width, f, box[e][0], box[e][1], box[e][2], box[e][3]);
		eye_track_push(eyes->track, e, &frame);
	}
}

void track_eyes_hold(struct track_result *r, struct track_eyes *eyes, const struct track_conf *conf)
{
	struct hold_known known;
	// the clip tells the eyeballs of large irises, if skin tells the path; those of small ones lie between the corners
	if (!eyes->hold || (hold_large(eyes->hold) && trust_skin_mm(r, eyes->clip, eyes->subject) < conf->held_skin))
		return;
	hold_settle(&known, r->pose, r->n, eyes->hold, r->rests);
	r->place_mm = known.place_mm;
	eye_track_held(eyes->track, conf->held_sigma, known.place_mm, known.turn);
}

bool track_eyes_finish(struct track_result *r, struct track_eyes *eyes, struct err *err)
{
	for (long f = 0; f < r->n && (r->n_points || r->place_mm > 0); f++)
		eye_track_head_was(eyes->track, f, r->pose[f]);
	bool ok = eye_track_finish(&r->eyes, eyes->track, err);
	r->has_eyes = ok && r->eyes.frames == r->n;
	bool *forgotten = mem_new((size_t)r->n + 1, sizeof *forgotten);
	for (long f = 0; f < r->n; f++)
		forgotten[f] = r->lost_at[f] || (r->unsure_at && r->unsure_at[f]);
	if (r->has_eyes)
		eye_clip_forget(&r->eyes, forgotten);
	free(forgotten);
	return ok;
}

void track_eyes_pack(struct pack *pack, struct track_eyes *eyes, long first)
{
	// beyond this frame's part of it an earlier frame's is left, and may be looked at
	pack_bytes(pack, eyes->rgb, 3 * (size_t)eyes->clip->info.width * (size_t)eyes->clip->info.height);
	eye_track_pack(pack, eyes->track, first);
	if (eyes->hold)
		hold_pack(pack, eyes->hold, first);
	PACK(pack, eyes->time);
}

void track_eyes_free(struct track_eyes *eyes)
{
	if (!eyes)
		return;
	eye_track_free(eyes->track);
	for (int e = 0; e < SIDES; e++)
		evidence_free(&eyes->seen[e]);
	evidence_close(eyes->net);
	hold_free(eyes->hold);
	free(eyes->photo.rgb);
	free(eyes->rgb);
	free(eyes);
}
