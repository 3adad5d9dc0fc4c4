#include "track/clip/alone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/clip/earn.h"
#include "track/clip/few.h"
#include "track/clip/look.h"
#include "track/clip/reference.h"
#include "track/head/refine.h"

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

static void turn(double v[3], const double by[3][3])
{
	const double x[3] = { v[0], v[1], v[2] };
	for (int i = 0; i < 3; i++)
		v[i] = by[i][0] * x[0] + by[i][1] * x[1] + by[i][2] * x[2];
}

static void turn_opening(struct eye_opening *o, const double by[3][3])
{
	for (int i = 0; i < OPENING_POINTS; i++)
		turn(o->edge[i], by);
	for (int c = 0; c < 2; c++)
		turn(o->canthus[c], by);
	turn(o->center, by);
}

/* Takes the camera's axes, rolled as the eyes lie, for the head's; what is known of the eyes stays where it is seen. */
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
		turn(v, by);
		for (int k = 0; k < 3; k++)
			s->mesh.vertices[i][k] = (float)v[k];
	}
	for (int e = 0; e < SIDES; e++) {
		turn(s->center[e], by);
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

bool track_alone(struct track_clip *clip, struct stage *stage, struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	if (!start(clip, stage, s, conf, err))
		return false;
	if (conf->alone == SHOWN_BOTH && !(clip->eye_seen[0] && clip->eye_seen[1]))
		return err_set(err, "%s: frame %ld: one eye alone is found, and a picture of it does not tell which: film both eyes, or set track.shown = left or right (the person's) in capture.conf", clip->file,
		               clip->reference);
	if (conf->settle)
		stand_up(clip, stage, s, conf);
	face_camera(clip, s);
	if (conf->settle)
		center(clip, stage, s, conf);
	return true;
}
