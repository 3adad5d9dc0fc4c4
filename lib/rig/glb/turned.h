/* turned: what a blink's target lacks for an eye that looks down or up. Targets are added, and a lid that follows such a look shuts by another way than
 * one straight ahead: their sum leads it past the other lid and into the eye. So each blink has a target for each of the two looks,
 * `eyeBlinkLeft_down`, whose weight is the product of the blink's and the look's: with both at 1 the sum is the pose itself. And one that leads it round the
 * turned eye on the way there, `eyeBlinkLeft_down_half`, at 4 w (1 - w) times the look's. For the files of this folder. */
#ifndef RIG_GLB_TURNED_H
#define RIG_GLB_TURNED_H
#include "rig/glb/bake.h"
#include "rig/glb/poser.h"

/* Fills the GLB_TURNED poses that stand before the halves; the bake's blinks, looks and halves are there. */
void glb_take_turned(struct glb_bake *bake, struct poser *poser);

#endif
