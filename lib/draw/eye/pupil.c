/* The margin of the pupil. */
#include "draw/eye/pupil.h"

#include <math.h>

#include "draw/eye/look.h"
#include "draw/smooth.h"

/* Share of iris at a point of the iris plane; *ruff: share of the dark ruff. */
static float margin(const struct scene *s, float x, float y, float soft, float *ruff)
{
	float dx = x - (float)s->pupil[0], dy = y - (float)s->pupil[1], r = sqrtf(dx * dx + dy * dy), off = r - (float)s->pupil[2];
	*ruff = 0;
	if (fabsf(off) > 0.2f + 2 * soft)
		return off > 0;
	float turn = atan2f(dy, dx);
	// The ridges of the ruff: about 70 round the margin, of uneven height (iris paper, section 2.2).
	float ridge = 0.6f * fabsf(sinf(34 * turn + 1.7f * sinf(5 * turn))) + 0.4f * fabsf(sinf(21 * turn + 2 * sinf(3 * turn + 1)));
	float edge = (float)s->pupil[2] - (float)LOOK_RUFF_RIDGE * ridge, width = (float)LOOK_RUFF_WIDTH + (float)LOOK_RUFF_MORE * ridge;
	*ruff = 1 - smooth(edge + width - soft, edge + width + (float)LOOK_RUFF_SOFT + soft, r);
	return smooth(edge - (float)LOOK_RUFF_BLUR - soft, edge + (float)LOOK_RUFF_BLUR + soft, r);
}

void scene_pupil(float cover[3], const struct scene *s, float x, float y, float soft)
{
	static const float dark[3] = { LOOK_RUFF_COLOUR };  // what the pigment of the ruff leaves of the colour
	float ruff, iris = margin(s, x, y, soft, &ruff);
	for (int c = 0; c < 3; c++)
		cover[c] = iris * (1 + (float)LOOK_RUFF_SHARE * ruff * (dark[c] - 1));
}
