/* average: skin of an average face, where there is no mesh of the person: to follow how the head moves. */
#ifndef TRACK_CLIP_AVERAGE_H
#define TRACK_CLIP_AVERAGE_H
#include "mesh/mesh.h"

/* Skin round the eyes of a face whose eyeballs' centres lie at x = +-half_apart, y = z = 0 (mm; head frame of subject.h): a smooth sheet, curved aside as
 * faces are, without the nose, whose height differs most from person to person. mesh: overwritten; mesh_free. */
void average_skin(struct mesh *mesh, double half_apart);

#endif
