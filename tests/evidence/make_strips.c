/* make_strips: writes strips (limbus/strip.h) round ellipses near and far from the limbus of drawn eyes to stdout, for training.
 *
 *     make_strips FIRST COUNT [PHOTOGRAPHS ...] | strip.py
 *
 * Every second photograph is one of PHOTOGRAPHS (kept.h), if any are told: of each of these files in turn, from the place in it that FIRST says, over
 * and over. STARTS strips of each photograph. A strip is STRIP_PLANES x STRIP_ROWS x STRIP_RAYS bytes, 0 to 255 for 0 to 1, then a float for
 * each column: where its ray crosses the limbus (s; 0: nowhere), then a byte for each: 1 where iris is seen against sclera there.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/region.h"
#include "limbus/strip.h"
#include "kept.h"
#include "math/rng.h"
#include "other.h"
#include "scene.h"

enum { STARTS = 8, MOST_FILES = 8 };
static const double BESIDE = 0.03;  // of the radius: where the classes on both sides are read

static int label_at(const struct drawn *d, const double p[2])
{
	return p[0] < 0 || p[1] < 0 || p[0] >= d->width || p[1] >= d->height ? -1 : d->label[(long)p[1] * d->width + (long)p[0]];
}

static bool shows(const struct drawn *d, const struct ellipse *e, int column, double s)
{
	double in[2], out[2];
	strip_place(in, e, column, s * (1 - BESIDE));
	strip_place(out, e, column, s * (1 + BESIDE));
	return label_at(d, in) == EVIDENCE_IRIS && label_at(d, out) == EVIDENCE_SCLERA;
}

/* Centre, size and shape moved by so many radii. */
static struct ellipse moved(const struct ellipse *e, double by, double shape, struct rng *rng)
{
	double q[ELLIPSE_N];
	ellipse_to_q(q, e);
	for (int i = 0; i < ELLIPSE_N; i++)
		q[i] += (i < 3 ? by : shape) * e->a * rng_normal(rng);
	struct ellipse f;
	return ellipse_from_q(&f, q) && f.b > 0.5 * f.a && f.a > 0.5 * e->a ? f : *e;
}

static void write_strip(const struct drawn *d, const struct photo *photo, const struct evidence *evidence, const struct ellipse *start,
                        int n, const struct ellipse limbus[])
{
	static float strip[STRIP_PLANES][STRIP_ROWS][STRIP_RAYS];
	static uint8_t bytes[STRIP_PLANES * STRIP_PIXELS];
	float crossing[STRIP_RAYS] = { 0 };
	uint8_t shown[STRIP_RAYS] = { 0 };
	strip_sample(strip, photo, evidence, start);
	const float *values = &strip[0][0][0];
	for (int i = 0; i < STRIP_PLANES * STRIP_PIXELS; i++)
		bytes[i] = (uint8_t)lrintf(255 * values[i]);
	for (int j = 0; j < STRIP_RAYS; j++)
		for (int k = 0; k < n; k++) {
			const double s = strip_crossing(start, j, &limbus[k]);
			if (s > 0 && (crossing[j] == 0 || fabs(s - 1) < fabs(crossing[j] - 1))) {
				crossing[j] = (float)s;
				shown[j] = shows(d, start, j, s);
			}
		}
	fwrite(bytes, 1, sizeof bytes, stdout);
	fwrite(crossing, sizeof *crossing, STRIP_RAYS, stdout);
	fwrite(shown, 1, sizeof shown, stdout);
}

/* The strips of one; about: a circle about the eye that is looked for. */
static void strips_of(const struct drawn *d, struct ellipse about, uint64_t number, struct evidence_net *net)
{
	struct rng rng = { number * 31 + 7 };
	struct photo photo = photo_of_bytes(d->rgb, d->width, d->height);
	const double x = about.cx, y = about.cy, radius = about.a;
	struct ellipse limbus[2], e;
	struct evidence evidence;
	struct err err = { 0 };
	int n = 0;
	for (int k = 0; k < d->n_eyes; k++)
		if (d->eye[k].shown > 0.02F)
			limbus[n++] = (struct ellipse){ d->eye[k].limbus[0], d->eye[k].limbus[1], d->eye[k].limbus[2], d->eye[k].limbus[3], d->eye[k].limbus[4] };
	for (int k = 0; k < n; k++)
		if (hypot(limbus[k].cx - x, limbus[k].cy - y) < 0.5 * radius)
			about = limbus[k];
	const struct ellipse seen = moved(&about, 0.1, 0, &rng);
	if (!evidence_window(&evidence, net, &photo, seen.cx, seen.cy, seen.a, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	struct region_map map = region_map_make(&evidence);
	for (int k = 0; k < STARTS; k++) {
		e = k < 2 ? (struct ellipse){ seen.cx, seen.cy, seen.a, seen.a, 0 } : moved(&about, k < 6 ? 0.03 : 0.1, k < 6 ? 0.02 : 0.05, &rng);
		if (k == 1)
			e = moved(&about, 0.15, 0.05, &rng);
		if (k == 7)
			e.a *= 0.62, e.b *= 0.62;
		if (k < 2)
			region_fit(&e, &map);
		write_strip(d, &photo, &evidence, &e, n, limbus);
	}
	region_map_free(&map);
	evidence_free(&evidence);
	photo_free(&photo);
}

static void lesson(uint64_t number, struct evidence_net *net)
{
	struct drawn_view view;
	struct drawn d = drawn_lesson(number, 190, &view);
	strips_of(&d, (struct ellipse){ view.x, view.y, view.radius, view.radius, 0 }, number, net);
	drawn_free(&d);
}

static void lesson_kept(uint64_t number, struct evidence_net *net, FILE *file)
{
	struct drawn d;
	const struct drawn_eye *e;
	if (!kept_next_eye(&d, &e, file, 0.02F))
		return;
	strips_of(&d, (struct ellipse){ e->limbus[0], e->limbus[1], e->limbus[2], e->limbus[2], 0 }, number, net);
	drawn_free(&d);
}

int main(int argc, char **argv)
{
	struct evidence_net *net;
	struct err err = { 0 };
	FILE *kept[MOST_FILES];
	const int n = argc - 3;
	if (n < 0 || n > MOST_FILES) {
		fprintf(stderr, "usage: make_strips FIRST COUNT [PHOTOGRAPHS ...]\n");
		return 2;
	}
	if (!evidence_open(&net, "config/evidence.onnx", &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return 1;
	}
	const uint64_t first = strtoull(argv[1], 0, 10);
	for (int k = 0; k < n; k++)
		kept[k] = kept_open(argv[3 + k], first);
	for (long i = 0; i < atol(argv[2]) && !ferror(stdout); i++)
		if (n && i % 2)
			lesson_kept(first + (uint64_t)i, net, kept[i / 2 % n]);
		else
			lesson(first + (uint64_t)i, net);
	for (int k = 0; k < n; k++)
		fclose(kept[k]);
	evidence_close(net);
	return ferror(stdout) ? 1 : 0;
}
