/* earn: a reference frame and the head's pose in it, by evidence from many frames: eyes proposed by the network, the most frontal and open of the frames,
 * and the mesh laid on it so that the skin moves with it as with a rigid body.
 */
#ifndef TRACK_CLIP_EARN_H
#define TRACK_CLIP_EARN_H
#include "track/clip/subject.h"

struct track_clip;

/* Sets the clip's reference, its picture, its pose with sigmas, and how its skin begins. Returns false, nothing changed, where no frame shows two eyes, where
 * the head rests, and, err set, where the network cannot be read. */
bool track_earn(struct track_clip *clip, struct stage *stage, const struct track_subject *subject, const struct track_conf *conf, struct err *err);

/* Sets the clip's reference, its picture and a rough pose: a head that faces the camera, laid on the pair of eyes that the evidence shows best. The
 * clip's pictures are written to. Returns false, nothing changed, where no frame shows two eyes, and, err set, where the network cannot be read. */
bool track_propose(struct track_clip *clip, struct stage *stage, const struct track_subject *subject, const struct track_conf *conf, struct err *err);

#endif
