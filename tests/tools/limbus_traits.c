/* limbus_traits: what odds.h looks at in every trial of many photographs, and whether it was right, to fit the weights of
 * config/limbus.conf by (tests/evidence/odds.py).
 *
 *     limbus_traits OUT.csv drawn FIRST COUNT     drawn eyes of the training split; one in five is none
 *     limbus_traits OUT.csv heads FIRST COUNT FILE     photographs of a file that heads.py or traced.py has written (tests/evidence/kept.h)
 *     limbus_traits OUT.csv synthetic STEP        every STEP-th of the grid of tests/lib/scenes/synth_eye.h
 *     limbus_traits OUT.csv captures              the rendered captures with truth, also half as large
 *     limbus_traits OUT.csv strip FIRST COUNT     of drawn eyes of which a quarter of the limbus shows, the strip's ellipse alone: number, share that
 *                                                 shows, semi-axis px, roughness, errors of the strip's ellipse and of its trial, of the strip's b
 *
 * Columns: kind, number, guide, error over the semi-axis, the same where the limbus is seen alone (9: there is no eye), traits.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/photo/part.h"
#include "limbus/trial.h"
#include "math/rng.h"
#include "tests/evidence/kept.h"
#include "tests/evidence/other.h"
#include "tests/evidence/scene.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/truth/truth.h"

static const double NO_EYE = 9;

static double apart(const struct ellipse *e, const struct ellipse *truth)
{
	return ellipse_apart(e, truth) / truth->a;
}

/* Which of the places of a limbus a photograph shows. */
enum { PLACES = 180 };
struct seen { struct ellipse limbus; bool at[PLACES]; };

/* Largest distance of the places that are seen from the ellipse e, over the semi-axis; NAN: none is. */
static double astray(const struct ellipse *e, const struct seen *truth)
{
	double worst = NAN;
	for (int i = 0; i < PLACES; i++) {
		double p[2], normal[2], t;
		if (!truth->at[i])
			continue;
		ellipse_point(p, normal, &truth->limbus, 2 * M_PI * i / PLACES);
		worst = fmax(worst, fabs(ellipse_distance(&t, e, p)) / truth->limbus.a);
	}
	return worst;
}

static struct seen all_of(const struct ellipse *limbus)
{
	struct seen s = { .limbus = *limbus };
	for (int i = 0; i < PLACES; i++)
		s.at[i] = true;
	return s;
}

