/* look: the head's pose in the reference frame, from the eyes that it shows. */
#ifndef TRACK_CLIP_LOOK_H
#define TRACK_CLIP_LOOK_H
#include "track/clip/clip.h"

/* Way up of the head: upright, upside down, or whichever fits better. */
enum track_way { WAY_EITHER, WAY_UP, WAY_OVER };

/* Finds the head in clip->luma and rgb: by a face detector, else by the openings of its eyes. Sets cam_from_head, eye_seen,
 * pose_px and, where focal_assumed, the focal length. Returns false when no eyes are found; clip is as it was then. */
bool track_look(struct track_clip *clip, enum track_way way, const struct track_subject *subject, const struct track_conf *conf);

/* Unknown focal length: scales it so that the eyes are conf->distance_mm away. */
void track_look_distance(struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf);

/* Takes the pose that calibrate has estimated for a frame, which must be the one in clip->rgb.
 * Returns false when there is none, or no open eyes are seen there. */
bool track_look_known(struct track_clip *clip, long frame, const struct track_subject *subject, const struct track_conf *conf);

#endif
