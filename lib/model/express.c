#include "model/express.h"

#include <math.h>

void express_eye(double aperture[2], int eye, int n, const double *w, const double (*by)[EXPRESS_LIDS], const double px[EXPRESS_LIDS], double open)
{
	const double *of = px + 2 * eye, share = fmin(fmax(open, 0), 1);
	double add[2] = { 0 };
	for (int k = 0; k < n; k++)
		for (int lid = 0; lid < 2; lid++)
			add[lid] += isnan(w[k]) ? 0 : share * w[k] * by[k][2 * eye + lid];
	const double was = of[0] * aperture[0] + of[1] * aperture[1], more = of[0] * add[0] + of[1] * add[1];
	const double least = fmin(was, 0), most = fmax(was, of[0] + of[1]), room = more < 0 ? least - was : most - was;
	const double kept = fabs(more) > fabs(room) ? room / more : 1;
	for (int lid = 0; lid < 2; lid++)
		aperture[lid] += kept * add[lid];
}
