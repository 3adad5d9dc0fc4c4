/* Maps that quick pictures look up: 16 bits a channel, so that a texel and its neighbour come in one read of 16 bytes. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/impl.h"

void scene_texels_make(struct scene_texels *out, const float *rgba, int n)
{
	float most = 1e-6f;
	int stride = n + 8;
	long count = 4L * n * n;
	for (long i = 0; i < count; i++)
		most = i % 4 < 3 && rgba[i] > most ? rgba[i] : most;
	free(out->px);
	*out = (struct scene_texels){ n, stride, most / 65535, mem_array(4 * (size_t)n * (size_t)stride, sizeof *out->px) };
#pragma omp parallel for schedule(static)
	for (long i = 0; i < count; i++)
		out->px[i + i / (4 * n) * 4 * (stride - n)] = i % 4 < 3 ? (uint16_t)lrintf(fmaxf(rgba[i], 0) / out->step) : 0;
}
