/* propose: pairs of eyes in a picture, from the evidence of its pixels (limbus/evidence.h): where a head may be, and how it leans.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_HEAD_PROPOSE_H
#define TRACK_HEAD_PROPOSE_H
#include "limbus/evidence.h"

struct head_eyes {
	double eye[2][2];      // px, middles of the irises; [0] lies to the right in the picture: the left eye of an upright head
	double radius;         // px, of an iris: mean of both
	double score;          // 0..1, of the less certain one
	double open;           // area that shows between the lids of the less open one, in squares of the radius: 7 of an open eye, 0 of a shut one
};

/* The pair of irises that looks most like a person's: alike in size, apart as eyes are. rgb[height][3 width].
 * Returns false, eyes unchanged, where there is none, or err is set. */
bool head_propose(struct head_eyes *eyes, struct evidence_net *net, const uint8_t *rgb, int width, int height, struct err *err);

/* Two irises beside one or two that are known (px; NAN: not known), sure, alike in size, and of half to twice the known ones' radius: another face, or a mirror
 * image of this one. other: their middles, px. Returns false, other unchanged, where there are none, or err is set. */
bool head_propose_other(double other[2][2], const double known[2][2], double radius, struct evidence_net *net, const uint8_t *rgb, int width, int height, struct err *err);

#endif
