/* rim: eyeballs from the holes that a mesh has for them: the rim of such a hole is the lids' inner edge, which lies on the eyeball. */
#ifndef TRACK_CLIP_RIM_H
#define TRACK_CLIP_RIM_H
#include <stdbool.h>

#include "mesh/mesh.h"

/* Fits spheres (algebraic least squares) to the mesh's boundary loops as wide as an eye's opening.
 * mesh  mm, in the head's axes
 * near  a point of the eye's opening, or null: then only a hole of that side (x > 0: left) that is the only one counts
 * Sets center and radius, mm. Returns false when no such hole lies on a sphere of an eyeball's size. */
bool rim_eyeball(double center[3], double *radius, const struct mesh *mesh, bool left, const float *near);

#endif
