/* events: blinks and saccades of a clip whose frames are not all to be trusted. */
#ifndef TRACK_EYE_EVENTS_H
#define TRACK_EYE_EVENTS_H
#include "track/eye/eye_track.h"

/* Forgets what was measured in frames in which the head's pose is not known: gaze, lids, saccades there, and blinks that one eye alone
 * shows: an eye looked for in the wrong place seems to shut, both at once hardly. forgotten: [frames]. */
void eye_clip_forget(struct eye_clip *clip, const bool *forgotten);

#endif
