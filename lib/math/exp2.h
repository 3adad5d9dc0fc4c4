/* exp2: powers of two in loops that become vector code. */
#ifndef MATH_EXP2_H
#define MATH_EXP2_H
#include "math/simd.h"

/* exp2 between -120 and 120, to 1e-4: a cubic on -1/2..1/2 times a power of 2, which is added to its exponent. The nearest whole
 * number is what a sum with 1.5 2^23 is rounded to. */
SIMD_INLINE float exp2_quick(float t)
{
	union {
		float f;
		unsigned i;
	} whole = { t + 12582912.0f }, p;
	float f = t - (whole.f - 12582912.0f);
	p.f = ((5.517167e-2f * f + 0.24261112f) * f + 0.69326099f) * f + 0.99992807f;
	p.i += whole.i << 23;
	return p.f;
}

#endif
