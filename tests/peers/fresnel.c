#include "tests/peers/fresnel.h"

#include <math.h>

double fresnel_transmittance(double cos_i, double n1, double n2)
{
	double c1 = fmin(fabs(cos_i), 1), eta = n1 / n2, k = 1 - eta * eta * (1 - c1 * c1);
	if (!(k > 0))
		return 0;
	double c2 = sqrt(k), rs = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), rp = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
	return 1 - 0.5 * (rs * rs + rp * rp);
}
