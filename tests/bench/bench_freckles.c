/* Freckles: found against what a renderer painted; and painting over them against OpenCV's inpainting: holes are cut
 * into irides without cornea, where what was there is known.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_inpaint.h"
#include "image/plane.h"
#include "math/rng.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/iris.h"

enum { CAPTURES = 64, HOLES = 10, METHODS = 4 };
static const char *const method_names[METHODS] = { "pattern from the iris", "Telea (OpenCV)", "Navier-Stokes (OpenCV)",
	                                               "harmonic" };

/* The folder whose textures and masks hold for a capture: G03, G05 and G07 are G01's eye. */
static const char *eye_dir(char *const dirs[], int n, int i)
{
	for (int k = 3; k <= 7; k += 2) {
		char name[8];
		snprintf(name, sizeof name, "/G%02d", k);
		for (int j = 0; j < n && strstr(dirs[i], name); j++)
			if (strstr(dirs[j], "/G01"))
				return dirs[j];
	}
	return dirs[i];
}

struct search {
	struct unrefract_texture texture;
	double limbus;
	struct freckle_conf conf;
	struct freckles found;
};

static void search(void *ctx)
{
	struct search *s = ctx;
	freckles_free(&s->found);
	s->found = freckles_find(&s->texture.rgbw, s->texture.extent, &s->texture.pupil, s->limbus, &s->conf);
}

static void finding(int n, char *const dirs[])
{
	struct unrefract_conf how = iris_unrefract_conf("review");
	double worst = INFINITY;
	int wrong = 0, with = 0, without = 0;
	for (int i = 0; i < n; i++) {
		struct search s = { .conf = iris_freckle_conf("review") };
		struct unrefract_view view;
		struct truth truth;
		struct fit fit;
		struct err err = { 0 };
		if ((bench_quick() && i % 2) || !truth_load(&truth, dirs[i], &err) || !iris_texture(&s.texture, &view, &fit, &truth, &how, &err))
			continue;
		s.limbus = truth.eye.limbus_radius;
		struct bench_time t = bench_time(search, &s, bench_quick() ? 1 : 2);
		int size = s.texture.rgbw.width;
		uint8_t *painted = iris_freckle_mask(&truth, eye_dir(dirs, n, i), size, s.texture.extent, true);
		double overlap = painted ? iris_freckle_overlap(&s.found, painted, &s.texture.rgbw) : NAN;
		bench_row("finding freckles", "by pigment", truth.name, t, "texture", 1 - overlap, "",
		          "1 - intersection over union");
		bool none = true;
		for (long k = 0; painted && k < (long)size * size; k++)
			none &= !painted[k] || s.texture.rgbw.px[4 * k + 3] <= 0.05f;
		if (painted && none) {
			wrong += s.found.n;
			without++;
		} else if (painted) {
			worst = fmin(worst, overlap);
			with++;
		}
		free(painted);
		freckles_free(&s.found);
		image_free(&s.texture.rgbw);
		unrefract_view_free(&view);
	}
	if (with)
		bench_goal("freckle mask, worst capture: intersection over union", ">= 0.7", worst, "", worst >= 0.7);
	if (without)
		bench_goal("false regions on freckle-free eyes", "none", wrong, "", !wrong);
}

struct fill {
	struct image original, work;
	uint8_t *mask, *rgb8, *work8;
	double extent;
	struct circle pupil;
	double limbus;
	struct freckle_conf conf;
	int method;
};

static void run_fill(void *ctx)
{
	struct fill *f = ctx;
	int size = f->original.width;
	struct err err = { 0 };
	if (f->method == 0) {
		memcpy(f->work.px, f->original.px, (size_t)size * (size_t)size * 4 * sizeof(float));
		freckle_fill(&f->work, f->mask, f->extent, &f->pupil, f->limbus, &f->conf);
	} else if (f->method == 3) {
		// without anywhere to copy from, the fill is the harmonic function of its rim
		for (long i = 0; i < (long)size * size; i++)
			for (int c = 0; c < 3; c++)
				f->work.px[4 * i + c] = f->mask[i] ? 0 : f->original.px[4 * i + c];
		struct freckle_conf nowhere = f->conf;
		nowhere.candidates = 0;
		freckle_fill(&f->work, f->mask, f->extent, &f->pupil, f->limbus, &nowhere);
	} else {
		memcpy(f->work8, f->rgb8, (size_t)size * (size_t)size * 3);
		cv_inpaint(f->work8, f->mask, size, size, 5, f->method == 1 ? CV_INPAINT_TELEA : CV_INPAINT_NAVIER_STOKES, &err);
		for (long i = 0; i < (long)size * size; i++)
			for (int c = 0; c < 3 && f->mask[i]; c++)
				f->work.px[4 * i + c] = linear_from_srgb(f->work8[3 * i + c] / 255.0f);
	}
}

/* Energy of the fine structure and error in the holes, of log green. */
struct quality {
	double rms, contrast;
};

static struct quality judge(const struct fill *f)
{
	int size = f->original.width;
	double sum = 0, own = 0, true_ = 0;
	long n = 0;
	for (int y = 1; y + 1 < size; y++)
		for (int x = 1; x + 1 < size; x++) {
			long i = (long)y * size + x;
			if (!f->mask[i])
				continue;
			double a[5], b[5];
			const long at[5] = { i, i - 1, i + 1, i - size, i + size };
			for (int k = 0; k < 5; k++) {
				a[k] = log(fmax(f->work.px[4 * at[k] + 1], 1e-4));
				b[k] = log(fmax(f->original.px[4 * at[k] + 1], 1e-4));
			}
			sum += (a[0] - b[0]) * (a[0] - b[0]);
			own += (a[2] - a[1]) * (a[2] - a[1]) + (a[4] - a[3]) * (a[4] - a[3]);
			true_ += (b[2] - b[1]) * (b[2] - b[1]) + (b[4] - b[3]) * (b[4] - b[3]);
			n++;
		}
	return (struct quality){ n ? sqrt(sum / (double)n) : NAN, sqrt(own / fmax(true_, 1e-12)) };
}

