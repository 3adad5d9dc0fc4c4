/* map: maps as pictures in base 64 for the interactive page: {png, width, height, low, high}, 8 bits a channel; low and high are
 * what 0 and 255 stand for. json_decref. Null, err set, when a picture cannot be encoded.
 */
#ifndef DRAW_WEB_MAP_H
#define DRAW_WEB_MAP_H
#include <jansson.h>

#include "draw/eye/scene.h"

/* Height in two channels of 12 bits together, stroma's thickness in the third; mm. */
json_t *web_map_relief(const struct scene_level *level, struct err *err);

/* The photograph's colour, sRGB. */
json_t *web_map_colour(const struct scene_level *level, struct err *err);

/* px[height][width][stride], of which three count, by their logarithm; none below dark (> 0). */
json_t *web_map_log(const float *px, int width, int height, int stride, float dark, struct err *err);

/* The same of the model at the levels that are marched from, one below the other; {from, tops}: the first of them, their rows. */
json_t *web_map_model(const struct scene *scene, struct err *err);

/* Of wrinkle maps the n in `of`, one below the other, as web_map_relief. */
json_t *web_map_folds(const struct image *map, int n, const int of[], struct err *err);

/* The first channels, at most 3, each from its least to its largest value. */
json_t *web_map_plain(const struct image *map, struct err *err);

#endif
