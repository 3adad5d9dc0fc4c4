/* Light on the white of the eye under one lamp, from overhead over the terminator to the dark side: the renderer's, and what it would be of a matt sphere, against photons
 * followed through a shell of tissue. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/envmap/envmap.h"
#include "tests/lib/bench/bench.h"
#include "tests/peers/sclera_photons.h"

enum { ZONES = 36, NORMALS = 4096, METHODS = 3 };

struct case_of {
	struct envmap env;
	float normal[NORMALS][3], light[NORMALS][3];
	int method;
};

static void shade(void *p)
{
	struct case_of *k = p;
	for (int i = 0; i < NORMALS; i++)
		if (k->method == 0)
			envmap_wet(k->light[i], &k->env, k->normal[i]);
		else if (k->method == 1)
			envmap_irradiance(k->light[i], &k->env, k->normal[i]);
		else
			for (int c = 0; c < 3; c++)  // the lamp stands at -z
				k->light[i][c] = 4 * fmaxf(-k->normal[i][2], 0);
}

/* Largest difference of the zones from `first` to before `end`, each over their mean over the sphere, in what the photons give overhead. */
static double off(const struct case_of *k, const double truth[ZONES], int first, int end)
{
	double mean = 0, worst = 0;
	for (int i = 0; i < ZONES; i++)
		mean += (double)k->light[i][1] * 0.5 * (cos(M_PI * i / ZONES) - cos(M_PI * (i + 1) / ZONES));
	for (int i = first; i < end; i++)
		worst = fmax(worst, fabs((double)k->light[i][1] / mean - truth[i]));
	return 100 * worst / truth[1];
}

int main(int argc, char **argv)
{
	static const char *const names[METHODS] = { "through the film, degree 4", "matt, degree 2 (Ramamoorthi and Hanrahan 2001)", "matt, exact" };
	static const struct sclera_shell shell[] = { { 11.8, 0.6, 4.4, 0.06, 0.9, 1.336 }, { 11.8, 0.6, 3.0, 0.04, 0.9, 1.336 }, { 11.8, 0.9, 2.6, 0.02, 0.9, 1.336 } };
	static const char *const colours[] = { "blue, 0.6 mm", "green, 0.6 mm", "red, 0.9 mm" };
	bench_open("sclera", argc, argv);
	struct case_of *k = mem_new(1, sizeof *k);
	const double dark[3] = { 0 };
	k->env = envmap_room(256, dark, dark, 1, 1, &(struct envmap_box){ { 0, 0, -1 }, { 0.03, 0.03 }, { 1000, 1000, 1000 }, 0 });
	for (int i = 0; i < NORMALS; i++) {
		double t = M_PI * (i % ZONES + 0.5) / ZONES;
		k->normal[i][0] = (float)sin(t);
		k->normal[i][2] = (float)-cos(t);
	}
	double worst = 0;
	for (int s = 0; s < COUNT(shell); s++) {
		double truth[ZONES];
		sclera_photons(truth, ZONES, &shell[s], bench_quick() ? 200000 : 2000000, 3);
		for (k->method = 0; k->method < METHODS; k->method++) {
			const struct bench_time each = bench_time_each(bench_time(shade, k, 9), NORMALS);
			static const struct { const char *part; int first, end; } parts[] = { { "lit side", 1, 15 }, { "terminator", 15, 21 }, { "dark side", 21, ZONES } };
			for (int i = 0; i < COUNT(parts); i++) {
				char setting[64];
				snprintf(setting, sizeof setting, "%s, %s", colours[s], parts[i].part);
				const double e = off(k, truth, parts[i].first, parts[i].end);
				bench_row("white of the eye under one lamp", names[k->method], setting, each, "normal", e, "%", "at worst, of the light overhead");
				worst = k->method == 0 ? fmax(worst, e) : worst;
			}
		}
	}
	bench_goal("white of the eye against photons: lit side, terminator, dark side", "<= 10 % of the light overhead", worst, "%", worst <= 10);
	envmap_free(&k->env);
	free(k);
	return bench_close();
}
