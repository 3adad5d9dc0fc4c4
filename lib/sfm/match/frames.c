#include "sfm/match/frames.h"

#include <math.h>

int sfm_choose_frames(long *chosen, int want, long n, const double *sharpness, const double *change, double same)
{
	double whole = 0, at = 0;
	int taken = 0;
	long best = -1;
	for (long i = 1; i < n; i++)
		whole += change[i];
	// A camera on a tripod shows nothing but noise: no more stretches than the whole change has steps of `same`.
	int stretches = (int)fmax(1, fmin(want, ceil(whole / fmax(same, 1e-9))));
	for (long i = 0; i < n; i++) {
		double before = at;
		at += i ? change[i] : 0;
		int ends = floor(at / whole * stretches) > floor(before / whole * stretches) && i;
		if (ends && best >= 0 && taken < stretches - 1) {
			chosen[taken++] = best;
			best = -1;
		}
		if (best < 0 || sharpness[i] > sharpness[best])
			best = i;
	}
	if (best >= 0)
		chosen[taken++] = best;
	return taken;
}
