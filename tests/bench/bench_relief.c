/* relief: patches of blue, green and brown iris of known relief, photographed by Monte Carlo; relief from that picture without a
 * filter (the paper's coarse height field), with the filter fitted on a rendering that darkens no hollows, with that filter as it is meant, and the most
 * probable relief under the known light, which is shipped. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "tissue/light/iris_light.h"
#include "tissue/relief/infer.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/irisphantom.h"

enum { PATCH = 48, SIZE = 1024, LIT = 8 };
static const double white[3] = { 1, 1, 1 }, root = 6;
static const struct pupil point = { 0, 0, 0.001 };
static const struct pigment_conf pigment = {
	.abl_thickness = 0.04, .cos_light = 0.84, .cos_view = 1, .bands = 4, .multiple = true
};

struct run {
	const struct irisphantom *patch;   // as texture of SIZE x SIZE
	const struct image *clean, *coarse;
	const double *x;
	struct relief_conf conf;
	struct relief_fit fit;
	const struct image *lit;
	struct infer_fit infer;
	struct image sharp;
};

static struct image larger(const struct image *in)
{
	struct image out = image_new(SIZE, SIZE, in->channels);
	struct err err = { 0 };
	cv_resize(out.px, SIZE, SIZE, in->px, in->width, in->height, in->channels, &err);
	return out;
}

static void filter(void *ctx)
{
	struct run *r = ctx;
	struct err err = { 0 };
	image_free(&r->sharp);
	if (!relief_solve(&r->fit, r->clean, r->coarse, r->patch->extent, &point, root, white, r->x, &pigment, &r->conf, &err)
	    || !relief_apply(&r->sharp, r->coarse, r->patch->extent, &r->fit, &r->conf, &err)) {
		fprintf(stderr, "bench_relief: %s\n", err.msg);
		exit(1);
	}
}

/* As in config/relief.conf. */
static const struct infer_conf how = { .finest = 0.05, .most = 0.2, .response_error = 0.35, .light_error = 0.006, .edge = 0.5 };

/* A ring of white light of that cosine: slanted from all sides alike. */
static struct image ring_lit(double cosine)
{
	struct image lit = image_new(LIT, LIT, IRIS_LIT);
	float square = (float)((1 - cosine * cosine) / (cosine * cosine) / 2);
	const float of[IRIS_LIT] = { 1, 1, 1, (float)cosine, 0, 0, square, 0, square };
	for (int i = 0; i < LIT * LIT; i++)
		memcpy(lit.px + IRIS_LIT * i, of, sizeof of);
	return lit;
}

static void shading(void *ctx)
{
	struct run *r = ctx;
	struct err err = { 0 };
	image_free(&r->sharp);
	if (!relief_infer(&r->sharp, &r->infer, r->clean, r->coarse, r->lit, r->patch->extent, &point, root, white, r->x, &pigment, &r->conf, &how, &err)) {
		fprintf(stderr, "bench_relief: %s\n", err.msg);
		exit(1);
	}
}

int main(int argc, char **argv)
{
	static const struct { const char *name; double x[PIGMENT_N]; } eyes[] = {
		{ "blue", { -7, 0.7, -7, 0.7, -1.2, 0, 0, 0, 0 } },
		{ "green", { -3.5, 0.7, -5, 0.7, -1, 0, 0, 0, 0 } },
		{ "brown", { -1.6, 0.7, -3, 0.7, -0.5, 0, 0, 0, 0 } },
	};
	static const struct { const char *name; bool filter; double occlusion, error; } methods[] = {
		{ "coarse height field (paper, before its filter)", false, 1, 0.3 }, { "filter, no darkening of hollows", true, 0, 0.3 },
		{ "filter (paper, with hollows)", true, 1, 0.3 }, { "filter, all contrast taken for relief", true, 1, 0.03 },
	};
	bench_open("relief", argc, argv);
	bool better = true;  // photons' pictures show relief alone; eyes show pigment too, which the shipped light error stands for
	double worst = 0, worst_shipped = 0;
	struct image lit = ring_lit(pigment.cos_light);
	for (int e = 0; e < COUNT(eyes); e++) {
		struct tissue tissue = pigment_tissue(eyes[e].x, &pigment);
		struct irisphantom patch = irisphantom_new(&tissue, PATCH, 1, pigment.cos_light, 0.4, bench_quick() ? 60000 : 400000, 3);
		struct image clean = larger(&patch.clean), coarse = larger(&patch.coarse), truth = larger(&patch.truth);
		double rms[COUNT(methods)];
		for (int m = 0; m < COUNT(methods); m++) {
			struct run r = { &patch, &clean, &coarse, eyes[e].x, .conf = {
				.band = { 0.05, 0.12, 0.3 }, .relief_sigma = 0.1, .pitch = 0.04, .occlusion = methods[m].occlusion, .reach = 0.08,
				.model_error = methods[m].error, .low = 0.1, .high = 1, .filter = methods[m].filter } };
			struct bench_time t = bench_time(filter, &r, bench_quick() ? 1 : 3);
			irisphantom_correlation(&truth, &r.sharp, &rms[m]);
			bench_row("thickness", methods[m].name, eyes[e].name, t, "texture of 1024 x 1024", 100 * rms[m], "%", "ln thickness against truth, rms");
			bench_row("light", methods[m].name, eyes[e].name, t, "texture of 1024 x 1024", 100 * r.fit.after, "%", "ln light of the rendering against the picture, rms");
			image_free(&r.sharp);
		}
		struct run r = { &patch, &clean, &coarse, eyes[e].x, .lit = &lit, .conf = { .band = { 0.05, 0.12, 0.3 }, .relief_sigma = 0.1, .pitch = 0.04,
			.occlusion = 1, .reach = 0.08, .model_error = 0.3, .low = 0.1, .high = 1, .filter = true } };
		struct bench_time t = bench_time(shading, &r, bench_quick() ? 1 : 3);
		double shipped;
		irisphantom_correlation(&truth, &r.sharp, &shipped);
		bench_row("thickness", "most probable relief under the light (shipped)", eyes[e].name, t, "texture of 1024 x 1024", 100 * shipped, "%", "ln thickness against truth, rms");
		bench_row("light", "most probable relief under the light (shipped)", eyes[e].name, t, "texture of 1024 x 1024", 100 * r.infer.after, "%", "ln light of the rendering against the picture, rms");
		image_free(&r.sharp);
		worst_shipped = fmax(worst_shipped, shipped / rms[0]);
		better = better && rms[2] < rms[0];
		worst = fmax(worst, rms[2] / rms[0]);
		image_free(&clean);
		image_free(&coarse);
		image_free(&truth);
		irisphantom_free(&patch);
	}
	image_free(&lit);
	bench_goal("relief from photons, as shipped", "nearer to the truth than the coarse height field, every iris", 100 * worst_shipped, "% of its error", worst_shipped < 1);
	bench_goal("relief from photons, by the filter", "nearer to the truth than the coarse height field, every iris", 100 * worst, "% of its error", better);
	return bench_close();
}
