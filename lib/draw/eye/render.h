/* render: a picture of an eye, from scene, view and light. */
#ifndef DRAW_EYE_RENDER_H
#define DRAW_EYE_RENDER_H
#include "draw/eye/lighting.h"
#include "draw/eye/view.h"

struct scene_count {
	long rays, iris;              // rays traced; those of them that reached the iris
	long kept, hidden;            // first rays not traced: kept from the picture before (view.hits); hidden (whole tiles of view.visible)
};

/* One ray through the middle of every pixel; where neighbours differ, view.samples^2 rays in its place.
 * count  null, or added to
 * Returns [height][width][4]: colour times cover, and the share of the pixel that the eye covers; image_free. The same bytes for
 * any number of threads. */
struct image scene_render(const struct scene *scene, const struct scene_view *view,
                          const struct scene_lighting *light, struct scene_count *count);

#endif
