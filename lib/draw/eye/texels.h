/* texels: the iris maps as quick pictures look them up: 16 bits a channel, a texel and its neighbour in one read. */
#ifndef DRAW_EYE_TEXELS_H
#define DRAW_EYE_TEXELS_H
#include "draw/eye/scene.h"

/* Heights in a level's pairs are multiples of that, mm. marched: with its bottom. */
#define SCENE_PAIR_MM (1.0f / 32768)
#define SCENE_PAIR_STRIDE(n) ((n) + 16)
void scene_pairs_make(struct scene_level *level, bool marched);

/* Packs [n][n][4]; negatives become 0. Frees what *out had. */
void scene_texels_make(struct scene_texels *out, const float *rgba, int n);

/* Fills a level's shown and bare. */
void scene_shown_make(struct scene_level *level, const struct scene *scene);

#endif
