#ifndef SKIN_CLOUD_IMPL_H
#define SKIN_CLOUD_IMPL_H
#include <stdint.h>

/* mask[height][width] becomes 0 where no two pixels within `reach` differ by `least` levels. */
void cloud_mask_plain(uint8_t *mask, const uint8_t *grey, int width, int height, int reach, int least);

#endif
