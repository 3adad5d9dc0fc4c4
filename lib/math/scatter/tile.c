/* The tiles that threads take of a symmetric matrix. */
#include <math.h>

#include "math/scatter/impl.h"

int scatter_tiles(int p)
{
	int n = (p + SCATTER_TILE - 1) / SCATTER_TILE;
	return n * (n + 1) / 2;
}

struct scatter_tile scatter_tile(int p, int t)
{
	int i = (int)((sqrt(8.0 * t + 1) - 1) / 2), j = t - i * (i + 1) / 2, i0 = i * SCATTER_TILE, j0 = j * SCATTER_TILE;
	return (struct scatter_tile){ i0, j0, p - i0 < SCATTER_TILE ? p - i0 : SCATTER_TILE,
		                          p - j0 < SCATTER_TILE ? p - j0 : SCATTER_TILE };
}
