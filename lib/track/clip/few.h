/* few: a clip followed quickly, in frames spread over it, to judge a reference and what is assumed of the eyes. */
#ifndef TRACK_CLIP_FEW_H
#define TRACK_CLIP_FEW_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Settings for looking at so many frames, spread over the time of so many at 60 a second: the eyeballs' centres free. */
struct track_conf track_few_of(const struct track_conf *conf, const struct track_clip *clip, int frames, long span);

/* Follows the clip so, from the reference and back. result: overwritten; track_result_free in any case. Returns false where it cannot be followed: errors
 * are reported when the whole clip is. */
bool track_follow_few(struct track_result *result, const struct track_clip *clip, struct stage *stage, const struct track_subject *subject, const struct track_conf *few);

#endif
