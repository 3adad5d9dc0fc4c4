/* refine: the head's pose in the reference frame, refined by the eyeballs' centres of rotation and the lids at rest. The
 * centres lie 12 mm behind
 * the lids: a head that is turned wrongly has them beside where the lids' outlines want them. */
#ifndef TRACK_CLIP_REFINE_H
#define TRACK_CLIP_REFINE_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* clip: cam_from_head and pose_px are replaced; left as they are where too few centres or margins are known.
 * few, conf: frames that were followed, and the settings they were followed with.
 * doubted: the reference may show another expression than most frames; lids at rest are then estimated at the clip's median
 * gaze from frames whose skin fits the rigid head. */
void reference_refine(struct track_clip *clip, bool doubted, const struct track_result *few, const struct track_subject *subject, const struct track_conf *conf);

/* Sets clip->lens from the whole clip, followed under the lens told: from the centres that the eyes turned about, without what was told of them, and the lids at rest.
 * Nothing is known of it without a mesh and both eyes. */
void reference_lens(struct track_clip *clip, const struct track_result *result, const struct track_subject *subject, const struct track_conf *conf);

#endif
