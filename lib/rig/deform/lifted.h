/* lifted: how far expressions raise the lower lids of a character, which deform_settle (rig/deform/arc.h) does not take back. */
#ifndef RIG_DEFORM_LIFTED_H
#define RIG_DEFORM_LIFTED_H
#include "rig/deform/clear.h"

/* How far the expressions of controls raise the left and the right lower lid, mm, >= 0: less, the less an eye is open. */
void deform_lifted(double mm[2], const struct deform_near *near, const struct rig *rig, const double *controls);

/* Measures that of each expression in full, near->lifted, by what is learnt, looking ahead; near is whole but for that. */
void deform_find_lifted(struct deform_near *near, const struct rig *rig);

#endif
