/* behind: what is done with a frame once it is known where the head is in it goes on in a thread of its own, while the skin of the
 * next frames is followed. */
#ifndef TRACK_CLIP_BEHIND_H
#define TRACK_CLIP_BEHIND_H
#include "track/clip/film.h"
#include "track/clip/folds.h"

struct behind;

/* film, folds: may be null. None of the three is to be touched before behind_end. */
struct behind *behind_new(struct track_eyes *eyes, struct film *film, struct folds *folds);

/* Takes the frame over; waits while too many are under way. Frames in order. */
void behind_push(struct behind *behind, struct video_frame *frame, const double cam_from_head[4][4]);

/* Waits for the last frame. */
void behind_end(struct behind *behind);

#endif
