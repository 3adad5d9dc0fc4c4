/* Where a picture has nothing to match by: burnt-out walls, black cloth. What a matcher puts there it has carried over from
 * the next edge, and pairs agree on it: they carry it over alike. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "skin/cloud_impl.h"

/* Least and most of the window of 2 reach + 1 px round each of n values, stride apart. */
static void spread(uint8_t *low, uint8_t *high, const uint8_t *from_low, const uint8_t *from_high, int n, long stride, int reach)
{
	for (int i = 0; i < n; i++) {
		int a = i > reach ? i - reach : 0, b = i + reach < n - 1 ? i + reach : n - 1;
		uint8_t l = 255, h = 0;
		for (int k = a; k <= b; k++) {
			l = from_low[k * stride] < l ? from_low[k * stride] : l;
			h = from_high[k * stride] > h ? from_high[k * stride] : h;
		}
		low[i * stride] = l;
		high[i * stride] = h;
	}
}

void cloud_mask_plain(uint8_t *mask, const uint8_t *grey, int width, int height, int reach, int least)
{
	const size_t n = (size_t)width * (size_t)height;
	uint8_t *low = mem_array(n + 1, 1), *high = mem_array(n + 1, 1), *lows = mem_array(n + 1, 1), *highs = mem_array(n + 1, 1);
	for (int y = 0; y < height; y++) {
		long row = (long)y * width;
		spread(low + row, high + row, grey + row, grey + row, width, 1, reach);
	}
	for (int x = 0; x < width; x++)
		spread(lows + x, highs + x, low + x, high + x, height, width, reach);
	for (size_t i = 0; i < n; i++)
		if (highs[i] - lows[i] < least)
			mask[i] = 0;
	free(low);
	free(high);
	free(lows);
	free(highs);
}
