/* veil: what a drawn eye mirrors everywhere, over all of its iris: a reflection is what adds more than that. */
#ifndef EVIDENCE_VEIL_H
#define EVIDENCE_VEIL_H
#include "scene.h"

struct veil {
	float mirrored, iris;  // luminances, white is 1: the tenth of the eye that mirrors least; the iris' own, its median
	bool known;            // the iris shows
};

/* Of the eye whose limbus lies within a circle, px. */
struct veil veil_of(const struct drawn *drawn, double x, double y, double radius);

#endif
