#include <math.h>

#include "image/colour.h"

static double cube(double t)
{
	return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

void colour_lab(double lab[3], const float rgb[3])
{
	static const double xyz_from_rgb[3][3] = { { 0.4123908, 0.3575843, 0.1804808 },
		                                       { 0.2126390, 0.7151687, 0.0721923 },
		                                       { 0.0193308, 0.1191948, 0.9505322 } };
	static const double white[3] = { 0.9504559, 1, 1.0890577 };
	double f[3];
	for (int i = 0; i < 3; i++) {
		double v = 0;
		for (int c = 0; c < 3; c++)
			v += xyz_from_rgb[i][c] * fmin(fmax((double)rgb[c], 0), 1);
		f[i] = cube(v / white[i]);
	}
	lab[0] = 116 * f[1] - 16;
	lab[1] = 500 * (f[0] - f[1]);
	lab[2] = 200 * (f[1] - f[2]);
}

static double chroma_weight(double c)
{
	double c7 = pow(c, 7);
	return sqrt(c7 / (c7 + 6103515625.0));
}

/* Degrees in [0, 360); 0 where there is no chroma. */
static double hue(double b, double a)
{
	double h = a || b ? atan2(b, a) * 180 / M_PI : 0;
	return h < 0 ? h + 360 : h;
}

double colour_difference_lab(const double p[3], const double q[3])
{
	const double deg = M_PI / 180;
	double g = 1 + 0.5 * (1 - chroma_weight((hypot(p[1], p[2]) + hypot(q[1], q[2])) / 2));
	double c1 = hypot(g * p[1], p[2]), c2 = hypot(g * q[1], q[2]), h1 = hue(p[2], g * p[1]), h2 = hue(q[2], g * q[1]);
	double dh = c1 * c2 == 0 ? 0 : h2 - h1, h = h1 + h2;
	dh = dh > 180 ? dh - 360 : dh < -180 ? dh + 360 : dh;
	if (c1 * c2 != 0)
		h = fabs(h1 - h2) <= 180 ? h / 2 : h < 360 ? h / 2 + 180 : h / 2 - 180;
	double l = (p[0] + q[0]) / 2, c = (c1 + c2) / 2;
	double t = 1 - 0.17 * cos((h - 30) * deg) + 0.24 * cos(2 * h * deg) + 0.32 * cos((3 * h + 6) * deg)
	           - 0.20 * cos((4 * h - 63) * deg);
	double sl = 1 + 0.015 * (l - 50) * (l - 50) / sqrt(20 + (l - 50) * (l - 50)), sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
	double turn = 30 * exp(-((h - 275) / 25) * ((h - 275) / 25)), r = -sin(2 * turn * deg) * 2 * chroma_weight(c);
	double x = (q[0] - p[0]) / sl, y = (c2 - c1) / sc, z = 2 * sqrt(c1 * c2) * sin(dh / 2 * deg) / sh;
	return sqrt(fmax(x * x + y * y + z * z + r * y * z, 0));
}

double colour_difference(const float a[3], const float b[3])
{
	double p[3], q[3];
	colour_lab(p, a);
	colour_lab(q, b);
	return colour_difference_lab(p, q);
}
