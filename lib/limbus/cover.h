/* limbus_cover: which part of the limbus is in sight. */
#ifndef LIMBUS_COVER_H
#define LIMBUS_COVER_H
#include "limbus/rim.h"

// Arcs less white outside than this share of the ring's whiter part lie against skin.
static const double RIM_WHITE = 0.35;

/* Tint of what lies outside each arc, against the whiter arcs of the ring; 1 where tint is null. */
void rim_tint(double white[ARCS], const struct ring *ring, const struct grey *tint);

/* Sets rim->seen and rim->coverage, the share of the ring that shows iris against sclera: brighter outside than inside
 * by a good part of what is typical, or used; short gaps (a streak, a vein, a lash) are bridged, lone arcs are not
 * believed. */
void rim_cover(struct rim *rim, const struct grey *grey, const struct grey *tint, int width, int height);

#endif
