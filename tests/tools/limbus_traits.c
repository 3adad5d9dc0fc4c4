/* limbus_traits: what odds.h looks at in every trial of many photographs, and whether it was right, to fit the weights of
 * config/limbus.conf by (tests/evidence/odds.py).
 *
 *     limbus_traits OUT.csv drawn FIRST COUNT     drawn eyes of the training split; one in five is none
 *     limbus_traits OUT.csv synthetic STEP        every STEP-th of the grid of tests/lib/scenes/synth_eye.h
 *     limbus_traits OUT.csv captures              the rendered captures with truth
 *
 * Columns: kind, number, guide, error over the semi-axis (9: there is no eye), traits.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/trial.h"
#include "math/rng.h"
#include "tests/evidence/other.h"
#include "tests/evidence/scene.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/truth/truth.h"

static const double NO_EYE = 9;

static double apart(const struct ellipse *e, const struct ellipse *truth)
{
	return fmax(hypot(e->cx - truth->cx, e->cy - truth->cy), fmax(fabs(e->a - truth->a), fabs(e->b - truth->b))) / truth->a;
}

static void note(FILE *csv, const char *kind, long number, const struct photo *photo, int n, const struct ellipse truth[])
{
	struct err err = { 0 };
	struct pyramid pyramid = pyramid_make(photo);
	struct trials *t = trials_new(photo, &pyramid, &limbus_defaults);
	if (!trials_of_evidence(t, &err) || !trials_of_votes(t, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	for (int i = 0; i < t->n; i++) {
		double error = NO_EYE;
		for (int k = 0; k < n; k++)
			error = fmin(error, apart(&t->trial[i].e, &truth[k]));
		fprintf(csv, "%s,%ld,%d,%.5f", kind, number, (int)t->trial[i].guide, error);
		for (int k = 0; k < ODDS_TRAITS; k++)
			fprintf(csv, ",%.5f", t->trial[i].x[k]);
		fputc('\n', csv);
	}
	trials_free(t);
	pyramid_free(&pyramid);
}

/* 300 to 900 px long, the limbus 24 px to two fifths of the height. */
static void drawn(FILE *csv, long number)
{
	struct rng rng = { (uint64_t)number * 77 + 5 };
	const int width = (int)(300 * pow(3, rng_uniform(&rng))), height = (int)(width * rng_range(&rng, 0.6, 0.85));
	const double r = exp(rng_range(&rng, log(24), log(0.42 * height)));
	const int other = rng_below(&rng, 5) == 0 ? OTHER_BALL + rng_below(&rng, OTHER_FACE - OTHER_BALL) : OTHER_NONE;
	const struct drawn_view view = { .radius = (float)r, .x = (float)rng_range(&rng, 1.05 * r, width - 1.05 * r),
		.y = (float)rng_range(&rng, 1.05 * r, height - 1.05 * r), .mirrored = rng_below(&rng, 2), .other = other, .training = true,
		.turn = (float)(rng_below(&rng, 3) ? 0.2 * rng_normal(&rng) : rng_range(&rng, 0, 2 * M_PI)) };
	struct drawn d = drawn_photograph((uint64_t)number, &view, width, height);
	struct photo photo = { .width = width, .height = height, .bits = 8, .rgb = mem_array((size_t)width * (size_t)height * 3, sizeof *photo.rgb) };
	struct ellipse truth[2];
	int n = 0;
	for (long i = 0; i < 3L * width * height; i++)
		photo.rgb[i] = (uint16_t)(d.rgb[i] * 257);
	for (int e = 0; e < d.n_eyes; e++) {
		const float *l = d.eye[e].limbus;
		if (d.eye[e].shown > 0.02F)
			truth[n++] = (struct ellipse){ l[0], l[1], l[2], l[3], l[4] };
	}
	note(csv, other ? "other" : "drawn", number, &photo, n, truth);
	free(photo.rgb);
	drawn_free(&d);
}

static void synthetic(FILE *csv, int number)
{
	struct synth_eye eye = synth_eye_grid(number);
	struct synth_truth truth;
	struct photo photo = synth_eye_render(&eye, &truth);
	note(csv, "synthetic", number, &photo, 1, &truth.limbus);
	photo_free(&photo);
}

static void capture(FILE *csv, int number, const char *dir)
{
	struct truth truth;
	struct photo photo = { 0 };
	struct err err = { 0 };
	if (!truth_load(&truth, dir, &err) || !photo_load(&photo, truth.photo, 100, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	note(csv, "capture", number, &photo, 1, &truth.limbus);
	photo_free(&photo);
}

int main(int argc, char **argv)
{
	FILE *csv = argc > 2 ? fopen(argv[1], "w") : 0;
	if (!csv) {
		fprintf(stderr, "limbus_traits OUT.csv drawn FIRST COUNT | synthetic STEP | captures\n");
		return 2;
	}
	if (!strcmp(argv[2], "drawn") && argc > 4) {
		for (long i = 0; i < atol(argv[4]); i++)
			drawn(csv, atol(argv[3]) + i);
	} else if (!strcmp(argv[2], "synthetic") && argc > 3) {
		for (int i = 0; i < SYNTH_GRID; i += atoi(argv[3]))
			synthetic(csv, i);
	} else {
		char *dirs[64];
		const int n = truth_captures(dirs, 64);
		for (int i = 0; i < n; i++) {
			capture(csv, i, dirs[i]);
			free(dirs[i]);
		}
	}
	return fclose(csv) ? 1 : 0;
}
