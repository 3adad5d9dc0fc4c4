/* mixed: what a blink's target lacks where the face has an expression that moves lids. Targets are added, and a shut lid has nothing left of what an expression does to an
 * open one: in a squint two shut lids would pass each other, with raised brows they would not meet. So each blink has a target for each expression,
 * `eyeBlinkLeft_squint`, whose weight is the product of the two: with both at 1 the sum is the pose itself. Where the way there leads further into the eye than the
 * blink's alone, there is one that leads round it, `eyeBlinkLeft_squint_half`, at 4 w (1 - w) times the expression's weight. For the files of this folder. */
#ifndef RIG_GLB_MIXED_H
#define RIG_GLB_MIXED_H
#include "rig/glb/bake.h"
#include "rig/glb/poser.h"

/* Most of them: of two eyes and n expressions. */
static inline int glb_most_mixed(int n)
{
	return 4 * n;
}

/* Fills the glb_most_mixed(n) poses that stand behind those of the n expressions, and takes out again those, of both eyes, that hardly move anything; all others of the bake are there. */
void glb_take_mixed(struct glb_bake *bake, struct poser *poser, int n);

#endif
