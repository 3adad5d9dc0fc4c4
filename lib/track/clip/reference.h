/* reference: whether the frame that all others are compared with is a good one, by what frames spread over the clip show. */
#ifndef TRACK_CLIP_REFERENCE_H
#define TRACK_CLIP_REFERENCE_H
#include "track/clip/track.h"

/* A face that was taken the wrong way up: the lids that move are not the upper ones. */
bool reference_is_overturned(const struct track_result *few, const struct track_clip *clip, const struct track_subject *subject);

/* How a frame serves: with open eyes that look as they do most of the time. */
struct reference_view {
	bool open;
	double aside, up;      // degrees from the usual gaze, to the person's left, and up; NAN where it is not known
	long better;           // a frame that serves better by more than its own error; -1: none does
};

/* few: one frame in `every` was followed. */
struct reference_view reference_judge(const struct track_result *few, const struct track_clip *clip, long every);

/* The usual height of an eye's gaze in those frames, radians; NAN where none has any. */
double reference_usual_height(const struct track_result *few, int side);

/* Px that skin is usually off the head in those frames, at least a little; 0 where there is no skin. */
double reference_usual_misfit(const struct track_result *few);

/* The head's pose in the reference frame by the eyes' centres and the lids at rest that the frames followed show, into clip. doubted: the reference may be of
 * another expression than most frames. conf: that they were followed with. */
void reference_refine(struct track_clip *clip, bool doubted, const struct track_result *few, const struct track_subject *subject, const struct track_conf *conf);

#endif
