/* blink: one blink of both eyes as an animation of its own, by the named targets: how `eyeBlink..` and `eyeBlink.._half` go together (halves.h).
 * For the files of this folder. */
#ifndef RIG_GLB_BLINK_H
#define RIG_GLB_BLINK_H
#include "rig/glb/bake.h"
#include "rig/glb/buffer.h"
#include "rig/glb/skin.h"

/* Lids shut in 0.07 s and open in 0.17 s (minimum jerk: lib/motion/blink.h). Null where no mesh has named targets. The skin's mesh i is that of node 1 + i. */
json_t *glb_blink(struct glb_buffer *buffer, const struct glb_bake *bake, const struct glb_skin *skin);

#endif
