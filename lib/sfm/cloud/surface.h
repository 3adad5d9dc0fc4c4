/* surface: the connected part of a mesh that is kept.
 */
#ifndef SFM_CLOUD_SURFACE_H
#define SFM_CLOUD_SURFACE_H
#include "mesh/mesh.h"

/* Keeps the connected piece of the largest area, of the faces whose corners are all kept (null: all). Colours go along. */
void surface_largest(struct mesh *mesh, const bool *keep);

#endif
