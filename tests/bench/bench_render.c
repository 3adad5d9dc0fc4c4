/* Whole frames: where their time goes, what bounds it, and their error against the converging reference. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/converge.h"
#include "draw/eye/march/shade.h"
#include "draw/eye/quick/hits.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/ridged.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // the rate of operations is that of the renderer's loops: see math/simd.h
#endif

// Beams of the presets, each of eight of the environment's directions.
enum { BEAMS = 12, BEAMS_DRAFT = 4 };

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
	struct scene_conf conf = ridged_conf(3, SCENE_EXPONENTIAL, SCENE_PATH_GRID);
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

static void turn_back(double eye_from_cam[3][3], const struct scene_view *view)
{
	for (int k = 0; k < 9; k++)
		eye_from_cam[k / 3][k % 3] = view->cam_from_eye[k % 3][k / 3];
}

static void parts_beams(void *ctx)
{
	struct parts *p = ctx;
	double eye_from_cam[3][3];
	turn_back(eye_from_cam, &p->frame->view);
	scene_beams_free(&p->beams);
	p->beams = scene_beams(p->frame->scene, p->frame->light, eye_from_cam);
}

static void parts_march(void *ctx)
{
	struct parts *p = ctx;
	struct scene_shade shade = scene_shade_make(p->frame->scene, p->level, p->C, &p->beams);
	free(shade.light);
}

static void parts_flat(void *ctx)
{
	struct parts *p = ctx;
	double eye_from_cam[3][3];
	turn_back(eye_from_cam, &p->frame->view);
	struct scene_shade shade = scene_shade_flat(p->frame->scene, p->level, p->frame->light, eye_from_cam);
	free(shade.light);
}

/* Seconds that limits are held against. */
static struct {
	double review, march, texture;
} taken;

static void parts_rows(const struct frame *f, const char *name, double all)
{
	struct parts p = { .frame = f, .level = &f->scene->level[0] };
	struct bench_time none = { NAN, NAN, NAN }, t[2] = { 0 };
	int reps = bench_quick() ? 3 : 15;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			p.C[j] -= f->view.cam_from_eye[i][j] * f->view.cam_from_eye[i][3];
	if (f->view.textured) {
		t[0] = bench_time(parts_flat, &p, reps);
		bench_row("where a frame's time goes", name, "light on the iris plane", t[0], "frame", 100 * t[0].median / all, "%", "of the frame");
	} else {
		t[0] = bench_time(parts_beams, &p, reps);
		t[1] = bench_time(parts_march, &p, reps);
		bench_row("where a frame's time goes", name, "the lights' tables", t[0], "frame", 100 * t[0].median / all, "%", "of the frame");
		bench_row("where a frame's time goes", name, "the march from texels", t[1], "frame", 100 * t[1].median / all, "%", "of the frame");
	}
	double rest = all - t[0].median - t[1].median;
	bench_row("where a frame's time goes", name, "rays, colours, memory", none, "frame", 1e3 * rest, "ms", "what is left");
	if (!f->view.textured && f->scene->conf.map_size == 1024) {
		taken.review = all;
		taken.march = t[1].median;
	}
	scene_beams_free(&p.beams);
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
	struct scene_conf conf = preset(draft);
	struct scene_lighting light = scene_lighting(env, env, draft ? BEAMS_DRAFT : BEAMS), one = scene_lighting(env, env, 1);
	if (!ridged_scene(&s, &conf))
		return;
	struct frame f = { .scene = &s, .view = filling(&s), .light = &light };
	scene_fit_colour(&s, &f.view, &light);
	struct bench_time t = frame_row(&f, draft ? "draft: 3 steps, 32 lights in 4" : "review: 3 steps, 96 lights in 12");
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
	struct scene_conf conf = preset(false), best = ridged_conf(16, SCENE_EXPONENTIAL, SCENE_PATH_ENDS);
	best.shadow = best.search = 32;
	best.bands = 6;
	if (!ridged_scene(&fast, &conf) || !ridged_scene(&slow, &best))
		return;
	struct scene_view view = scene_view_turned(&fast, 0.25, 0.15, 17.1, 1280);
	view.x0 = 780;  // all iris
	view.y0 = 690;
	view.width = view.height = N;
	double error;
	struct bench_time none = { NAN, NAN, NAN };
	struct image b = scene_converge(&slow, &view, env, 0, 64, bench_quick() ? 2 : PASSES, &error, 0);
	static const int beams[] = { BEAMS, 8, 16 };
	for (int k = 0; k < COUNT(beams); k++) {
		struct scene_lighting light = scene_lighting(env, 0, beams[k]);
		struct image a = scene_render(&fast, &view, &light, 0);
		struct judged j = judge(&a, &b);
		char setting[32];
		snprintf(setting, sizeof setting, "%d lights in %d beams", light.n, beams[k]);
		bench_row("against the reference", "review", setting, none, "frame", 100 * j.off, "%", "luminance in the iris, mean");
		bench_row("against the reference", "review", setting, none, "frame", 100 * j.wrong, "%", "pixels off by 5 %, away from edges");
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

/* Of the march, a texel: its span and nodes, and their exponents in each band; a beam laid over it; a node in a beam's light; its
 * colour. */
static double march_operations(void)
{
	const double texels = M_PI * (6.4 * 6.4 - 1.35 * 1.35) * 40 * 40, nodes = 3, beams = BEAMS, bands = 4;
	return texels * (70 + nodes * (45 + 9 * bands) + beams * (36 + nodes * (17 + 15 * bands) + 6 * bands));
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
	bench_row("limit", "the march: 3 steps, 12 beams, 4 bands", setting, (struct bench_time){ least, least, least }, "frame", taken.march / least, "times", "what the march takes");
	bench_row("limit", "operations of the march", "3 steps, 12 beams, 4 bands", (struct bench_time){ NAN, NAN, NAN }, "frame", march_operations() / 1e6, "million", "single precision");
	bench_row("limit", "review: both", "one after the other", (struct bench_time){ least + rays, least + rays, least + rays }, "frame", taken.review / (least + rays), "times", "what the frame takes");
	free(x);
	free(half[0]);
	free(half[1]);
}

int main(int argc, char **argv)
{
	bench_open("render", argc, argv);
	struct envmap env = ridged_room();
	frames(&env, false);
	frames(&env, true);
	if (!bench_quick())  // its reference takes as long as all the rest
		accuracy(&env);
	limit();
	envmap_free(&env);
	return bench_close();
}
