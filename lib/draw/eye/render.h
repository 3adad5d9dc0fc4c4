/* render: a picture of an eye: scene, view, light. */
#ifndef DRAW_EYE_RENDER_H
#define DRAW_EYE_RENDER_H
#include "draw/eye/lighting.h"
#include "draw/eye/view.h"

struct scene_count {
	long rays, iris;              // traced; of them scattered in the iris
	long kept, hidden;            // first rays not traced: kept from the picture before; behind something (whole tiles)
};

/* RGB and A: colour times cover, and the share of the pixel that the eye covers. image_free. The same bytes for any number of
 * threads. */
struct image scene_render(const struct scene *scene, const struct scene_view *view,
                          const struct scene_lighting *light, struct scene_count *count);

#endif
