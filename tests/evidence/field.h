/* field: tileable noise textures that all drawn eyes take their detail from.
 * Training and test pictures use textures of other seeds.
 */
#ifndef EVIDENCE_FIELD_H
#define EVIDENCE_FIELD_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

enum { FIELD_SIDE = 256, FIELD_SEEDS = 12 };
enum field_kind { FIELD_SMOOTH, FIELD_FINE, FIELD_RIDGE, FIELD_CELL, FIELD_LINES, FIELD_KINDS };

struct field {
	float px[FIELD_SIDE][FIELD_SIDE];  // 0..1, mean near 0.5
};

/* One of FIELD_SEEDS textures of a kind for training (test false) or for testing; made at the first call. Not for several
 * threads at once. */
const struct field *field_of(enum field_kind kind, int seed, bool test);

/* Bilinear value at (u, v), texels; repeats. */
static inline float field_at(const struct field *f, float u, float v)
{
	const float fu = floorf(u), fv = floorf(v), a = u - fu, b = v - fv;
	const int i = (int)fu & (FIELD_SIDE - 1), j = (int)fv & (FIELD_SIDE - 1);
	const int k = (i + 1) & (FIELD_SIDE - 1), l = (j + 1) & (FIELD_SIDE - 1);
	const float *p = f->px[j], *q = f->px[l];
	const float top = p[i] + a * (p[k] - p[i]), bottom = q[i] + a * (q[k] - q[i]);
	return top + b * (bottom - top);
}

#endif
