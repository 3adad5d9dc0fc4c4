/* margin_seen: how the network's evidence (limbus/evidence.h) has the openings of both eyes in frames of a clip that has been followed.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_CLIP_MARGIN_SEEN_H
#define TRACK_CLIP_MARGIN_SEEN_H
#include "base/stage.h"
#include "track/clip/clip.h"
#include "track/clip/conf.h"

enum { MARGIN_SEEN_WIDE = 128, MARGIN_SEEN_HIGH = 80 };

struct margin_seen {
	bool known, ends;          // it was looked at; its corners are told
	float radius;              // px, of the iris
	float corner[2][2];        // px: where what shows of the eye ends, inner and outer (eye/told.h)
	float x0, y0, scale;       // px of the corner of `eye`, and of one of its pixels
	int width, height;
	uint8_t eye[MARGIN_SEEN_WIDE * MARGIN_SEEN_HIGH];  // [height][width] chance of eye, of 255
};

/* Looks at each frame of the result whose number `every` divides, where it has lids: seen[frame / every][SIDES], not known where it does not. */
bool margin_seen_all(struct margin_seen (*seen)[SIDES], const struct track_result *result, int every, struct stage *stage, const struct track_clip *clip,
                     const struct track_subject *subject, const struct track_conf *conf, struct err *err);

/* How far the edge of the eye lies from p in direction `out` (unit), px, the nearest within `reach` either way; NAN: there is none. */
double margin_seen_edge(const struct margin_seen *seen, const double p[2], const double out[2], double reach);

#endif
