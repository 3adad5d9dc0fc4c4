/* background: a thread that works on frames whose head pose is known (eyes, contact sheet, wrinkles), while the skin of the
 * next frames is followed. */
#ifndef TRACK_CLIP_BACKGROUND_H
#define TRACK_CLIP_BACKGROUND_H
#include "track/clip/eyes.h"
#include "track/clip/film.h"
#include "track/clip/folds.h"

struct background;

/* film, folds: may be null. None of the three may be used by others before background_end. Where no thread can be started, the
 * work is done in background_push. */
struct background *background_new(struct track_eyes *eyes, struct film *film, struct folds *folds);

/* Takes over a frame, which is emptied; waits while four are under way. Frames in order. */
void background_push(struct background *background, struct video_frame *frame, const double cam_from_head[4][4]);

/* Waits for the last frame that was pushed: until the next one eyes, film and folds may be used by the caller. */
void background_wait(struct background *background);

/* Waits for the last frame; frees background. */
void background_end(struct background *background);

#endif
