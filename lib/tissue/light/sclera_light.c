#include "tissue/light/sclera_light.h"

#include <math.h>

#include "math/chol.h"

void sclera_light_at(float rgb[3], const struct envmap_light lights[], int n, const float normal[3])
{
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int l = 0; l < n; l++) {
		const float *d = lights[l].dir;
		float fall = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
		for (int c = 0; c < 3; c++)
			rgb[c] += fall > 0 ? fall * lights[l].rgb[c] : 0;
	}
}

enum { UNKNOWNS = 3, SWEEPS = 8, INDEPENDENT = 20 };  // shadows and vessels are as long as a twentieth of the ring

struct sclera_light sclera_light_fit(const struct pale s[], int n)
{
	const double prior = 0.3, least = 0.02;  // of the slopes; of the scatter of ln light
	double x[UNKNOWNS] = { 0 }, a[UNKNOWNS][UNKNOWNS], noise = 0.1, mean = 0;
	for (int i = 0; i < n; i++)
		mean += s[i].light / n;
	x[0] = 1;
	struct sclera_light out = { .sigma = { prior, prior }, .spread = 0 };
	for (int sweep = 0; n > 0 && sweep < SWEEPS; sweep++) {
		double square = 0, weight = 0, b[UNKNOWNS] = { 0 };
		for (int j = 0; j < UNKNOWNS; j++)
			for (int k = 0; k < UNKNOWNS; k++)
				a[j][k] = j == k && j ? noise * noise / (prior * prior) * n / INDEPENDENT : 0;
		for (int i = 0; i < n; i++) {
			double row[UNKNOWNS] = { 1, s[i].normal[0], s[i].normal[1] }, y = s[i].light / mean;
			double off = y - x[0] - x[1] * row[1] - x[2] * row[2], limit = 1.5 * noise, w = fabs(off) > limit ? limit / fabs(off) : 1;
			for (int j = 0; j < UNKNOWNS; j++) {
				b[j] += w * row[j] * y;
				for (int k = 0; k < UNKNOWNS; k++)
					a[j][k] += w * row[j] * row[k];
			}
			square += w * off * off;
			weight += w;
		}
		noise = fmax(sqrt(square / weight), least);
		double det = a[1][1] * a[2][2] - a[1][2] * a[1][2];
		for (int k = 0; k < 2; k++)
			out.sigma[k] = fmin(noise * sqrt(a[2 - k][2 - k] / det * n / INDEPENDENT), prior);
		if (!chol_solve(UNKNOWNS, UNKNOWNS, a[0], b))
			break;
		for (int j = 0; j < UNKNOWNS; j++)
			x[j] = b[j];
	}
	for (int k = 0; k < 2; k++)
		out.slope[k] = fmin(fmax(x[1 + k] / fmax(x[0], 0.1), -0.9), 0.9);
	out.spread = noise;
	return out;
}

struct envmap sclera_light_environment(const struct sclera_light *s, int height)
{
	// On the sclera beside the limbus, whose normal is 40 degrees off the camera's axis, an even half is 0.88 of what it is on the axis.
	const double facing = 0.77, even_there = 0.885, usual = 0.6, least = 0.1, half = 0.17;  // radians: a softbox
	double slope = hypot(s->slope[0], s->slope[1]), across = usual, lamp = slope / usual, even = 0;
	for (int i = 0; i < 4; i++) {  // the lamp leaves the even light a tenth at least
		double toward = sqrt(1 - across * across);
		even = (1 - lamp * toward * facing) / even_there;
		if (even >= least)
			break;
		lamp = (1 - least * even_there) / (toward * facing);
		across = fmin(slope / lamp, 0.95);
		lamp = slope / across;
		even = least;
	}
	double room[3] = { even, even, even }, area = 4 * asin(sin(half) * sin(half));
	struct envmap_box box = { { 0, 0, -1 }, { half, half }, { 0 }, 0 };
	if (slope > 1e-6) {
		box.dir[0] = across * s->slope[0] / slope;
		box.dir[1] = across * s->slope[1] / slope;
		box.dir[2] = -sqrt(1 - across * across);
	}
	for (int c = 0; c < 3; c++)
		box.rgb[c] = lamp * M_PI / area;
	struct envmap env = envmap_room(height, room, room, 0, slope > 0.01, &box);
	envmap_normalise(&env);
	return env;
}
