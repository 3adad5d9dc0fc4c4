/* The march along rays of sight through the iris and the light's way to it: error against time of the same run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/march/march.h"
#include "math/rng.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/ridged.h"
#include "tests/peers/lightpath_gain.h"

enum { BATCHES = 24, LIGHTS = 8 };

static const double id[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };

struct work {
	struct scene scene;
	struct scene_beams beams;
	struct iris_batch *batches;  // BATCHES rays of sight, met with the relief
};

static void rays(struct work *w)
{
	struct rng rng = { 21 };
	w->batches = mem_new(BATCHES, sizeof *w->batches);
	for (int k = 0; k < BATCHES; k++) {
		struct iris_batch *b = &w->batches[k];
		b->n = BATCH;
		for (int i = 0; i < BATCH; i++) {
			double r = sqrt(rng_range(&rng, 3, 25)), t = rng_range(&rng, 0, 2 * M_PI), a = rng_range(&rng, 0, 0.5), f = rng_range(&rng, 0, 6.28);
			b->vx[i] = (float)(sin(a) * cos(f));
			b->vy[i] = (float)(sin(a) * sin(f));
			b->vz[i] = (float)cos(a);
			b->fx[i] = (float)(r * cos(t)) - 2 * b->vx[i];
			b->fy[i] = (float)(r * sin(t)) - 2 * b->vy[i];
			b->fz[i] = 3.3f - 2 * b->vz[i];
		}
		scene_meet(b, &w->scene, &w->scene.level[0]);
	}
}

static bool work_make(struct work *w, const struct scene_conf *conf, const struct scene_lighting *light)
{
	if (!ridged_scene(&w->scene, conf))
		return false;
	w->beams = scene_beams(&w->scene, light, id);
	rays(w);
	return true;
}

static void work_free(struct work *w)
{
	free(w->batches);
	scene_beams_free(&w->beams);
	scene_free(&w->scene);
}

static void scatter_all(void *ctx)
{
	struct work *w = ctx;
	for (int k = 0; k < BATCHES; k++)
		scene_scatter(&w->batches[k], &w->scene, &w->scene.level[0], &w->beams);
}

static void flat_all(void *ctx)
{
	struct work *w = ctx;
	for (int k = 0; k < BATCHES; k++)
		scene_flat(&w->batches[k], &w->scene, &w->beams);
}

/* Mean difference of the colours, relative to the reference's mean. */
static double differs(const struct work *w, const struct iris_batch *reference)
{
	double sum = 0, all = 0;
	for (int k = 0; k < BATCHES; k++)
		for (int c = 0; c < 3; c++)
			for (int i = 0; i < BATCH; i++) {
				sum += fabs(w->batches[k].rgb[c][i] - reference[k].rgb[c][i]);
				all += reference[k].rgb[c][i];
			}
	return 100 * sum / all;
}

static struct bench_time each(struct bench_time t, double n)
{
	return (struct bench_time){ t.median / n, t.low / n, t.high / n };
}

static struct iris_batch *reference_make(const struct scene_lighting *light)
{
	struct work w = { 0 };
	struct scene_conf conf = ridged_conf(256, SCENE_GAUSS, SCENE_PATH_ENDS);
	if (!work_make(&w, &conf, light))
		return 0;
	scatter_all(&w);
	struct iris_batch *reference = w.batches;
	w.batches = 0;
	work_free(&w);
	return reference;
}

/* One row; the time of a ray with its eight lights, one thread. Returns the error. */
static double row(const char *table, const char *method, const char *setting, const struct scene_conf *conf, bool flat,
                  const struct scene_lighting *light, const struct iris_batch *reference)
{
	struct work w = { 0 };
	if (!work_make(&w, conf, light))
		return NAN;
	struct bench_time t = bench_time(flat ? flat_all : scatter_all, &w, bench_quick() ? 3 : 9);
	double error = differs(&w, reference);
	bench_row(table, method, setting, each(t, BATCHES * BATCH), "ray", error, "%", "colour, mean, against 256 steps");
	work_free(&w);
	return error;
}

