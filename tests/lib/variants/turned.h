/* turned: a mesh in another pose, unit and winding, and its registration as the stage does it. */
#ifndef TESTS_TURNED_H
#define TESTS_TURNED_H
#include <stdbool.h>

#include "math/rng.h"
#include "mesh/mesh.h"
#include "register/transfer_check.h"

/* The 24 rotations of a cube by number; from 24 on a random rotation (uniform: a unit quaternion of four normal numbers). */
void turned_rotation(double out[3][3], int number, struct rng *rng);

/* A copy with vertices scale (rotation x) + shift; inward: its faces are wound the other way round. mesh_free. */
struct mesh turned_mesh(const struct mesh *mesh, const double rotation[3][3], double scale, const double shift[3], bool inward);

/* Registers a mesh whose pose, unit and winding are not known, and checks it, with the configuration of transfer_conf.h.
 * mesh   in any unit; turned outwards and brought to mm
 * eye    centres of the subject's eyeballs, or null
 * Returns whether it is accepted; reason says why not. out is there in either case: transfer_free. */
bool turned_lay(struct transfer *out, char reason[1024], struct mesh *mesh, const struct mesh *subject, const double (*eye)[3]);

#endif
