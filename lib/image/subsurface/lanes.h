/* Vectors of floats for the files of subsurface. */
#ifndef IMAGE_SUBSURFACE_LANES_H
#define IMAGE_SUBSURFACE_LANES_H
#include <stdbool.h>
#include <string.h>

#include "math/simd.h"

enum { SUBSURFACE_LANES = 8 };
typedef float subsurface_lanes __attribute__((vector_size(32), aligned(4)));
typedef int subsurface_mask __attribute__((vector_size(32)));

/* a where `which`, else b. */
#define SUBSURFACE_SELECT(which, a, b) ((subsurface_lanes)(((which) & (subsurface_mask)(a)) | (~(which) & (subsurface_mask)(b))))

/* Whether texels [from, to] of two rows are all skin, and each four that touch lie within `most` of one another in depth. false
 * where they are fewer than a vector takes. */
SIMD_INLINE bool subsurface_smooth(const float *a, const float *b, int from, int to, float most)
{
	subsurface_mask no = { 0 };
	long word[sizeof no / sizeof(long)], any = to - from < SUBSURFACE_LANES;
	for (int i = from; i < to && !any; i += SUBSURFACE_LANES) {
		int at = i + SUBSURFACE_LANES <= to ? i : to - SUBSURFACE_LANES;  // the last ones twice
		subsurface_lanes p = *(const subsurface_lanes *)(a + at), q = *(const subsurface_lanes *)(a + at + 1);
		subsurface_lanes r = *(const subsurface_lanes *)(b + at), s = *(const subsurface_lanes *)(b + at + 1);
		subsurface_lanes low = SUBSURFACE_SELECT(p < r, p, r), low1 = SUBSURFACE_SELECT(q < s, q, s);
		subsurface_lanes high = SUBSURFACE_SELECT(p < r, r, p), high1 = SUBSURFACE_SELECT(q < s, s, q);
		low = SUBSURFACE_SELECT(low < low1, low, low1);
		high = SUBSURFACE_SELECT(high > high1, high, high1);
		no |= (high - low >= most) | (low <= 0);
	}
	memcpy(word, &no, sizeof word);
	for (int k = 0; k < (int)(sizeof word / sizeof *word); k++)
		any |= word[k];
	return !any;
}

#endif