static void marches(const struct scene_lighting *light, const struct iris_batch *reference)
{
	static const int steps[] = { 3, 4, 6, 8, 16, 32 };
	struct scene_conf conf = ridged_conf(6, SCENE_GAUSS, SCENE_PATH_GRID);
	row("march", "texture without scattering", "no steps", &conf, true, light, reference);
	for (int i = 0; i < COUNT(steps); i += bench_quick() ? 2 : 1) {
		char setting[32];
		snprintf(setting, sizeof setting, "%d steps", steps[i]);
		conf = ridged_conf(steps[i], SCENE_MIDPOINT, SCENE_PATH_GRID);
		row("march", "half-step rule in each layer", setting, &conf, false, light, reference);
		conf = ridged_conf(steps[i], SCENE_GAUSS, SCENE_PATH_GRID);
		row("march", "Gauss-Legendre in each layer", setting, &conf, false, light, reference);
		conf = ridged_conf(steps[i], SCENE_EXPONENTIAL, SCENE_PATH_GRID);
		double error = row("march", "Gauss for fading light", setting, &conf, false, light, reference);
		if (steps[i] == 3)
			bench_goal("iris march, 3 steps of Gauss's rule for fading light", "<= 0.5 % against 256 steps (first worded: 8 half steps, <= 0.78 %)", error, "%", error <= 0.5);
	}
}

static void paths(const struct scene_lighting *light, const struct iris_batch *reference)
{
	struct scene_conf conf = ridged_conf(16, SCENE_GAUSS, SCENE_PATH_ENDS);
	row("light path", "solved at both ends of each ray", "4 Newton steps", &conf, false, light, reference);
	conf = ridged_conf(16, SCENE_GAUSS, SCENE_PATH_GRID);
	row("light path", "a table of the light's own", "48 x 48 x 2", &conf, false, light, reference);
}

/* The table against the solver: direction and irradiance of the light on the relief. */
static void table_error(const struct scene_lighting *light)
{
	struct work w = { 0 };
	struct scene_conf conf = ridged_conf(6, SCENE_GAUSS, SCENE_PATH_GRID);
	double off = 0, worst = 0, power = 0, all = 0, n = 0;
	if (!work_make(&w, &conf, light))
		return;
	for (int l = 0; l < w.beams.n; l++)
		for (int k = 0; k < BATCHES * BATCH / PART; k++) {
			const struct iris_batch *b = &w.batches[k * PART / BATCH];
			int first = k * PART % BATCH;
			double dir[3] = { w.beams.beam[l].dir[0], w.beams.beam[l].dir[1], w.beams.beam[l].dir[2] }, K[3];
			struct march_light at;
			scene_light_at(&at, 0, PART, b->px + first, b->py + first, b->pz + first, &w.scene, &w.beams.beam[l]);
			for (int i = 0; i < PART; i++) {
				double P[3] = { b->px[first + i], b->py[first + i], b->pz[first + i] };
				if (lightpath_solve_directional(K, &w.scene.cornea, P, dir) != LIGHTPATH_OK || hypot(K[0], K[1]) > 5.6)
					continue;
				double d[3] = { K[0] - P[0], K[1] - P[1], K[2] - P[2] }, len = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
				double e = hypot(hypot(at.x[0][i] - d[0] / len, at.y[0][i] - d[1] / len), at.z[0][i] - d[2] / len);
				off += e;
				worst = fmax(worst, e);
				double gain = lightpath_gain(&w.scene.cornea, P, dir, K);
				power += fabs(-at.power[0][i] * at.z[0][i] - gain);
				all += gain;
				n++;
			}
		}
	struct bench_time none = { NAN, NAN, NAN };
	bench_row("a light's table", "table", "48 x 48 x 2", none, "point", 1e3 * off / n, "mrad", "direction, mean");
	bench_row("a light's table", "table", "48 x 48 x 2", none, "point", 1e3 * worst, "mrad", "direction, worst");
	bench_row("a light's table", "table", "48 x 48 x 2", none, "point", 100 * power / all, "%", "irradiance, mean");
	work_free(&w);
}

int main(int argc, char **argv)
{
	bench_open("march", argc, argv);
	struct envmap env = ridged_room();
	struct scene_lighting light = { .env = &env, .mirror = &env, .n = 0 };  // every direction a beam of its own
	light.n = envmap_lights(light.light, LIGHTS, &env);
	struct iris_batch *reference = reference_make(&light);
	if (reference) {
		marches(&light, reference);
		paths(&light, reference);
		table_error(&light);
	}
	free(reference);
	envmap_free(&env);
	return bench_close();
}
