/* The march through the iris, the light's way to it, and whole frames: error against time of the same run. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "eye/scene_march.h"
#include "math/rng.h"
#include "optics/lightpath.h"
#include "tests/lib/bench.h"
#include "tests/lib/painted.h"

enum { BATCHES = 24, LIGHTS = 8 };

static const struct eye eye = { 7.8, 0.75, 1.336, 5.85, 1, 3.3, false, 6.5, 0.75, 0.55, 1.376 };
static const double id[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };

static struct scene_conf conf_of(int steps, int quadrature, int path)
{
	return (struct scene_conf){ .map_size = 1024, .search = 8, .shadow = 8, .steps = steps, .quadrature = quadrature,
		                        .path = path, .bands = 4, .detail = 1, .limbus_width = 0.4, .sclera_radius = 11.8,
		                        .sclera_rgb = { 0.7, 0.65, 0.6 }, .vein_density = 1, .veins_px = 512, .seed = 1 };
}

static void fibres(float rgb[3], double x, double y)
{
	double r = hypot(x, y), t = atan2(y, x), v = 0.3 + 0.12 * sin(40 * t + 3 * sin(2 * r)) * sin(5 * r);
	rgb[0] = (float)(0.7 * v);
	rgb[1] = (float)(0.9 * v);
	rgb[2] = (float)v;
}

static double ridges(double x, double y)
{
	double r = hypot(x, y), t = atan2(y, x);
	return 0.05 * sin(40 * t + 3 * sin(2 * r)) * sin(5 * r) + 0.06 * exp(-(r - 3) * (r - 3) / 0.1);
}

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
	struct err err = { 0 };
	if (!painted_scene(&w->scene, 1024, &eye, conf, fibres, ridges, 1.6, &err)) {
		fprintf(stderr, "bench_render: %s\n", err.msg);
		return false;
	}
	w->beams = scene_beams(&w->scene, light, id);
	rays(w);
	return true;
}

static void work_free(struct work *w)
{
	free(w->batches);
	free(w->beams.beam);
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
	struct scene_conf conf = conf_of(256, SCENE_GAUSS, SCENE_PATH_ENDS);
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
	struct scene_conf conf = conf_of(6, SCENE_GAUSS, SCENE_PATH_GRID);
	row("march", "texture without scattering", "no steps", &conf, true, light, reference);
	for (int i = 0; i < COUNT(steps); i += bench_quick() ? 2 : 1) {
		char setting[32];
		snprintf(setting, sizeof setting, "%d steps", steps[i]);
		conf = conf_of(steps[i], SCENE_MIDPOINT, SCENE_PATH_GRID);
		row("march", "half-step rule in each layer", setting, &conf, false, light, reference);
		conf = conf_of(steps[i], SCENE_GAUSS, SCENE_PATH_GRID);
		row("march", "Gauss-Legendre in each layer", setting, &conf, false, light, reference);
		conf = conf_of(steps[i], SCENE_EXPONENTIAL, SCENE_PATH_GRID);
		double error = row("march", "Gauss for fading light", setting, &conf, false, light, reference);
		if (steps[i] == 3)
			bench_goal("iris march, 3 steps of Gauss's rule for fading light", "<= 0.5 % against 256 steps", error, "%", error <= 0.5);
	}
}

static void paths(const struct scene_lighting *light, const struct iris_batch *reference)
{
	struct scene_conf conf = conf_of(16, SCENE_GAUSS, SCENE_PATH_ENDS);
	row("light path", "solved at both ends of each ray", "4 Newton steps", &conf, false, light, reference);
	conf = conf_of(16, SCENE_GAUSS, SCENE_PATH_GRID);
	row("light path", "a table of the light's own", "48 x 48 x 2", &conf, false, light, reference);
}

/* The table against the solver: direction and irradiance of the light on the relief. */
static void table_error(const struct scene_lighting *light)
{
	struct work w = { 0 };
	struct scene_conf conf = conf_of(6, SCENE_GAUSS, SCENE_PATH_GRID);
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

struct frame {
	const struct scene *scene;
	struct scene_view view;
	const struct scene_lighting *light;
	struct image image;
	struct scene_count count;
};

static void frame_render(void *ctx)
{
	struct frame *f = ctx;
	image_free(&f->image);
	f->count = (struct scene_count){ 0 };
	f->image = scene_render(f->scene, &f->view, f->light, &f->count);
}

/* Presets as config/render.conf has them, less the rays added at edges. */
static struct scene_conf preset(bool draft)
{
	struct scene_conf conf = conf_of(3, SCENE_EXPONENTIAL, SCENE_PATH_GRID);
	conf.apart = draft ? 4 : 2;
	conf.shading = SCENE_TEXELS;
	conf.bands = draft ? 3 : 4;
	conf.map_size = draft ? 512 : 1024;
	conf.shadow = draft ? 0 : 4;
	return conf;
}

static struct scene_view filling(const struct scene *s)
{
	struct scene_view view = scene_view_turned(s, 0, 0, 17.1, 1280);
	view.y0 = 128;
	view.height = 1024;
	return view;
}

/* Where a frame's time goes before its rays: the lights' tables, and the march from the map's texels. */
struct parts {
	const struct frame *frame;
	const struct scene_level *level;
	struct scene_beams beams;
	double C[3];
};

static void parts_beams(void *ctx)
{
	struct parts *p = ctx;
	double eye_from_cam[3][3];
	for (int k = 0; k < 9; k++)
		eye_from_cam[k / 3][k % 3] = p->frame->view.cam_from_eye[k % 3][k / 3];
	free(p->beams.beam);
	p->beams = scene_beams(p->frame->scene, p->frame->light, eye_from_cam);
}

static void parts_march(void *ctx)
{
	struct parts *p = ctx;
	struct scene_shade shade = scene_shade_make(p->frame->scene, p->level, p->C, p->frame->view.textured, &p->beams);
	free(shade.light);
}

/* Seconds that limits are held against. */
static struct {
	double review, march, texture;
} taken;

static void parts_rows(const struct frame *f, const char *name, double all)
{
	struct parts p = { .frame = f, .level = &f->scene->level[0] };
	struct bench_time none = { NAN, NAN, NAN }, t[2];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			p.C[j] -= f->view.cam_from_eye[i][j] * f->view.cam_from_eye[i][3];
	t[0] = bench_time(parts_beams, &p, bench_quick() ? 3 : 15);
	t[1] = bench_time(parts_march, &p, bench_quick() ? 3 : 15);
	bench_row("where a frame's time goes", name, "the lights' tables", t[0], "frame", 100 * t[0].median / all, "%", "of the frame");
	bench_row("where a frame's time goes", name, "the march from texels", t[1], "frame", 100 * t[1].median / all, "%", "of the frame");
	double rest = all - t[0].median - t[1].median;
	bench_row("where a frame's time goes", name, "rays, colours, memory", none, "frame", 1e3 * rest, "ms", "what is left");
	if (!f->view.textured && f->scene->conf.map_size == 1024) {
		taken.review = all;
		taken.march = t[1].median;
	}
	free(p.beams.beam);
}

static struct bench_time frame_row(struct frame *f, const char *name)
{
	struct bench_time t = bench_time(frame_render, f, bench_quick() ? 3 : 15);
	char setting[32];
	snprintf(setting, sizeof setting, "%d threads", omp_get_max_threads());
	bench_row("frame, 1280 x 1024", name, setting, t, "frame", 1280 * 1024 / t.median / 1e6, "Mray/s", "speed");
	return t;
}

/* 1280 x 1024, the cornea on 47 % of the pixels, all threads. Every frame is a first one: nothing is kept from the one before,
 * neither lights nor march, except where the row says that only a light moved. */
static void frames(const struct envmap *env, bool draft)
{
	struct scene s;
	struct err err = { 0 };
	struct scene_conf conf = preset(draft);
	struct scene_lighting light = scene_lighting(env, env, draft ? 4 : 8), one = scene_lighting(env, env, 1);
	if (!painted_scene(&s, 1024, &eye, &conf, fibres, ridges, 1.6, &err))
		return;
	struct frame f = { .scene = &s, .view = filling(&s), .light = &light };
	scene_fit_colour(&s, &f.view, &light);
	struct bench_time t = frame_row(&f, draft ? "draft: 3 steps, 32 lights in 4" : "review: 3 steps, 64 lights in 8");
	double ms = 1e3 * t.median;
	parts_rows(&f, draft ? "draft" : "review", t.median);
	if (draft) {
		bench_goal("draft preset, eye filling 1280 x 1024", "<= 8.3 ms (120 frames/s)", ms, "ms", ms <= 8.3);
	} else {
		bench_goal("review preset, eye filling 1280 x 1024", "<= 16.7 ms (60 frames/s)", ms, "ms", ms <= 16.7);
		f.light = &one;
		t = frame_row(&f, "3 steps, lights in one");
		bench_goal("iris march, one light", "<= 16.7 ms a frame", 1e3 * t.median, "ms", 1e3 * t.median <= 16.7);
		f.light = &light;
		f.view.textured = true;
		t = frame_row(&f, "refraction, texture and Fresnel");
		parts_rows(&f, "texture", t.median);
		taken.texture = t.median;
		bench_goal("refraction, texture and Fresnel", "<= 4 ms a frame", 1e3 * t.median, "ms", 1e3 * t.median <= 4);
		f.view.textured = false;
		f.view.hits = scene_hits_new();
		t = frame_row(&f, "review, only a light moved");
		bench_goal("first rays traced again where only a light moves", "0", (double)f.count.rays, "", f.count.rays == 0);
		scene_hits_free(f.view.hits);
		f.view.hits = 0;
		f.view.visible = mem_new(1280 * 1024, 1);
		t = frame_row(&f, "review, lids closed");
		bench_goal("a closed eye", "< 10 % of an open one", 1e5 * t.median / ms, "%", 1e5 * t.median < 10 * ms);
		free((void *)f.view.visible);
	}
	image_free(&f.image);
	scene_free(&s);
}

static double luminance(const float *p)
{
	return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/* Smooth in the reference: its neighbours within 5 %. */
static bool away_from_edges(const struct image *image, int x, int y)
{
	double l = luminance(image_at(image, x, y));
	for (int k = 0; k < 9; k++)
		if (fabs(luminance(image_at(image, x + k % 3 - 1, y + k / 3 - 1)) - l) > 0.05 * l)
			return false;
	return true;
}

struct judged {
	double off, wrong;  // mean, and pixels away from edges that differ by more than 5 %; shares
};

static struct judged judge(const struct image *a, const struct image *b)
{
	double off = 0, all = 0, smooth = 0, wrong = 0;
	for (int y = 1; y < b->height - 1; y++)
		for (int x = 1; x < b->width - 1; x++) {
			double u = luminance(image_at(a, x, y)), v = luminance(image_at(b, x, y));
			bool counts = away_from_edges(b, x, y);
			off += fabs(u - v);
			all += v;
			smooth += counts;
			wrong += counts && fabs(u - v) > 0.05 * v;
		}
	return (struct judged){ off / all, wrong / smooth };
}

/* The review preset against the converging reference (area lights, 16 steps along every ray, light's way exact at both ends),
 * in a window of the iris at the frame's scale, without what the cornea mirrors, and without the albedo step: the factors that
 * it gives to texels are the same for both, but were they fitted under few directions for the one and many for the other,
 * their difference would be counted as the picture's. */
static void accuracy(const struct envmap *env)
{
	enum { N = 120, PASSES = 32 };
	struct scene fast, slow;
	struct err err = { 0 };
	struct scene_conf conf = preset(false), best = conf_of(16, SCENE_EXPONENTIAL, SCENE_PATH_ENDS);
	best.shadow = best.search = 32;
	best.bands = 6;
	if (!painted_scene(&fast, 1024, &eye, &conf, fibres, ridges, 1.6, &err) || !painted_scene(&slow, 1024, &eye, &best, fibres, ridges, 1.6, &err))
		return;
	struct scene_view view = scene_view_turned(&fast, 0.25, 0.15, 17.1, 1280);
	view.x0 = 780;  // all iris
	view.y0 = 690;
	view.width = view.height = N;
	double error;
	struct bench_time none = { NAN, NAN, NAN };
	struct image b = scene_converge(&slow, &view, env, 0, 64, bench_quick() ? 2 : PASSES, &error, 0);
	for (int k = 0; k < 2; k++) {
		struct scene_lighting light = scene_lighting_of(env, 0, k ? 16 : 8, k ? 4 : 8);
		struct image a = scene_render(&fast, &view, &light, 0);
		struct judged j = judge(&a, &b);
		bench_row("against the reference", "review", k ? "64 lights in 16 beams" : "64 lights in 8 beams", none, "frame", 100 * j.off, "%", "luminance in the iris, mean");
		bench_row("against the reference", "review", k ? "64 lights in 16 beams" : "64 lights in 8 beams", none, "frame", 100 * j.wrong, "%", "pixels off by 5 %, away from edges");
		if (!k) {
			bench_goal("review against the converged reference", "<= 1 % mean luminance in the iris", 100 * j.off, "%", j.off <= 0.01);
			bench_goal("review against the converged reference, away from edges", "no pixel off by 5 %", 100 * j.wrong, "% of pixels", j.wrong == 0);
		}
		image_free(&a);
	}
	bench_row("against the reference", "the reference itself", "64 lights drawn 32 times", none, "frame", 100 * error, "%", "standard error");
	image_free(&b);
	scene_free(&fast);
	scene_free(&slow);
}

/* What bounds a frame, measured in the same run: bytes that must come from memory (a copy of as many is timed), and operations at
 * the rate at which polynomials are evaluated on all threads. */
static void copy_bytes(void *ctx)
{
	char **half = ctx;
	memcpy(half[0], half[1], 24L << 20);
}

enum { POINTS = 1 << 16, DEGREE = 16, ROUNDS = 64 };

SIMD_CLONES static void polynomials(float *restrict x, float a)
{
	SIMD_LOOP
	for (int i = 0; i < 256; i++) {
		float y = x[i];
#pragma GCC unroll 16
		for (int k = 0; k < DEGREE; k++)
			y = y * a + 0.25f;
		x[i] = y;
	}
}

static void calculate(void *ctx)
{
	float *x = ctx;
#pragma omp parallel for schedule(static)
	for (int k = 0; k < POINTS / 256; k++)
		for (int i = 0; i < ROUNDS; i++)
			polynomials(x + 256 * k, 0.5f);
}

/* Of the march, a texel: its span and nodes; a beam laid over it; a node in a beam's light; its colour. */
static double march_operations(void)
{
	const double texels = M_PI * (6.4 * 6.4 - 1.35 * 1.35) * 40 * 40, nodes = 3, beams = LIGHTS, bands = 4;
	return texels * (70 + 45 * nodes + beams * (52 + nodes * (16 + 17 * bands) + 6 * bands));
}

static void limit(void)
{
	// Picture 21 MB written; of the iris 0.6 of colours and heights (8.4 + 4.2 MB) and of its light (4.2 MB), and the sclera's
	// map (2 MB) read.
	char *half[2] = { mem_new(24L << 20, 1), mem_new(24L << 20, 1) }, setting[64];
	float *x = mem_new(POINTS, sizeof *x);
	struct bench_time t = bench_time(copy_bytes, half, 5), u = bench_time(calculate, x, 5);
	double bytes = 33e6 / (48e6 / t.median), rate = 2.0 * DEGREE * ROUNDS * POINTS / u.median, least = march_operations() / rate;
	bench_row("limit", "bytes: 21 MB written, 12 MB read", "a copy of 24 MB, one core", t, "frame", 48e-3 / t.median, "GB/s", "memory");
	// A pixel behind the cornea: its place between nodes and on the relief 62, in the map 15, two texels' lerps and unpacking 48;
	// one of the white 80.
	double rays = 1280 * 1024 * (0.47 * 125 + 0.53 * 80) / rate + bytes;
	bench_row("limit", "refraction, texture and Fresnel: bytes, 130 million operations", "one after the other", (struct bench_time){ rays, rays, rays }, "frame", taken.texture / rays, "times", "what the frame takes");
	snprintf(setting, sizeof setting, "%.1f G operations/s, %d threads", 1e-9 * rate, omp_get_max_threads());
	bench_row("limit", "the march: 3 steps, 8 beams, 4 bands", setting, (struct bench_time){ least, least, least }, "frame", taken.march / least, "times", "what the march takes");
	bench_row("limit", "operations of the march", "3 steps, 8 beams, 4 bands", (struct bench_time){ NAN, NAN, NAN }, "frame", march_operations() / 1e6, "million", "single precision");
	bench_row("limit", "review: both", "one after the other", (struct bench_time){ least + rays, least + rays, least + rays }, "frame", taken.review / (least + rays), "times", "what the frame takes");
	free(x);
	free(half[0]);
	free(half[1]);
}

int main(int argc, char **argv)
{
	bench_open("render", argc, argv);
	struct envmap_box box[2] = { { { -0.48, -0.6, -0.64 }, { 0.15, 0.2 }, { 25, 25, 25 } },
		                         { { 0.7, -0.1, -0.7071 }, { 0.1, 0.2 }, { 10, 10, 11 } } };
	struct envmap env = envmap_room(128, (double[3]){ 0.6, 0.6, 0.7 }, (double[3]){ 0.2, 0.2, 0.2 }, 0.5, 2, box);
	envmap_normalise(&env);
	struct scene_lighting light = { .env = &env, .mirror = &env, .n = 0 };  // every direction a beam of its own
	light.n = envmap_lights(light.light, LIGHTS, &env);
	struct iris_batch *reference = reference_make(&light);
	if (reference) {
		marches(&light, reference);
		paths(&light, reference);
		table_error(&light);
		frames(&env, false);
		frames(&env, true);
		if (!bench_quick())  // its reference takes as long as all the rest
			accuracy(&env);
		limit();
	}
	free(reference);
	envmap_free(&env);
	return bench_close();
}