static void note(FILE *csv, const char *kind, long number, const struct photo *photo, int n, const struct seen truth[])
{
	struct err err = { 0 };
	struct pyramid pyramid = pyramid_make(photo);
	struct trials *t = trials_new(photo, &pyramid, &limbus_defaults);
	if (!trials_of_evidence(t, &err) || !trials_of_scales(t, &err) || !trials_of_votes(t, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	for (int i = 0; i < t->n; i++) {
		double error = NO_EYE, line = NO_EYE;
		for (int k = 0; k < n; k++) {
			const double here = apart(&t->trial[i].e, &truth[k].limbus);
			if (here < error) {
				error = here;
				line = fmin(astray(&t->trial[i].e, &truth[k]), NO_EYE);
			}
		}
		fprintf(csv, "%s,%ld,%d,%.5f,%.5f", kind, number, (int)t->trial[i].guide, error, line);
		for (int k = 0; k < ODDS_TRAITS; k++)
			fprintf(csv, ",%.5f", t->trial[i].x[k]);
		fputc('\n', csv);
	}
	trials_free(t);
	pyramid_free(&pyramid);
}

static int label_at(const struct drawn *d, const struct ellipse *limbus, double t, double scale)
{
	struct ellipse e = *limbus;
	double p[2], normal[2];
	e.a *= scale;
	e.b *= scale;
	ellipse_point(p, normal, &e, t);
	return p[0] < 0 || p[1] < 0 || p[0] >= d->width || p[1] >= d->height ? -1 : d->label[(long)p[1] * d->width + (long)p[0]];
}

static struct seen seen_of(const struct drawn *d, const float l[5])
{
	struct seen s = { .limbus = { l[0], l[1], l[2], l[3], l[4] } };
	for (int i = 0; i < PLACES; i++)
		s.at[i] = label_at(d, &s.limbus, 2 * M_PI * i / PLACES, 0.97) == EVIDENCE_IRIS && label_at(d, &s.limbus, 2 * M_PI * i / PLACES, 1.03) == EVIDENCE_SCLERA;
	return s;
}

/* The eyes of which something shows; returns how many. */
static int eyes_of(struct seen truth[2], const struct drawn *d)
{
	int n = 0;
	for (int e = 0; e < d->n_eyes; e++)
		if (d->eye[e].shown > 0.02F)
			truth[n++] = seen_of(d, d->eye[e].limbus);
	return n;
}

static double share_of(const struct seen *s)
{
	int n = 0;
	for (int i = 0; i < PLACES; i++)
		n += s->at[i];
	return (double)n / PLACES;
}

/* Read from a start some hundredths of the semi-axis off. */
static void read_one(FILE *csv, long number, const struct photo *photo, const struct seen *truth, double rough)
{
	const struct ellipse *limbus = &truth->limbus;
	struct err err = { 0 };
	struct pyramid pyramid = pyramid_make(photo);
	struct trials *t = trials_new(photo, &pyramid, &limbus_defaults);
	double told = NO_EYE, trial = NO_EYE, b = NO_EYE;
	if (!trials_of_place(t, limbus->cx + 0.04 * limbus->a, limbus->cy - 0.03 * limbus->a, 1.05 * limbus->a, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	for (int k = 0; k < t->n_windows; k++) {
		struct ellipse e;
		if (t->window[k].seen.px && ellipse_from_q(&e, t->window[k].told.q) && apart(&e, limbus) < told) {
			told = apart(&e, limbus);
			b = (e.b - limbus->b) / limbus->a;
		}
	}
	for (int k = 0; k < t->n; k++)
		if (t->trial[k].guide == GUIDE_STRIP)
			trial = fmin(trial, apart(&t->trial[k].e, limbus));
	fprintf(csv, "%ld,%.3f,%.0f,%.2f,%.5f,%.5f,%.5f\n", number, share_of(truth), limbus->a, rough, told, trial, b);
	trials_free(t);
	pyramid_free(&pyramid);
}

static void strip(FILE *csv, long number)
{
	struct drawn_view view;
	struct drawn d = drawn_lesson((uint64_t)number, 260, &view);
	struct photo photo = photo_of_bytes(d.rgb, d.width, d.height);
	struct seen truth[2];
	const int n = view.other ? 0 : eyes_of(truth, &d);
	for (int k = 0; k < n; k++)
		if (share_of(&truth[k]) > 0.25 && hypot(truth[k].limbus.cx - view.x, truth[k].limbus.cy - view.y) < view.radius)
			read_one(csv, number, &photo, &truth[k], view.rough);
	photo_free(&photo);
	drawn_free(&d);
}

static void drawn(FILE *csv, long number)
{
	struct drawn_view view;
	struct drawn d = drawn_lesson((uint64_t)number, 260, &view);
	struct photo photo = photo_of_bytes(d.rgb, d.width, d.height);
	struct seen truth[2];
	const int n = eyes_of(truth, &d);
	note(csv, view.other ? "other" : "drawn", number, &photo, n, truth);
	photo_free(&photo);
	drawn_free(&d);
}

static bool heads(FILE *csv, long first, long count, const char *path)
{
	FILE *file = fopen(path, "rb");
	struct drawn d;
	for (long i = 0; file && i < first + count && kept_next(&d, file); i++) {
		struct seen truth[2];
		if (i >= first) {
			struct photo photo = photo_of_bytes(d.rgb, d.width, d.height);
			const int n = eyes_of(truth, &d);
			note(csv, "heads", i, &photo, n, truth);
			photo_free(&photo);
		}
		drawn_free(&d);
	}
	return file && !fclose(file);
}

static void synthetic(FILE *csv, int number)
{
	struct synth_eye eye = synth_eye_grid(number);
	struct synth_truth truth;
	struct photo photo = synth_eye_render(&eye, &truth);
	note(csv, "synthetic", number, &photo, 1, (struct seen[]){ all_of(&truth.limbus) });
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
	note(csv, "capture", number, &photo, 1, (struct seen[]){ all_of(&truth.limbus) });
	double scale;
	struct photo half = photo_reduced(&photo, (photo.width > photo.height ? photo.width : photo.height) / 2, &scale);
	const struct ellipse *e = &truth.limbus;
	note(csv, "capture", number + 1000, &half, 1, (struct seen[]){ all_of(&(struct ellipse){ e->cx / scale, e->cy / scale, e->a / scale, e->b / scale, e->angle }) });
	photo_free(&half);
	photo_free(&photo);
}

int main(int argc, char **argv)
{
	FILE *csv = argc > 2 ? fopen(argv[1], "w") : 0;
	if (!csv) {
		fprintf(stderr, "limbus_traits OUT.csv drawn FIRST COUNT | heads FIRST COUNT FILE | synthetic STEP | captures | strip FIRST COUNT\n");
		return 2;
	}
	if ((!strcmp(argv[2], "drawn") || !strcmp(argv[2], "strip")) && argc > 4) {
		for (long i = 0; i < atol(argv[4]); i++)
			(*argv[2] == 'd' ? drawn : strip)(csv, atol(argv[3]) + i);
	} else if (!strcmp(argv[2], "heads") && argc > 5) {
		if (!heads(csv, atol(argv[3]), atol(argv[4]), argv[5])) {
			fprintf(stderr, "cannot read %s\n", argv[5]);
			return 1;
		}
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
