#include "draw/tone.h"

#include <math.h>
#include <stddef.h>

void tone(struct image *rgb, double share)
{
	if (!(share > 0))
		return;
	const ptrdiff_t n = (ptrdiff_t)rgb->width * rgb->height * rgb->channels;
	const float mix = (float)fmin(share, 1);
#pragma omp parallel for simd schedule(static)
	for (ptrdiff_t i = 0; i < n; i++) {
		const float cut = fminf(fmaxf(rgb->px[i], 0), 1), f = 0.8f * fmaxf(rgb->px[i], 0);
		rgb->px[i] = cut + mix * (fminf(f * (2.51f * f + 0.03f) / (f * (2.43f * f + 0.59f) + 0.14f), 1) - cut);
	}
}
