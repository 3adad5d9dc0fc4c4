/* alone: a clip without a mesh of the person: where its eyes are, and the frame that gaze is told in.
 */
#ifndef TRACK_CLIP_ALONE_H
#define TRACK_CLIP_ALONE_H
#include "track/clip/clip.h"

/* Lays an average face on the pair of eyes that the evidence shows best in frames spread over the clip, and refines it by their openings: size and lean as
 * they are, both eyes in the picture. Sets reference, its picture, pose and, where focal_assumed, the focal length; where no frame shows two eyes, or
 * conf->reference names one, they are left as they were. The lids' motion tells which way up the face is. Then few frames tell where the eyeballs lie: subject's centres are moved there. How the head is
 * turned its face tells (head/turn.h); where one eye alone is seen, the head's frame is the camera's at the reference, rolled as the eye lies.
 * Returns false, err set, where one eye alone is found and conf->alone does not tell which, or the evidence's network cannot be read. */
bool track_alone(struct track_clip *clip, struct stage *stage, struct track_subject *subject, const struct track_conf *conf, struct err *err);

#endif
