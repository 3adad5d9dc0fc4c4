#include "track/clip/alone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/clip/earn.h"
#include "track/clip/few.h"
#include "track/clip/hold.h"
#include "track/clip/look.h"
#include "track/clip/reference.h"
#include "track/head/refine.h"
#include "track/head/turn.h"

enum { ROUNDS = 3, LEAST_FRAMES = 8 };
static const double STILL_MM = 0.3;  // a centre that moves less has been found

/* The openings about eyes that look aside: found again from the irises. */
static bool lay(struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	struct head_found found = { .seen = { true, true } };
	if (clip->focal_assumed)
		track_look_distance(clip, s, conf);
	memcpy(found.cam_from_head, clip->cam_from_head, sizeof found.cam_from_head);
	if (!head_find_refine(&found, clip->rgb, clip->info.width, clip->info.height, &clip->camera, s->opening, &conf->head))
		return false;
	memcpy(clip->cam_from_head, found.cam_from_head, sizeof clip->cam_from_head);
	clip->pose_px = found.edge_px;
	clip->pose_refined = false;
	return true;
}

static bool start(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	if (conf->reference >= 0)
		return true;
	struct track_clip was = *clip;
	const size_t area = (size_t)clip->info.width * (size_t)clip->info.height;
	clip->luma = mem_array(area + 1, 1);
	clip->rgb = mem_array(3 * area + 1, 1);
	memcpy(clip->luma, was.luma, area);
	memcpy(clip->rgb, was.rgb, 3 * area);
	const bool ok = track_propose(clip, stage, s, conf, err) && lay(clip, s, conf);
	struct track_clip *drop = ok ? &was : clip;
	free(drop->luma);
	free(drop->rgb);
	if (ok)
		clip->begins_shut = true;
	else
		*clip = was;
	return !err_is(err);
}

static double apart(const double px[SIDES][2])
{
	return hypot(px[0][0] - px[1][0], px[0][1] - px[1][1]);
}

/* Outlines of average lids do not tell how a head is turned: the face does. The average eyes, so turned, are laid where theirs are seen. */
static void face_told(struct track_clip *clip, const struct track_subject *s, const struct head_turn *turn, const double seen[SIDES][2])
{
	const double lean = atan2(seen[SIDE_LEFT][1] - seen[SIDE_RIGHT][1], seen[SIDE_LEFT][0] - seen[SIDE_RIGHT][0]);
	double between[3], at[3], ray[3], m[3][3];
	track_eyes_between(between, s);
	head_from(at, clip->cam_from_head, between);
	camera_ray(ray, &clip->camera, (double[2]){ 0.5 * (seen[0][0] + seen[1][0]), 0.5 * (seen[0][1] + seen[1][1]) });
	turn_rotation(m, turn->angle, lean, ray);
	double z = at[2];
	for (int round = 0; round < ROUNDS; round++) {
		double now[SIDES][2];
		for (int i = 0; i < 3; i++) {
			memcpy(clip->cam_from_head[i], m[i], sizeof m[i]);
			clip->cam_from_head[i][3] = ray[i] / ray[2] * z - (m[i][0] * between[0] + m[i][1] * between[1] + m[i][2] * between[2]);
		}
		if (!track_eyes_middle(now, &clip->camera, (const double(*)[4])clip->cam_from_head, s))
			return;
		z *= apart((const double(*)[2])now) / apart(seen);
	}
	clip->turn_sigma[0] = hold_turn_share(s) * turn->sigma[TURN_NOD];
	clip->turn_sigma[1] = hold_turn_share(s) * turn->sigma[TURN_ASIDE];
}

static void turn_point(double v[3], const double by[3][3])
{
	const double x[3] = { v[0], v[1], v[2] };
	for (int i = 0; i < 3; i++)
		v[i] = by[i][0] * x[0] + by[i][1] * x[1] + by[i][2] * x[2];
}

static void turn_opening(struct eye_opening *o, const double by[3][3])
{
	for (int i = 0; i < OPENING_POINTS; i++)
		turn_point(o->edge[i], by);
	for (int c = 0; c < 2; c++)
		turn_point(o->canthus[c], by);
	turn_point(o->center, by);
}

/* One eye: takes the camera's axes, rolled as the eyes lie, for the head's; what is known of the eye stays where it is seen. */
static void face_camera(struct track_clip *clip, struct track_subject *s)
{
	const double roll = atan2(clip->cam_from_head[1][0], clip->cam_from_head[0][0]), c = cos(roll), d = sin(roll);
	const double faces[3][3] = { { c, d, 0 }, { d, -c, 0 }, { 0, 0, -1 } };
	double by[3][3];
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++) {
			by[i][k] = 0;
			for (int m = 0; m < 3; m++)
				by[i][k] += faces[m][i] * clip->cam_from_head[m][k];
		}
	for (int i = 0; i < 3; i++)
		memcpy(clip->cam_from_head[i], faces[i], sizeof faces[i]);
	for (int i = 0; i < s->mesh.n_vertices; i++) {
		double v[3] = { s->mesh.vertices[i][0], s->mesh.vertices[i][1], s->mesh.vertices[i][2] };
		turn_point(v, by);
		for (int k = 0; k < 3; k++)
			s->mesh.vertices[i][k] = (float)v[k];
	}
	for (int e = 0; e < SIDES; e++) {
		turn_point(s->center[e], by);
		turn_opening(&s->opening[e], by);
		turn_opening(&s->margin[e], by);
	}
}

