/* halves: what a lid's target lacks between open and shut. A target moves in a straight line; a lid goes round the eye, and its straight way from open
 * to shut leads through the cornea. So each blink has a second target, `eyeBlinkLeft_half`, whose weight is 4 w (1 - w) where the
 * blink's is w: none of it at both ends, all half way. For the files of this folder. */
#ifndef RIG_GLB_HALVES_H
#define RIG_GLB_HALVES_H
#include "rig/glb/bake.h"
#include "rig/glb/poser.h"

static inline double glb_half_weight(double w)
{
	return 4 * w * (1 - w);
}

/* What leads skin out of the eye (poser.turn) on the way of a target, blink, from a pose `from` (null: from rest), beyond half[bake.n][3], which goes along: out[bake.n][3].
 * What is outside at both ends stays so, and what lies in it by a little there goes no deeper. */
void glb_lead_round(float *out, const float *half, struct poser *poser, const struct glb_bake *bake, const float *from, const float *blink, int eye);

/* By how much, at worst, mm, a vertex of that skin comes nearer to the eye on that way than it is at both ends. */
double glb_way_lacks(const float *half, const struct poser *poser, const struct glb_bake *bake, const float *from, const float *blink, int eye);

/* Fills the bake's last GLB_HALVES poses: by least squares over the way of each blink's target from rest to shut, then outwards as far as skin that is
 * outside the eye at both ends needs to be so on the way. The blinks are the bake's first poses. */
void glb_take_halves(struct glb_bake *bake, struct poser *poser);

#endif
