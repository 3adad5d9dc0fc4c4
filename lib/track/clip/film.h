/* film: small grey pictures of frames spread over the clip, kept while it is followed, for a contact sheet. */
#ifndef TRACK_CLIP_FILM_H
#define TRACK_CLIP_FILM_H
#include "base/pack.h"
#include "track/clip/points.h"

enum { FILM_WIDTH = 640, FILM_MOST = 200 };

/* The part of the picture round the points and the eyes, at most FILM_WIDTH wide, of at most FILM_MOST frames. */
struct film {
	int x0, y0, step;              // first pixel of the part that is kept; pixels averaged each way
	int width, height;             // of a small picture
	int every, n;                  // one frame in so many; kept
	long frame[FILM_MOST];
	uint8_t *px[FILM_MOST];        // [height][width]; owned
};

struct film *film_new(const struct track_clip *clip, const struct track_subject *subject, const struct track_points *points);

/* Keeps a frame whose turn it is; when full, drops every other one. */
void film_add(struct film *film, const struct video_frame *frame);

/* Its state (base/pack.h), and the pictures of frames from `first` on. Read into a film that has those before. */
void film_pack(struct pack *pack, struct film *film, long first);
void film_free(struct film *film);

#endif
