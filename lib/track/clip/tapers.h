/* tapers: whether what was taken for an open eye has an eye's shape: openings taper to their outer corner. What lies on the lid (its shade, lashes) and is told for eye where eyes look far
 * aside lifts the margin there.
 */
#ifndef TRACK_CLIP_TAPERS_H
#define TRACK_CLIP_TAPERS_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Forgets the lids of an eye in the frames in which they do not taper: points NAN, confidence 0. With a mesh, whose corners give the shape (corners.h), and where the eye is half shut,
 * nothing changes. */
void track_tapers(struct track_result *result, const struct track_subject *subject);

#endif
