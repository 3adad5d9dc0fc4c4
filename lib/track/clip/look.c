#include "track/clip/look.h"

#include <string.h>

#include "bridge/cv_face.h"
#include "track/head/refine.h"

void track_look_distance(struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	const double depth = track_eyes_depth(clip->cam_from_head, s);
	clip->camera.focal_px *= conf->distance_mm / depth;
	clip->cam_from_head[2][3] += conf->distance_mm - depth;
}

/* Detects a whole, upright face in the reference frame; close-ups show none. */
static bool look_for_face(struct cv_face *face, struct track_clip *clip)
{
	struct err none = { 0 };
	int n = 0;
	return (clip->faces || cv_face_open(&clip->faces, &none))
	       && cv_face_find(&n, face, 1, clip->faces, clip->luma, clip->info.width, clip->info.height, 0, &none) && n > 0;
}

/* Finds the head one way up, or from the eyes of a detected face, in the reference frame. */
static bool look_so(struct head_found *found, struct track_clip *clip, enum track_way way, const struct cv_face *face, const struct track_subject *s,
                    const struct track_conf *conf)
{
	int w = clip->info.width, h = clip->info.height;
	if (face ? !head_find_from_eyes(found, face->eye, &clip->camera, s->opening)
	         : !head_find(found, clip->rgb, w, h, &clip->camera, s->opening, way == WAY_OVER, &conf->head))
		return false;
	memcpy(clip->cam_from_head, found->cam_from_head, sizeof clip->cam_from_head);
	if (clip->focal_assumed) {
		track_look_distance(clip, s, conf);
		memcpy(found->cam_from_head, clip->cam_from_head, sizeof clip->cam_from_head);
	}
	return head_find_refine(found, clip->rgb, w, h, &clip->camera, s->opening, &conf->head);
}

/* True when the upright pose is kept. Openings look much the same upside down, and eyes that look up or down change their
 * shape: the inverted pose is accepted only where its openings have more contrast, their outlines fit better, and as many of
 * them are seen. */
static bool stands(const struct head_found *up, const struct head_found *over)
{
	return up->score >= over->score || up->edge_px <= over->edge_px || up->seen[0] + up->seen[1] > over->seen[0] + over->seen[1];
}

bool track_look(struct track_clip *clip, enum track_way way, const struct track_subject *s, const struct track_conf *conf)
{
	struct head_found up, over;
	struct camera camera = clip->camera, upright;
	struct cv_face face;
	double was[4][4];
	memcpy(was, clip->cam_from_head, sizeof was);
	bool is_face = way != WAY_OVER && look_for_face(&face, clip) && look_so(&up, clip, WAY_UP, &face, s, conf), is_up = is_face;
	if (!is_face && way != WAY_OVER) {
		clip->camera = camera;
		is_up = look_so(&up, clip, WAY_UP, 0, s, conf);
	}
	upright = clip->camera;
	clip->camera = camera;
	bool is_over = !is_face && way != WAY_UP && look_so(&over, clip, WAY_OVER, 0, s, conf) && !(is_up && stands(&up, &over));
	if (!is_up && !is_over) {
		memcpy(clip->cam_from_head, was, sizeof was);
		return false;
	}
	if (!is_over)
		clip->camera = upright;
	const struct head_found *found = is_over ? &over : &up;
	memcpy(clip->cam_from_head, found->cam_from_head, sizeof clip->cam_from_head);
	memcpy(clip->eye_seen, found->seen, sizeof clip->eye_seen);
	clip->pose_px = found->edge_px;
	clip->pose_refined = false;
	return true;
}

bool track_look_known(struct track_clip *clip, long frame, const struct track_subject *s, const struct track_conf *conf)
{
	for (int i = 0; i < clip->n_known; i++) {
		const struct track_known *k = &clip->known[i];
		struct head_found found = { .seen = { s->opening[0].open, s->opening[1].open } };
		if (k->frame != frame)
			continue;
		memcpy(found.cam_from_head, k->cam_from_head, sizeof found.cam_from_head);
		if (!head_find_refine(&found, clip->rgb, clip->info.width, clip->info.height, &clip->camera, s->opening, &conf->head))
			return false;
		memcpy(clip->cam_from_head, k->cam_from_head, sizeof clip->cam_from_head);
		memcpy(clip->eye_seen, found.seen, sizeof clip->eye_seen);
		clip->pose_px = k->residual_px;
		return clip->pose_given = true;
	}
	return false;
}
