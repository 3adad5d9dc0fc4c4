/* outlines: where the network's evidence (limbus/evidence.h) has the lids' margins, looked at in some frames a second while a clip is followed. */
#ifndef TRACK_CLIP_OUTLINES_H
#define TRACK_CLIP_OUTLINES_H
#include "base/pack.h"
#include "track/clip/clip.h"
#include "track/clip/conf.h"
#include "track/clip/result.h"

struct outlines;

/* clip, subject and bulk are borrowed until outlines_free. Null: they are not looked for, as settings say, without a mesh or in a clip that is only looked at, or the network cannot be run, which
 * track_canthi() reports. */
struct outlines *outlines_new(const struct track_clip *clip, const struct track_subject *subject, struct bulk *bulk, const struct track_conf *conf);

/* The next frame: looks at the eyes that are in the picture if it is time to. state: what eye_track_push() found. box: of each, first column and row, and those after the last, that
 * frame->rgb has been filled in. */
void outlines_push(struct outlines *outlines, const struct eye_frame *frame, const struct eye_state *const state[SIDES], const bool in[SIDES], const int box[SIDES][4]);

/* How far the eye is open, px: between the middles of its margins; 0 where it is shut. */
double outlines_gap(const struct eye_state *state);

/* After the last frame: hands what was found over to result. */
void outlines_give(struct track_result *result, struct outlines *outlines);

/* Their state after a push (base/pack.h). */
void outlines_pack(struct pack *pack, struct outlines *outlines);
void outlines_free(struct outlines *outlines);

#endif
