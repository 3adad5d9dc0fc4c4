#include "limbus/tilt.h"

#include <math.h>

#include "math/ellipse.h"
#include "math/vec.h"

void limbus_sight(double R[3][3], const double center[2], double focal)
{
	double sight[3] = { -center[0], -center[1], focal }, up[3] = { 0, 0, 1 };
	vec_unit(sight, sight);
	mat_smallest_rotation(R, up, sight);
}

/* Foreshortening of an ellipse of that aspect, turned by level, seen as e: smaller over larger eigenvalue, and the angle of the smaller one's direction. */
static void foreshortening(double *ratio, double *towards, const struct ellipse *e, double aspect, double level)
{
	const double c = cos(e->angle - level), s = sin(e->angle - level), aa = e->a * e->a, bb = e->b * e->b;
	const double xx = aa * c * c + bb * s * s, xy = aspect * (aa - bb) * c * s, yy = aspect * aspect * (aa * s * s + bb * c * c);
	const double root = sqrt(fmax(xx * yy - xy * xy, 0));  // of a 2 x 2 matrix M: (M + root I), up to scale
	const double fx = xx + root, fxy = xy / aspect, fy = (yy + root) / (aspect * aspect);
	const double mean = (fx + fy) / 2, half = hypot((fx - fy) / 2, fxy);
	*ratio = fmax(mean - half, 0) / (mean + half);
	*towards = atan2(2 * fxy, fx - fy) / 2 + M_PI / 2 + level;
}

void limbus_tilt(double *tilt, double *across, const struct ellipse *e, const double center[2], double focal, double aspect, double level)
{
	double R[3][3], m[3][3], k[6], s[3][3] = { 0 };
	struct ellipse turned = *e;
	ellipse_to_conic(k, e);
	const double g[3][3] = { { k[0], k[1] / 2, k[3] / 2 }, { k[1] / 2, k[2], k[4] / 2 }, { k[3] / 2, k[4] / 2, k[5] } };
	limbus_sight(R, center, focal);
	for (int j = 0; j < 3; j++) {
		m[0][j] = R[0][j] + center[0] / focal * R[2][j];
		m[1][j] = R[1][j] + center[1] / focal * R[2][j];
		m[2][j] = R[2][j] / focal;
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			for (int a = 0; a < 3; a++)
				for (int b = 0; b < 3; b++)
					s[i][j] += m[a][i] * g[a][b] * m[b][j];
	const double conic[6] = { s[0][0], 2 * s[0][1], s[1][1], 2 * s[0][2], 2 * s[1][2], s[2][2] };
	if (!ellipse_from_conic(&turned, conic))  // seen from nearly beside: as it is
		turned = *e;
	double ratio;
	foreshortening(&ratio, across, &turned, aspect, level);
	*tilt = acos(fmin(ratio, 1));
}
