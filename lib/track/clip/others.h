/* others: faces besides the one that is followed. */
#ifndef TRACK_CLIP_OTHERS_H
#define TRACK_CLIP_OTHERS_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Whether the reference shows that face's eyes alone. A second face may be the person's that the mesh is of, and a mirror image of a face exchanges left and right:
 * which one is followed is not left to chance. Returns false, err set, where two more irises are seen for sure, of about the size that the pose says, or the network
 * cannot be read. */
bool track_alone_in_it(const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf, struct err *err);

/* The same in a few frames that were followed, decoded once more: for a clip that is refused, which may be so for that. */
bool track_alone_through(const struct track_result *result, struct stage *stage, const struct track_clip *clip, const struct track_subject *subject,
                         const struct track_conf *conf, struct err *err);

#endif
