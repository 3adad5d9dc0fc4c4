/* deform_carry: hair cards go where the skin they stand on has gone. */
#ifndef RIG_DEFORM_CARRY_H
#define RIG_DEFORM_CARRY_H
#include "rig/deform/cards.h"

/* Puts cards onto posed skin. x: [rig.n], the target's frame, mm; in: skin; out: cards. At rest they are as they were. */
struct deform_rooms;
void deform_carry(float (*x)[3], const struct deform_cards *cards, const struct rig *rig, struct deform_rooms *rooms);

#endif
