/* eyes: feeds eye_track (track/eye/eye_track.h) from the pipeline: gaze and lids of every frame. */
#ifndef TRACK_CLIP_EYES_H
#define TRACK_CLIP_EYES_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

struct track_eyes;

/* clip, subject and bulk (eye_scene's) are borrowed until track_eyes_free. */
struct track_eyes *track_eyes_new(const struct track_clip *clip, const struct track_subject *subject, struct bulk *bulk, const struct track_conf *conf);

/* The next frame, and the head's pose in it. */
void track_eyes_push(struct track_eyes *eyes, const struct video_frame *frame, const double cam_from_head[4][4]);

/* After the last frame, when the skin has told the head's path: where there is no mesh, and irises are small (evidence_px) or the skin does not lie on the head so
 * followed (held_skin_mm), the eyes hold it (hold.h):
 * sets result's poses and place_mm. */
void track_eyes_hold(struct track_result *result, struct track_eyes *eyes, const struct track_conf *conf);

/* Clip-wide fit with result's final poses; fills result's eyes and has_eyes, NAN in frames that are lost.
 * Returns false, err set, when no eye was found in any frame. */
bool track_eyes_finish(struct track_result *result, struct track_eyes *eyes, struct err *err);

/* eye_track_pack() of them. */
void track_eyes_pack(struct pack *pack, struct track_eyes *eyes, long first);
void track_eyes_free(struct track_eyes *eyes);

#endif