/* Rows of one table have to follow one another: the second table waits. */
struct result {
	char setting[96];
	int method;
	struct bench_time time;
	struct quality quality;
};
struct results {
	int n;
	struct result items[64];
};

/* Ragged holes of one radius all round the ciliary part, clear of painted freckles. */
static void cut_holes(struct fill *f, const uint8_t *painted, double radius, uint64_t seed)
{
	int size = f->original.width;
	struct rng rng = { seed };
	memset(f->mask, 0, (size_t)size * (size_t)size);
	double mm = 2 * f->extent / size;
	for (int k = 0; k < HOLES; k++) {
		double phi = 2 * M_PI * (k + 0.6 * rng_uniform(&rng)) / HOLES, lobes = floor(3 + 4 * rng_uniform(&rng));
		double r = f->pupil.r + (0.3 + 0.5 * rng_uniform(&rng)) * (f->limbus - f->pupil.r), turn = 6 * rng_uniform(&rng);
		double cx = r * cos(phi), cy = r * sin(phi);
		bool clear = true;
		for (int pass = 0; pass < 2; pass++)
			for (int y = (int)((cy - 2 * radius + f->extent) / mm); y <= (cy + 2 * radius + f->extent) / mm; y++)
				for (int x = (int)((cx - 2 * radius + f->extent) / mm); x <= (cx + 2 * radius + f->extent) / mm; x++) {
					double dx = (x + 0.5) * mm - f->extent - cx, dy = (y + 0.5) * mm - f->extent - cy;
					double edge = radius * (1 + 0.25 * sin(lobes * atan2(dy, dx) + turn));
					long i = (long)y * size + x;
					clear &= pass || !painted || !painted[i];
					if (pass && clear && hypot(dx, dy) < edge)
						f->mask[i] = 1;
				}
	}
}

static void filling(struct results *results, const char *dir)
{
	struct truth truth;
	struct err err = { 0 };
	int size = bench_quick() ? 640 : 1024;
	struct fill f = { .conf = iris_freckle_conf("review") };
	if (!truth_load(&truth, dir, &err) || !iris_painted(&f.original, &f.extent, &truth, dir, size))
		return;
	uint8_t *painted = iris_freckle_mask(&truth, dir, size, f.extent, false);
	f.pupil = (struct circle){ 0, 0, truth.pupil_radius };
	f.limbus = truth.iris_radius;
	f.work = image_new(size, size, 4);
	f.mask = mem_new((size_t)size * (size_t)size, 1);
	struct image rgb = image_new(size, size, 3);
	for (long i = 0; i < (long)size * size; i++)
		memcpy(rgb.px + 3 * i, f.original.px + 4 * i, 3 * sizeof(float));
	f.rgb8 = image_to_srgb8(&rgb);
	f.work8 = mem_array((size_t)size * (size_t)size * 3, 1);
	static const double radii[] = { 0.1, 0.25, 0.5 };
	double ours = 0, best_other = INFINITY;
	for (int r = 0; r < COUNT(radii); r++) {
		cut_holes(&f, painted, radii[r], 7 + (uint64_t)r);
		char text[96];
		snprintf(text, sizeof text, "%s, radius %g mm", truth.name, radii[r]);
		for (f.method = 0; f.method < METHODS; f.method++) {
			memcpy(f.work.px, f.original.px, (size_t)size * (size_t)size * 4 * sizeof(float));
			struct bench_time t = bench_time(run_fill, &f, bench_quick() ? 1 : 2);
			t.median /= HOLES, t.low /= HOLES, t.high /= HOLES;
			struct quality q = judge(&f);
			struct result *kept = &results->items[results->n++];
			*kept = (struct result){ .method = f.method, .time = t, .quality = q };
			memcpy(kept->setting, text, sizeof text);
			bench_row("painting over", method_names[f.method], text, t, "freckle", q.rms, "", "log green, rms");
			if (r == 2 && !f.method)
				ours = fabs(log(q.contrast));
			else if (r == 2)
				best_other = fmin(best_other, fabs(log(q.contrast)));
		}
	}
	char measure[160];
	snprintf(measure, sizeof measure, "%s, 0.5 mm freckles: fibres' contrast kept, |log|, against the best other %.2f",
	         truth.name, best_other);
	bench_goal(measure, "less", ours, "", ours < best_other);
	image_free(&rgb);
	image_free(&f.original);
	image_free(&f.work);
	free(f.mask);
	free(f.rgb8);
	free(f.work8);
	free(painted);
}

int main(int argc, char **argv)
{
	bench_open("freckles", argc, argv);
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES);
	finding(n, dirs);
	static struct results results;
	for (int i = 0; i < n; i++)
		if (strstr(dirs[i], "/G01") || ((strstr(dirs[i], "/G08") || strstr(dirs[i], "/L02")) && !bench_quick()))
			filling(&results, dirs[i]);
	for (int i = 0; i < results.n; i++)
		bench_row("fibres painted", method_names[results.items[i].method], results.items[i].setting, results.items[i].time,
		          "freckle", fabs(log(results.items[i].quality.contrast)), "", "|log| of fine contrast over the true");
	for (int i = 0; i < n; i++)
		free(dirs[i]);
	return bench_close();
}
