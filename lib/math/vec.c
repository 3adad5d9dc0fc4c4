#include "math/vec.h"

void mat_smallest_rotation(double out[3][3], const double a[3], const double b[3])
{
	double v[3], c = vec_dot(a, b);
	vec_cross(v, a, b);
	if (c < -1 + 1e-12) {
		// Half a turn: any axis perpendicular to a serves.
		int k = fabs(a[0]) < fabs(a[1]) ? 0 : 1;
		double e[3] = { k == 0, k == 1, 0 }, u[3];
		vec_cross(u, a, e);
		vec_unit(u, u);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				out[i][j] = 2 * u[i] * u[j] - (i == j);
		return;
	}
	double s = 1 / (1 + c);
	double k[3][3] = { { 0, -v[2], v[1] }, { v[2], 0, -v[0] }, { -v[1], v[0], 0 } };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = (i == j) * c + k[i][j] + s * v[i] * v[j];
}
