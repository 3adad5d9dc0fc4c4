/* moves: how the skin moves over a clip, seen quickly: few points in a picture of half the size, from the reference frame on and from there back to the
 * clip's beginning, before anything is known of the head's pose but where its eyes are.
 */
#ifndef TRACK_CLIP_MOVES_H
#define TRACK_CLIP_MOVES_H
#include "track/clip/clip.h"

#define MOVES_SIGMA_MOST 0.5  // degrees: standard deviation of a turn that is known

/* Follows points round the eyes through one in `every` of the clip's first `span` frames. moves: overwritten; track_moves_free in any case.
 * Returns false where there are too few points or frames. */
bool track_moves(struct track_moves *moves, long every, long span, const struct track_clip *clip, struct stage *stage, const struct track_subject *subject,
                 const struct track_conf *conf);
void track_moves_free(struct track_moves *moves);

/* Whether that skin stays where it is, but for lids and brows. */
bool track_moves_rest(const struct track_moves *moves, const struct track_clip *clip, const struct track_subject *subject);

/* Lays the mesh on the reference so that it moves as they do: sets the clip's pose. near: the pose is about right already. moves: known, turned, apart and torn
 * are set. Returns false, the clip unchanged, where the head turns too little to tell. */
bool track_moves_pose(struct track_clip *clip, struct track_moves *moves, const struct track_subject *subject, bool near, const struct track_conf *conf);

/* Of each frame whose pose is told, how far its skin round the eyes lies from where it lies in most of them about the rigid head: an expression; and a third of that of
 * its lids: a blink, a glance down. mm; three quarters of it lie nearer. off[moves->n_known] out; NAN where too little is seen. */
void track_moves_stirred(double *off, const struct track_moves *moves, const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf);

#endif
