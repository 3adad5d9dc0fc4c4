/* cover: which arcs of the limbus are visible, and which lie against skin. */
#ifndef LIMBUS_COVER_H
#define LIMBUS_COVER_H
#include "limbus/rim.h"

// Arcs whose outside is less white than this share of the ring's whiter part lie against skin.
static const double RIM_WHITE = 0.35;

/* Whiteness of what lies outside each arc, relative to the whiter arcs of the ring.
 * white  out
 * tint   pyramid.tint; null: all are 1 */
void rim_tint(double white[ARCS], const struct ring *ring, const struct grey *tint, bool absolute);

/* Sets rim->seen and rim->coverage, the share of the ring that shows iris against sclera. An arc is seen where it is used or is
 * brighter outside than inside by a good part of the typical step. Short gaps (a streak, a vein, a lash) are closed, isolated arcs
 * removed. width, height: of the photograph, px. */
void rim_cover(struct rim *rim, const struct grey *grey, const struct grey *tint, bool absolute, int width, int height);

#endif
