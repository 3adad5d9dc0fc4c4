/* follow_impl: what a clip is followed with, from frame to frame. */
#ifndef TRACK_CLIP_FOLLOW_IMPL_H
#define TRACK_CLIP_FOLLOW_IMPL_H
#include "track/clip/background.h"
#include "track/points/skin_track.h"

/* Points weigh in the head's pose by how rigidly they have moved with it: running mean of their squared residuals, px^2. */
struct rigid {
	int n;
	double *off2, *least;
	struct head_sight *sights;
};

struct follow {
	struct track_result *r;
	long room;                 // frames that its arrays have room for
	struct skin_track *skin;   // null without points
	struct rigid rigid;
	struct track_eyes *eyes;
	struct background *background;
	double pose[4][4];         // of the last frame
};

#endif
