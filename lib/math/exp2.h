/* exp2: powers of two, and of e, in loops that become vector code. */
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

/* exp between -690 and 690, to 1e-11, the same way: 2^f as its Taylor series to the ninth power. */
SIMD_INLINE double exp_quick(double x)
{
	static const double whole_bits = 6755399441055744.0;  // 1.5 2^52
	union {
		double f;
		unsigned long long i;
	} whole = { x * 1.4426950408889634 + whole_bits }, p;
	const double f = x * 1.4426950408889634 - (whole.f - whole_bits);
	p.f = ((((((((1.0178086009239696e-07 * f + 1.3215486790144305e-06) * f + 1.5252733804059838e-05) * f + 0.00015403530393381606) * f + 0.0013333558146428441) * f + 0.009618129107628477) * f + 0.055504108664821576) * f + 0.2402265069591007) * f + 0.6931471805599453) * f + 1.0;
	p.i += whole.i << 52;
	return p.f;
}

#endif
