#include "tests/peers/lightpath_gain.h"

#include <math.h>

#include "base/mem.h"
#include "math/vec.h"
#include "optics/lightpath/path.h"
#include "tests/peers/fresnel.h"

double lightpath_gain(const struct cornea *cornea, const double P[3], const double w[3], const double K[3])
{
	struct path path = { cornea, P, 0, w };
	double t = 2 * cornea->R - cornea->p * K[2];
	struct chart at = chart_at(cornea, K[0] / t, K[1] / t);
	double g[2], H[3], v[3], N[3];
	path_derivatives(g, H, &path, &at);
	vec_add(v, K, -1, P);
	double d = vec_norm(v), p = cornea->p, f = cornea->n / d;
	vec_unit(v, v);
	// H dK = −(∂g/∂P) dP; P moves in its plane, dK along the tangents T_k: ∂g_k/∂P_j = −f (T_kj − (T_k·v) v_j).
	double m[3] = { -p * at.tau * at.x, -p * at.tau * at.y, at.tau }, M[2][2], T[2][3];
	for (int k = 0; k < 2; k++) {
		double x = k ? at.y : at.x;
		for (int i = 0; i < 3; i++)
			T[k][i] = (i == k) + x * m[i];
		for (int j = 0; j < 2; j++)
			M[k][j] = f * (T[k][j] - vec_dot(T[k], v) * v[j]);
	}
	double moved = (M[0][0] * M[1][1] - M[0][1] * M[1][0]) / (H[0] * H[2] - H[1] * H[1]), area[3];
	vec_cross(area, T[0], T[1]);
	cornea_normal(N, cornea, K);
	double cos_i = vec_dot(w, N);
	return cos_i > 0 ? fresnel_transmittance(cos_i, 1, cornea->n) * cos_i * fabs(moved) * vec_norm(area) : 0;
}

double lightpath_irradiance(const struct cornea *cornea, const double P[3], const double w[3])
{
	double K[8][3], sum = 0;
	int n = lightpath_all(K, COUNT(K), cornea, P, 0, w);
	for (int i = 0; i < n; i++)
		sum += lightpath_gain(cornea, P, w, K[i]);
	return sum;
}
