/* eyes: where a character's eyeballs are, and which of its vertices belong on which of the subject's because of them. */
#ifndef REGISTER_EYES_H
#define REGISTER_EYES_H
#include "mesh/mesh_part.h"
#include "register/nricp/align.h"

/* Eyeballs among a character's pieces: the two rounds ones of one size that lie beside each other. center: left (of larger x),
 * right, in the mesh's unit. False: it has none. */
bool eyes_of_target(double center[2][3], double *radius, const struct mesh *target);

/* Places of the lids round both eyes as pairs of rows. part: of the character, without its eyeballs; the subject's axes are the
 * head's, its unit mm. False: it does not look along +z as the subject does. rows: owned by the caller, free(out->moving). */
bool eyes_landmarks(struct nricp_landmarks *out, const struct mesh_part *part, const double target_eye[2][3], double target_radius,
                    const struct mesh *subject, const double subject_eye[2][3]);

#endif
