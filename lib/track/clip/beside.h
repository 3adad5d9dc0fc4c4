/* beside: how the skin beside places of the mesh moves on its own, frame by frame, so that what cannot be seen well is carried by
 * what can. */
#ifndef TRACK_CLIP_BESIDE_H
#define TRACK_CLIP_BESIDE_H
#include "track/clip/track.h"

struct beside {
	int n;                 // places
	long frames;
	double (*moved)[2];    // [n][frames] px: off where the head alone would take them, the mesh's face at rest being 0
	double *weight;        // [n][frames] how much skin told of it, 0..1
};

/* Places of the head frame, mm, in a row from one corner of an eye to the other, which tells how far skin beside them is asked. Frames
 * in which too little of it is seen are filled in between the others. */
struct beside beside_new(int n, const double (*head)[3], const struct track_result *result, int side, const struct track_clip *clip,
                         const struct track_points *points);
void beside_free(struct beside *beside);

static inline const double *beside_moved(const struct beside *b, int place, long frame)
{
	return b->moved[place * b->frames + frame];
}

static inline double beside_weight(const struct beside *b, int place, long frame)
{
	return b->weight[place * b->frames + frame];
}

#endif
