/* film: small grey pictures of frames spread over the clip, and the contact sheet made of some of them. */
#ifndef TRACK_CLIP_FILM_H
#define TRACK_CLIP_FILM_H
#include "track/clip/track.h"

/* The part of the picture round the points and the eyes is kept, at most FILM_WIDTH wide, of at most FILM_MOST frames. */
struct film;
struct film *film_new(const struct track_clip *clip, const struct track_subject *subject, const struct track_points *points);
void film_add(struct film *film, const struct video_frame *frame);
void film_free(struct film *film);

/* The reference, blinks, peaks of expressions, the furthest gazes, others between, with margins, limbus and points drawn. */
bool film_sheet(const struct film *film, const char *path, const struct track_result *result, const struct track_clip *clip,
                const struct track_conf *conf, struct err *err);

#endif
