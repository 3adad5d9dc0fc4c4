/* texels: the iris maps as quick pictures look them up: 16 bits a channel, so that a texel and its neighbour come in one read of
 * 16 bytes. */
#ifndef DRAW_EYE_TEXELS_H
#define DRAW_EYE_TEXELS_H
#include "draw/eye/scene.h"

/* Pairs: the height of a texel in the low half of a word, that of the next one to the right in the high half, in multiples of
 * SCENE_PAIR_MM; rows SCENE_PAIR_STRIDE(n) words apart. */
#define SCENE_PAIR_MM (1.0f / 32768)
#define SCENE_PAIR_STRIDE(n) ((n) + 16)

/* Makes the level's pairs from its relief; marched: its bottom, too. Owned by the level; frees those it had. */
void scene_pairs_make(struct scene_level *level, bool marched);

/* Packs rgba [n][n][4]; negatives become 0. out owns its px; frees those it had. */
void scene_texels_make(struct scene_texels *out, const float *rgba, int n);

/* Fills the level's shown and bare. */
void scene_shown_make(struct scene_level *level, const struct scene *scene);

#endif