/* The same eyes the other way up: turned by half a turn about what is seen of them. */
static void turn_over(struct track_clip *clip, const struct track_subject *s)
{
	double middle[3] = { 0 }, was[3], now[3];
	const int n = clip->eye_seen[0] + clip->eye_seen[1];
	for (int e = 0; e < SIDES; e++)
		for (int k = 0; k < 3 && clip->eye_seen[e]; k++)
			middle[k] += s->center[e][k] / n;
	head_from(was, clip->cam_from_head, middle);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 2; k++)
			clip->cam_from_head[i][k] *= -1;
	head_from(now, clip->cam_from_head, middle);
	for (int i = 0; i < 3; i++)
		clip->cam_from_head[i][3] += was[i] - now[i];
}

/* Lids tell which way up a face is: of an open eye that blinks and looks up and down the upper one moves by far more. Films are upright where they do not tell. */
static void stand_up(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	const struct track_conf few = track_few_of(conf, clip, conf->doubt.frames, conf->doubt.span);
	struct track_result up = { 0 }, over = { 0 };
	if (track_follow_few(&up, clip, stage, s, &few) && reference_is_overturned(&up, clip, s)) {
		turn_over(clip, s);
		if (!track_follow_few(&over, clip, stage, s, &few) || reference_is_overturned(&over, clip, s))
			turn_over(clip, s);
	}
	track_result_free(&up);
	track_result_free(&over);
}

/* Where the eyeballs lie, and how large the irises are by the average face's scale, from few frames: under centres that are off by millimetres irises that look aside
 * are not found, nor those that are larger by a tenth. */
static void center(struct track_clip *clip, struct stage *stage, struct track_subject *s, const struct track_conf *conf)
{
	const struct track_conf few = track_few_of(conf, clip, conf->doubt.frames, conf->doubt.span);
	for (int round = 0; round < ROUNDS; round++) {
		struct track_result r = { 0 };
		double moved = 0;
		const bool ok = track_follow_few(&r, clip, stage, s, &few) && r.has_eyes;
		for (int e = 0; e < SIDES && ok; e++) {
			const struct eye_globe *g = &r.eyes.globe[e];
			if (!g->seen || g->frames < LEAST_FRAMES)
				continue;
			moved = fmax(moved, fabs(g->limbus_radius - (s->limbus[e] > 0 ? s->limbus[e] : conf->eye.limbus_radius)));
			s->limbus[e] = g->limbus_radius;
			for (int k = 0; k < 2 && !(r.place_mm > 0); k++) {
				moved = fmax(moved, fabs(g->center_in_head[k] - s->center[e][k]));
				s->center[e][k] = g->center_in_head[k];
			}
		}
		track_result_free(&r);
		if (moved < STILL_MM)
			return;
	}
}

static bool face(struct track_clip *clip, struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	double seen[SIDES][2];
	if (!clip->eye_seen[0] || !clip->eye_seen[1] || !clip->rgb || !track_eyes_middle(seen, &clip->camera, (const double(*)[4])clip->cam_from_head, s)) {
		face_camera(clip, s);
		return true;
	}
	struct turn_net *net;
	struct head_turn turn;
	if (!turn_open_shipped(&net, err))
		return false;
	const bool ok = turn_see(&turn, net, clip->rgb, clip->info.width, clip->info.height, (const double(*)[2])seen, err);
	turn_close(net);
	if (ok) {
		face_told(clip, s, &turn, (const double(*)[2])seen);
		if (clip->focal_assumed)
			track_look_distance(clip, s, conf);
	}
	return ok;
}

bool track_alone(struct track_clip *clip, struct stage *stage, struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	if (!start(clip, stage, s, conf, err))
		return false;
	if (conf->alone == SHOWN_BOTH && !(clip->eye_seen[0] && clip->eye_seen[1]))
		return err_set(err, "%s: frame %ld: one eye alone is found, and a picture of it does not tell which: film both eyes, or set track.shown = left or right (the person's) in capture.conf", clip->file,
		               clip->reference);
	if (conf->settle)
		stand_up(clip, stage, s, conf);
	if (!face(clip, s, conf, err))
		return false;
	if (conf->settle)
		center(clip, stage, s, conf);
	return true;
}
