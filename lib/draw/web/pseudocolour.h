/* pseudocolour: iris maps as pictures to look at. All return linear Rec. 709 of the map's size; image_free.
 * range, of scalar and relief: out, between the first and the last hundredth of the values (percentiles of every seventh texel).
 */
#ifndef DRAW_WEB_PSEUDOCOLOUR_H
#define DRAW_WEB_PSEUDOCOLOUR_H
#include "image/image.h"

/* R G B W, W the weight with which a photograph saw the texel: its colour; dark stripes where W is 0. */
struct image pseudocolour_seen(const struct image *rgbw);

/* The same with the outline of a mask (above 0.5) drawn on it and what lies outside dimmed. mask: as large as rgbw. */
struct image pseudocolour_mask(const struct image *mask, const struct image *rgbw);

/* One channel over the colour ramp dark blue, green, yellow, of even steps of lightness. */
struct image pseudocolour_scalar(const struct image *map, int channel, double range[2]);

/* The first channel as a height field lit from the upper left. Its slope is scaled by its own mean, so that shallow reliefs show,
 * too. */
struct image pseudocolour_relief(const struct image *map, double range[2]);

#endif
