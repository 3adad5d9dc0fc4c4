/* expressions: strengths of capture.conf's expressions in every frame (skin paper, section 3.3: action units from sample
 * poses): how much of the skin's motion from the expression's neutral frame to its peak is in a frame, beside the motions of
 * gaze and blinks. */
#ifndef TRACK_CLIP_EXPRESSIONS_H
#define TRACK_CLIP_EXPRESSIONS_H
#include "track/clip/conf.h"
#include "track/clip/result.h"

struct stage;

/* Fills columns 10 .. 10 + n_au - 1 of result->g, 0..1; after track_apertures, which allocates g.
 * Returns false, err set, when an expression names a frame that the clip has not, or there are more than 24. */
bool track_expressions(struct track_result *result, struct stage *stage, const struct track_conf *conf, struct err *err);

#endif
