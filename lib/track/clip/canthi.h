/* canthi: where the corners of the eyes and the lids' margins lie in the reference frame. The mesh's are those of a neutral face: an expression, or eyes that look aside, moves
 * them by a millimetre or two against it. */
#ifndef TRACK_CLIP_CANTHI_H
#define TRACK_CLIP_CANTHI_H
#include "track/clip/clip.h"
#include "track/clip/conf.h"

/* Moves the corners of the subject's openings, and its margins, to where the network's evidence (limbus/evidence.h) has the openings in the clip's reference frame, as far as
 * that is surer. The pose must be known. Without a mesh, or where no eye shows, nothing changes. False, err set: the network cannot be run. */
bool track_canthi(struct track_subject *subject, const struct track_clip *clip, const struct track_conf *conf, struct err *err);

#endif
