/* mask: morphology and connected components of masks: row-major [height][width], 0 clear, any other value set. */
#ifndef IMAGE_MASK_H
#define IMAGE_MASK_H
#include <stdint.h>

/* Dilates the mask in place: sets every pixel within `radius` px of a set one, by the 3-4 chamfer distance (good to 6 %).
 * A negative radius erodes it: clears every pixel within -radius of a clear one. */
void mask_grow(uint8_t *mask, int width, int height, double radius);

/* Labels the 8-connected components of set pixels 1..n, in the order of their first pixel row by row; 0 elsewhere.
 * label: [height][width], overwritten. Returns n. */
int mask_label(int *label, const uint8_t *mask, int width, int height);

/* Clears the components of a mask that hold no pixel of `seed`, which is another. */
void mask_keep(uint8_t *mask, const uint8_t *seed, int width, int height);

#endif
