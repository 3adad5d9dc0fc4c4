#include "track/clip/eyes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/clip/glance.h"
#include "track/clip/hold.h"
#include "track/clip/trust.h"
#include "track/eye/events.h"

struct track_eyes {
	struct eye_track *track;
	const struct track_clip *clip;
	const struct track_subject *subject;
	uint8_t *rgb;          // [height][3 width]; only what lies round the eyes is filled
	struct glance *glance; // null: edges and colours alone tell the eyes
	struct hold *hold;     // null: skin alone tells the head's pose
	struct turn_net *turn; // with hold; null: cannot be opened, which the search for the reference reports
	double time, turned;   // of the last frame, and of the last one whose head's turn was looked at
};

static const double turn_s = 0.06;     // heads turn slowly: looked at no more often

/* Where the distance was assumed, the line of sight to an eye aside of the camera's axis is off in proportion to its angle. */
static void view_sigma(double sigma[2], const struct track_clip *clip, const struct track_subject *subject, int side, const struct track_conf *conf)
{
	double p[3];
	head_from(p, clip->cam_from_head, subject->center[side]);
	for (int k = 0; k < 2; k++)
		sigma[k] = subject->assumed && clip->focal_assumed ? conf->distance_sigma * fabs(p[k] / p[2]) : 0;
}

/* How the head is turned, from the face round both eyes that the evidence tells. f: as of held. */
static bool turned(struct head_turn *turn, struct track_eyes *eyes, const struct eye_frame *frame, const struct glance_told *t, const struct video_frame *f)
{
	const int width = eyes->clip->info.width, height = eyes->clip->info.height;
	struct err none = { 0 };
	double middle[SIDES][2];
	int box[4];
	for (int e = 0; e < SIDES; e++)
		for (int k = 0; k < 2; k++)
			middle[e][k] = !t->known[e] ? NAN : 0.5 * (t->told[e].corner[0][k] + t->told[e].corner[1][k]);
	if (!eyes->turn || (f && fabs(frame->time - eyes->turned) < turn_s) || !t->known[0] || !t->known[1] || !turn_reach(box, (const double(*)[2])middle, width, height))
		return false;
	if (f) {
		video_frame_rgb(eyes->rgb, 3 * width, f, box[0], box[1], box[2], box[3]);
		eyes->turned = frame->time;
	}
	return turn_see(turn, eyes->turn, frame->rgb, width, height, (const double(*)[2])middle, &none);
}

/* The eyes that the evidence tells hold the head in the frame. f: null for the reference, which is no part of the clip. */
static void held(struct eye_frame *frame, struct track_eyes *eyes, const bool in[SIDES], const double skin_pose[4][4], const struct video_frame *f)
{
	struct glance_told t;
	struct head_turn turn;
	const bool lost = f && eyes->clip->eye_seen[0] && eyes->clip->eye_seen[1] && hold_lost(eyes->hold);
	if (lost) {
		double eye[SIDES][2];
		video_frame_rgb(eyes->rgb, 3 * f->width, f, 0, 0, f->width, f->height);
		const bool any = glance_find(eye, eyes->glance, eyes->rgb);
		hold_found(eyes->hold, any ? (const double(*)[2])eye : 0);
		hold_guess(frame->cam_from_head, eyes->hold, skin_pose);
	}
	glance_at(frame, eyes->glance, lost ? eyes->clip->eye_seen : in);
	glance_tell(&t, frame, eyes->glance);
	hold_push(eyes->hold, t.known, turned(&turn, eyes, frame, &t, f) ? &turn : 0, t.radius, f ? fmax(0, frame->time - eyes->time) : 0, f);
	hold_keep(eyes->hold, frame->luma, frame->luma_stride);
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
	*eyes = (struct track_eyes){ .clip = clip, .subject = subject, .glance = glance_new(clip, subject, conf), .turned = -INFINITY };
	struct err none = { 0 };
	if (eyes->glance && subject->assumed) {
		eyes->hold = hold_new(clip, subject, conf->eyes.evidence_px);
		turn_open_shipped(&eyes->turn, &none);
	}
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
	else if (eyes->glance)
		glance_at(&frame, eyes->glance, clip->eye_seen);
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
	if (eyes->hold) {
		hold_carry(eyes->hold, f->luma, f->luma_stride);
		hold_guess(pose, eyes->hold, skin_pose);
	}
	struct eye_frame frame = { .luma = f->luma, .rgb = eyes->rgb, .luma_stride = f->luma_stride, .rgb_stride = 3 * f->width, .time = f->time };
	int box[SIDES][4];
	bool in[SIDES];
	for (int e = 0; e < SIDES; e++)
		in[e] = eyes->clip->eye_seen[e] && box_of(box[e], eyes, e, (const double(*)[4])pose);
	// boxes that share columns are filled one after the other
	const bool one_by_one = eyes->glance || (in[0] && in[1] && !(box[SIDE_RIGHT][2] <= box[SIDE_LEFT][0] || box[SIDE_LEFT][2] <= box[SIDE_RIGHT][0]));
	for (int e = 0; e < SIDES && one_by_one; e++)
		if (in[e])
			video_frame_rgb(eyes->rgb, 3 * f->width, f, box[e][0], box[e][1], box[e][2], box[e][3]);
	memcpy(frame.cam_from_head, pose, sizeof frame.cam_from_head);
	if (eyes->hold)
		held(&frame, eyes, in, skin_pose, f);
	else if (eyes->glance)
		glance_at(&frame, eyes->glance, in);
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
	r->unlike = eyes->hold ? hold_unlike(eyes->hold) : NAN;
	if (!eyes->hold)
		return;
	if (hold_large(eyes->hold) && trust_skin_mm(r, eyes->clip, eyes->subject) < conf->held_skin) {
		hold_turn(r->pose, r->n, eyes->hold);
		return;
	}
	hold_settle(&known, r->pose, r->n, eyes->hold, r->rests);
	r->place_mm = known.place_mm;
	// what the reference's own turn is known to is in all gaze
	double turn[TURNS], share = hold_turn_share(eyes->subject);
	for (int k = 0; k < TURNS; k++)
		turn[k] = sqrt(fmax(0, pow(share * known.turn[k], 2) - pow(eyes->clip->turn_sigma[k == TURN_ASIDE], 2)));
	eye_track_held(eyes->track, conf->held_sigma, known.place_mm, turn);
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
	PACK(pack, eyes->turned);
}

void track_eyes_free(struct track_eyes *eyes)
{
	if (!eyes)
		return;
	eye_track_free(eyes->track);
	glance_free(eyes->glance);
	hold_free(eyes->hold);
	turn_close(eyes->turn);
	free(eyes->rgb);
	free(eyes);
}
