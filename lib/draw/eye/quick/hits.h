/* hits: what the rays of an unmoved view met, kept from picture to picture. */
#ifndef DRAW_EYE_QUICK_HITS_H
#define DRAW_EYE_QUICK_HITS_H
#include "draw/eye/quick/quick.h"
#include "draw/eye/view.h"

/* What the rays of one view met, for a camera and an eye that stand still while lights move: about 14 bytes a pixel. Quick pictures
 * alone use it. One scene, one picture at a time. */
struct scene_hits *scene_hits_new(void);
void scene_hits_free(struct scene_hits *hits);

/* Makes hits those of this view: empty, where they were another's. Then one tile's; null: not found yet; and keeps it. */
void scene_hits_for(struct scene_hits *hits, const struct scene *scene, const struct scene_view *view, int tiles);
struct quick_found *scene_hits_tile(const struct scene_hits *hits, int tile);
void scene_hits_keep(struct scene_hits *hits, int tile, const struct quick_found *found);

#endif
