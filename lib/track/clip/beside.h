/* beside: how the skin beside given places of the mesh moves relative to the rigid head, frame by frame, so that places that
 * are hard to see are carried by skin that is seen well. */
#ifndef TRACK_CLIP_BESIDE_H
#define TRACK_CLIP_BESIDE_H
#include "track/clip/points.h"
#include "track/clip/result.h"

struct beside {
	int n;                 // places
	long frames;
	double (*moved)[2];    // [n][frames] px: off where the rigid head would take them; 0 for the mesh's face at rest
	double *weight;        // [n][frames] how much skin was seen there, 0..1; 0: interpolated
	struct bulk *bulk;     // result's, where both lie
};

/* head: n places in the head frame, mm, in a row from one corner of an eye to the other; their distance scales how far away skin
 * counts. Frames in which too little skin is seen are interpolated. beside_free. */
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
