/* eye_opening: the outline of an eyeball as a mesh's lids leave it in sight.
 * Head frame, mm.
 */
#ifndef TRACK_EYE_OPENING_H
#define TRACK_EYE_OPENING_H
#include <stdbool.h>

#include "mesh/ray.h"

enum { OPENING_POINTS = 64 };

struct eye_opening {
	bool open;                            // false: the mesh covers the eyeball; nothing else is filled
	double edge[OPENING_POINTS][3];       // on the mesh, counter-clockwise as seen from in front, evenly along the outline
	double center[3];                     // of the outline
	double canthus[2][3];                 // its ends nearest the nose, and farthest from it
};

/* Seen from `from` (a point before the face). center, radius: of the eyeball. */
void eye_opening_find(struct eye_opening *opening, const struct ray_scene *mesh, const double from[3], const double center[3],
                      double radius);

#endif
