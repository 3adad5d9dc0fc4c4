/* opening: the outline of the visible part of an eyeball between the lids of a mesh.
 * Head frame, mm.
 */
#ifndef TRACK_EYE_OPENING_H
#define TRACK_EYE_OPENING_H
#include <stdbool.h>

#include "mesh/ray.h"

enum { OPENING_POINTS = 64 };

struct eye_opening {
	bool open;                            // false: the mesh covers the eyeball; the rest is zero
	double edge[OPENING_POINTS][3];       // on the mesh, counter-clockwise as seen from in front, evenly along the outline
	double center[3];                     // of the outline
	double canthus[2][3];                 // its ends nearest the nose, and farthest from it
};

/* Traces rays from `from` (a point in front of the face, mm) to the eyeball (center, radius, mm) and finds where the mesh
 * begins to hide it, in 256 directions about its axis. opening: overwritten; open is false where the mesh hides the middle of
 * the eyeball or leaves it open in some direction. */
void eye_opening_find(struct eye_opening *opening, const struct ray_scene *mesh, const double from[3], const double center[3],
                      double radius);

#endif
