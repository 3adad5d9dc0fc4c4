/* transfer_lay: registers a target from the best initial alignment that is known. */
#ifndef REGISTER_TRANSFER_LAY_H
#define REGISTER_TRANSFER_LAY_H
#include "mesh/mesh_part.h"
#include "register/transfer.h"

/* Registers a target onto the subject (transfer_run): from the landmarks that are given; else from both meshes' eyes, where they are
 * known; else, or where the eyes give no registration, from the shapes alone.
 * out          overwritten; transfer_free
 * target, subject  mm
 * part         of the target, without its eyeballs
 * subject_eye  centres of the subject's left and right eyeball, mm; null: not known
 * given        n = 0: none
 * Returns false, err set, when no start brings them together. */
bool transfer_lay(struct transfer *out, const struct mesh *target, const struct mesh_part *part, const struct mesh *subject,
                  const double (*subject_eye)[3], const struct nricp_landmarks *given, const struct transfer_conf *conf, struct err *err);

#endif
