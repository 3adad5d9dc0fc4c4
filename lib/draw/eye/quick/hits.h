/* hits: what the rays of a view met, kept from picture to picture while camera and eye stand still and only the light moves. Quick
 * pictures alone use it; about 14 bytes a pixel. One scene, one picture at a time. */
#ifndef DRAW_EYE_QUICK_HITS_H
#define DRAW_EYE_QUICK_HITS_H
#include "draw/eye/quick/quick.h"
#include "draw/eye/view.h"

/* For view.hits. scene_hits_free accepts null. */
struct scene_hits *scene_hits_new(void);
void scene_hits_free(struct scene_hits *hits);

/* Empties hits that belong to another scene, view or number of tiles, and makes them this view's. */
void scene_hits_for(struct scene_hits *hits, const struct scene *scene, const struct scene_view *view, int tiles);
/* What the rays of a tile met; null: not kept yet. Borrowed. */
struct quick_found *scene_hits_tile(const struct scene_hits *hits, int tile);
/* Keeps a copy. */
void scene_hits_keep(struct scene_hits *hits, int tile, const struct quick_found *found);

#endif
