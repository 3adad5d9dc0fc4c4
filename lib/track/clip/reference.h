/* reference: whether the reference frame is a good one, judged by frames spread over the clip. */
#ifndef TRACK_CLIP_REFERENCE_H
#define TRACK_CLIP_REFERENCE_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* True when the head was fitted upside down: the lower lids of the fit move more than the upper ones. */
bool reference_is_overturned(const struct track_result *few, const struct track_clip *clip, const struct track_subject *subject);

/* A good reference frame has open eyes and a gaze near the clip's median. */
struct reference_view {
	bool open;
	double aside, up;      // degrees from the median gaze, to the person's left, and up; NAN where it is not known
	long better;           // a frame that is better by more than the error of the comparison; -1: none is
};

/* few: one frame in `every` was followed. */
struct reference_view reference_judge(const struct track_result *few, const struct track_clip *clip, long every);

/* Median vertical gaze of an open eye in those frames, radians; NAN where it is open in none. */
double reference_usual_height(const struct track_result *few, int side);

/* Median over those frames of the skin's misfit against the rigid head, px, at least 1e-3; 0 where there is no skin. */
double reference_usual_misfit(const struct track_result *few);

#endif
