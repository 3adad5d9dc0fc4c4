#include "tests/lib/scenes/painted_eye.h"

#include <math.h>
#include <string.h>

#include "math/rng.h"

const double PAINTED_FAR = 500, PAINTED_FOCAL = 4000, PAINTED_R = 12, PAINTED_LIMBUS = 5.8;

enum { SUB = 2 };

void painted_eye_camera(double m[4][4])
{
	double pose[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, PAINTED_FAR }, { 0, 0, 0, 1 } };
	memcpy(m, pose, sizeof pose);
}

double painted_eye_lid(const struct painted_eye *eye, int lower, double x)
{
	const double *a = eye->canthus[0], *b = eye->canthus[1];
	double t = (x - a[0]) / (b[0] - a[0]);
	if (!(t >= 0 && t <= 1))
		return NAN;
	return a[1] + t * (b[1] - a[1]) + (lower ? 1 : -1) * eye->rise[lower] * 4 * t * (1 - t);
}

/* Direction of a point of the globe in the eye's own axes: the inverse of Ry(h) Rx(-v) Rz(t), one turn after the other. */
static void to_eye(double d[3], const double gaze[3])
{
	double c = cos(gaze[0]), s = sin(gaze[0]), x = c * d[0] - s * d[2], z = s * d[0] + c * d[2], y = d[1];
	c = cos(gaze[1]), s = sin(gaze[1]);
	double y1 = c * y - s * z, z1 = s * y + c * z;
	c = cos(gaze[2]), s = sin(gaze[2]);
	d[0] = c * x + s * y1;
	d[1] = -s * x + c * y1;
	d[2] = z1;
}

static void globe_colour(double out[3], const struct painted_eye *eye, const double n[3])
{
	double d[3] = { n[0], n[1], n[2] }, light = 0.75 + 0.25 * n[2];
	to_eye(d, eye->gaze);
	double r = hypot(d[0], d[1]) * PAINTED_R, angle = atan2(d[1], d[0]);
	double vein = d[2] > 0 ? sin(23 * d[0] + 7 * sin(19 * d[1])) : 0;
	double sclera[3] = { 225 + 5 * vein, 212 - 8 * vein, 205 - 8 * vein };
	double streak = 1 + 0.2 * sin(17 * angle + 1) + 0.15 * sin(29 * angle) + 0.15 * sin(7 * angle + 2);
	// The limbus is a soft step, half a millimetre wide.
	double in = 1 / (1 + exp((r - PAINTED_LIMBUS) / 0.1)), pupil = 1 / (1 + exp((r - 1.9) / 0.05));
	if (d[2] < 0)
		in = 0;
	for (int c = 0; c < 3; c++) {
		double iris = eye->iris[c] * streak * (1 - pupil) + 12 * pupil;
		out[c] = light * (in * iris + (1 - in) * sclera[c]);
	}
}

void painted_eye_globe(double out[3], const struct painted_eye *eye, double x, double y)
{
	// The ray through the pixel and the sphere, in the head's axes.
	double d[3] = { (x - PAINTED_W / 2.0) / PAINTED_FOCAL, -(y - PAINTED_H / 2.0) / PAINTED_FOCAL, -1 };
	double o[3] = { -eye->center[0], -eye->center[1], PAINTED_FAR - eye->center[2] };
	double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
	double c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - PAINTED_R * PAINTED_R, root = b * b - a * c;
	double t = (-b - sqrt(fmax(0, root))) / a, n[3];
	for (int k = 0; k < 3; k++)
		n[k] = (o[k] + t * d[k]) / PAINTED_R;
	if (root > 0)
		globe_colour(out, eye, n);
	else
		out[0] = 190, out[1] = 120, out[2] = 115;
}

static void skin_colour(double out[3], const struct painted_eye *eye, double x, double y, double away, bool lower)
{
	// The rim is bare; lashes begin a little outside it and move with the lid.
	double lash = away > 6 && away < 22 && fmod(x + 0.4 * away, 5) < 1.2 ? 0.35 : 1;
	double pores = 1 + 0.05 * sin(0.9 * x + 0.3 * y) * sin(0.7 * y - 0.2 * x) + 0.04 * sin(0.31 * x + 0.37 * y);
	for (int c = 0; c < 3; c++)
		out[c] = eye->skin[c] * pores * lash * (lower ? 1 : 0.9);
}

static void sample(double out[3], const struct painted_eye *eye, double x, double y)
{
	double up = painted_eye_lid(eye, 0, x), low = painted_eye_lid(eye, 1, x);
	if (!(y > up && y < low)) {
		bool lower = y > 0.5 * (up + low);
		skin_colour(out, eye, x, y, isnan(up) ? 30 : lower ? y - low : up - y, lower);
		return;
	}
	painted_eye_globe(out, eye, x, y);
}

void painted_eye_draw(uint8_t *rgb, uint8_t *luma, const struct painted_eye *eye)
{
	struct rng rng = { eye->seed };
	for (int y = 0; y < PAINTED_H; y++) {
		for (int x = 0; x < PAINTED_W; x++) {
			double sum[3] = { 0 }, one[3];
			for (int k = 0; k < SUB * SUB; k++) {
				sample(one, eye, x + (k % SUB + 0.5) / SUB, y + (k / SUB + 0.5) / SUB);
				for (int c = 0; c < 3; c++)
					sum[c] += one[c] / (SUB * SUB);
			}
			double noise = eye->noise * rng_normal(&rng);
			for (int c = 0; c < 3; c++)
				rgb[3 * (y * PAINTED_W + x) + c] = (uint8_t)fmin(255, fmax(0, sum[c] + noise + 0.5));
			luma[y * PAINTED_W + x] = (uint8_t)fmin(255, fmax(0, 0.3 * sum[0] + 0.59 * sum[1] + 0.11 * sum[2] + noise));
		}
	}
}
