/* transfer_unit: the unit of a mesh, guessed from its size. */
#ifndef REGISTER_TRANSFER_UNIT_H
#define REGISTER_TRANSFER_UNIT_H
#include "register/transfer.h"

/* Millimetres in one unit of a subject's mesh: of the units that modelling programs use (mm, cm, dm, m) the one in which it has most
 * nearly the size of a face; where none fits, a power of ten. */
double transfer_subject_unit(const struct mesh *subject);

/* Millimetres in one unit of a target's mesh, whatever it is: the one in which its eyeballs are as far apart as the subject's; without
 * them, of the same units, and of the one that makes it as large as the subject, that in which it aligns best. One of the usual
 * units where that comes near.
 * target       its faces look outwards
 * subject      in mm; subject_eye: centres of its eyeballs, mm, or null
 * conf         its align and least_piece are used */
double transfer_target_unit(const struct mesh *target, const struct mesh *subject, const double (*subject_eye)[3],
                            const struct transfer_conf *conf);

#endif
