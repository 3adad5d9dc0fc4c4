#include "tissue/spectrum.h"

#include <math.h>

#include "math/vec.h"
#include "tissue/spectrum_tables.h"

const char *const illuminant_names[] = { "D65", "D55", "D50", "A", "F2", "F11", "E", 0 };

static double interpolate(int n, const double table[], double step, double nm)
{
	double x = (nm - 380) / step;
	int i = x <= 0 ? 0 : x >= n - 1 ? n - 2 : (int)x;
	double f = fmin(fmax(x - i, 0), 1);
	return table[i] + f * (table[i + 1] - table[i]);
}

/* CIE 15: chromaticity on the daylight locus from the correlated colour temperature, then S0 + M1 S1 + M2 S2. */
static double daylight(double kelvin, double nm)
{
	double t = 1e3 / kelvin;
	double x = kelvin <= 7000 ? 0.244063 + 0.09911 * t + 2.9678 * t * t - 4.6070 * t * t * t
	                          : 0.237040 + 0.24748 * t + 1.9018 * t * t - 2.0064 * t * t * t;
	double y = -3 * x * x + 2.87 * x - 0.275;
	double m = 0.0241 + 0.2562 * x - 0.7341 * y;
	double m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
	double m2 = (0.03 - 31.4424 * x + 30.0717 * y) / m;
	return interpolate(41, spectrum_daylight[0], 10, nm) + m1 * interpolate(41, spectrum_daylight[1], 10, nm)
	       + m2 * interpolate(41, spectrum_daylight[2], 10, nm);
}

/* CIE standard illuminant A, its own definition (c2 = 1.435e7 nm K at 2848 K). */
static double tungsten(double nm)
{
	return pow(560 / nm, 5) * expm1(1.435e7 / (2848 * 560)) / expm1(1.435e7 / (2848 * nm));
}

double illuminant_power(enum illuminant light, double nm)
{
	switch (light) {
	case ILLUMINANT_D65:
		return daylight(6504, nm);
	case ILLUMINANT_D55:
		return daylight(5503, nm);
	case ILLUMINANT_D50:
		return daylight(5003, nm);
	case ILLUMINANT_A:
		return tungsten(nm);
	case ILLUMINANT_F2:
		return interpolate(SPECTRUM_N, spectrum_f2, 5, nm);
	case ILLUMINANT_F11:
		return interpolate(SPECTRUM_N, spectrum_f11, 5, nm);
	case ILLUMINANT_E:
		break;
	}
	return 1;
}

/* A bell with its own width on each side; widths as reciprocals, 1/nm. */
static double lobe(double nm, double centre, double below, double above)
{
	double t = (nm - centre) * (nm < centre ? below : above);
	return exp(-0.5 * t * t);
}

void observer_xyz(double xyz[3], double nm)
{
	xyz[0] = 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323)
	         - 0.065 * lobe(nm, 501.1, 0.0490, 0.0382);
	xyz[1] = 0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322);
	xyz[2] = 1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725);
}

/* XYZ of the light, Y = 1. */
static void white(double xyz[3], enum illuminant light)
{
	xyz[0] = xyz[1] = xyz[2] = 0;
	for (int i = 0; i < SPECTRUM_N; i++) {
		double bar[3];
		observer_xyz(bar, spectrum_nm(i));
		vec_add(xyz, xyz, illuminant_power(light, spectrum_nm(i)), bar);
	}
	double y = xyz[1];
	for (int c = 0; c < 3; c++)
		xyz[c] /= y;
}

void observer_make(struct observer *observer, enum illuminant light)
{
	/* Rec. 709 from XYZ (IEC 61966-2-1); Bradford's sharpened cone responses and their inverse. */
	static const double rgb_from_xyz[3][3] = { { 3.2406, -1.5372, -0.4986 }, { -0.9689, 1.8758, 0.0415 }, { 0.0557, -0.2040, 1.0570 } };
	static const double cone_from_xyz[3][3] = { { 0.8951, 0.2664, -0.1614 }, { -0.7502, 1.7135, 0.0367 }, { 0.0389, -0.0685, 1.0296 } };
	static const double xyz_from_cone[3][3] = {
		{ 0.9869929, -0.1470543, 0.1599627 }, { 0.4323053, 0.5183603, 0.0492912 }, { -0.0085287, 0.0400428, 0.9684867 }
	};
	double from[3], to[3], adapt[3][3], m[3][3];
	white(from, light);
	mat_vec(from, cone_from_xyz, from);
	mat_vec(to, cone_from_xyz, (const double[3]) { 0.95047, 1, 1.08883 });
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			adapt[i][j] = to[i] / from[i] * cone_from_xyz[i][j];
	mat_mul(m, xyz_from_cone, adapt);
	mat_mul(m, rgb_from_xyz, m);

	double sum[3] = { 0 };
	for (int i = 0; i < SPECTRUM_N; i++) {
		double bar[3];
		observer_xyz(bar, spectrum_nm(i));
		mat_vec(bar, m, bar);
		for (int c = 0; c < 3; c++)
			sum[c] += observer->weight[c][i] = bar[c] * illuminant_power(light, spectrum_nm(i));
	}
	for (int c = 0; c < 3; c++)  // the fit of the matching functions is good to a per cent: white is made exact
		for (int i = 0; i < SPECTRUM_N; i++)
			observer->weight[c][i] /= sum[c];
}
