/* portrait: what photographs of people show and drawn eyes show too seldom: irises that are nearly black, eyes far aside, sclera in the shadow of
 * lids and in dark corners, lids made up and lashes that join the iris, skin with pores and lines.
 */
#ifndef EVIDENCE_PORTRAIT_H
#define EVIDENCE_PORTRAIT_H
#include "scene_impl.h"

/* Changes what a set shows, by numbers of its own. Not the eyes' gaze, which the lids follow. */
void portrait_make(struct set *set, struct rng *rng);

#endif
