#include "tests/lib/truth/quad.h"

#include <math.h>

static quad dot(const quad a[3], const quad b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

quad quad_sqrt(quad x)
{
	if (!(x > 0))
		return 0;
	quad r = sqrt((double)x);  // each step doubles the digits; the squares of what is this near 0 would be none
	for (int i = 0; i < 3 && r > 0; i++)
		r = (r + x / r) / 2;
	return r;
}

static void unit(quad v[3])
{
	quad length = quad_sqrt(dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length;
}

void quad_surface(quad K[3], quad N[3], const struct cornea *c, quad x, quad y)
{
	quad r2 = x * x + y * y, R = c->R;
	K[0] = x;
	K[1] = y;
	K[2] = r2 / (R + quad_sqrt(R * R - c->p * r2));
	N[0] = K[0];
	N[1] = K[1];
	N[2] = c->p * K[2] - R;
	unit(N);
}

bool quad_refract(quad q[3], const quad u[3], const quad N[3], quad n)
{
	quad ci = dot(u, N), left = 1 - (1 - ci * ci) / (n * n), ct = quad_sqrt(left);
	for (int i = 0; i < 3; i++)
		q[i] = -u[i] / n + (ci / n - ct) * N[i];
	return left >= 0;
}

/* n sin t - sin i along two directions that span the surface at K. */
static void snell(quad f[2], quad K[3], const struct cornea *c, const double P[3], const double C[3], const double w[3], quad x, quad y)
{
	quad N[3], u[3], v[3];
	quad_surface(K, N, c, x, y);
	for (int i = 0; i < 3; i++) {
		u[i] = C ? C[i] - K[i] : (quad)w[i];
		v[i] = K[i] - P[i];
	}
	unit(u);
	unit(v);
	quad g[3];
	for (int i = 0; i < 3; i++)
		g[i] = c->n * v[i] - u[i];
	// Along the surface over x and over y: (1, 0, dz/dx), (0, 1, dz/dy).
	f[0] = g[0] - g[2] * N[0] / N[2];
	f[1] = g[1] - g[2] * N[1] / N[2];
}

double quad_snell(const struct cornea *c, const double P[3], const double C[3], const double w[3], double x, double y)
{
	quad f[2], K[3];
	snell(f, K, c, P, C, w, x, y);
	return hypot((double)f[0], (double)f[1]);
}

bool quad_path(quad K[3], double *stretch, const struct cornea *c, const double P[3], const double C[3], const double w[3],
               double x0, double y0)
{
	const quad h = 1e-13;
	quad x = x0, y = y0, f[2], fx[2], fy[2];
	for (int i = 0; i < 12; i++) {
		snell(fx, K, c, P, C, w, x + h, y);
		snell(fy, K, c, P, C, w, x, y + h);
		snell(f, K, c, P, C, w, x, y);
		quad a = (fx[0] - f[0]) / h, b = (fy[0] - f[0]) / h, d = (fx[1] - f[1]) / h, e = (fy[1] - f[1]) / h, det = a * e - b * d;
		if (det == 0)
			return false;
		quad dx = (e * f[0] - b * f[1]) / det, dy = (a * f[1] - d * f[0]) / det;
		*stretch = sqrt((double)(a * a + b * b + d * d + e * e)) / fabs((double)det);
		x -= dx;
		y -= dy;
		if (hypot((double)dx, (double)dy) < 1e-24) {
			quad N[3];
			quad_surface(K, N, c, x, y);
			return true;
		}
	}
	return false;
}
