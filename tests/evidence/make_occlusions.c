/* make_occlusions: writes what an iris network (limbus/occlusion.h) sees of drawn eyes, with truth, to stdout, for training.
 *
 *     make_occlusions FIRST COUNT [test | PHOTOGRAPHS] | occlusion.py
 *     make_occlusions sheet FIRST COLUMNS ROWS OUT.png [test | PHOTOGRAPHS]
 *
 * Every second photograph is one of PHOTOGRAPHS (kept.h), in which reflections are labelled, if told: from the place in it that FIRST says, over and over.
 * STARTS lessons of each photograph, their ellipses a little off. A lesson is OCCLUSION_SEEN x OCCLUSION_SIDE x OCCLUSION_SIDE bytes, 0 to 255 for 0 to 1, then
 * OCCLUSION_CLASSES x OCCLUSION_CELLS x OCCLUSION_CELLS bytes: the share of each class in a cell.
 * A reflection is what adds more than MUCH of the iris' own light to it, over what is mirrored everywhere.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/picture.h"
#include "kept.h"
#include "limbus/occlusion.h"
#include "math/rng.h"
#include "scene.h"
#include "veil.h"

enum { STARTS = 2, FINE = 4, WIDEST = 460 };
static const float LEAST_SHOWN = 0.25F;  // of a limbus
static const float MUCH = 0.3F, FAINT = 0.01F;  // FAINT: of white; less is not seen

static enum occlusion_class class_at(const struct drawn *d, const struct veil *veil, const double p[2])
{
	if (p[0] < 0 || p[1] < 0 || p[0] >= d->width || p[1] >= d->height)
		return OCCLUSION_LID;
	const long i = (long)p[1] * d->width + (long)p[0];
	const float added = d->mirror ? d->mirror[i] - veil->mirrored : 0;
	if (d->label[i] < EVIDENCE_IRIS)
		return OCCLUSION_LID;
	const bool pupil = d->label[i] == EVIDENCE_PUPIL;
	if (d->label[i] == EVIDENCE_REFLECTION || (added > FAINT && added > MUCH * (pupil ? 1.5F * veil->iris : fmaxf(d->body[i], 0.5F * veil->iris))))
		return OCCLUSION_MIRROR;
	return pupil ? OCCLUSION_PUPIL : OCCLUSION_IRIS;
}

static void truth_of(uint8_t out[OCCLUSION_CLASSES][OCCLUSION_CELLS][OCCLUSION_CELLS], const struct drawn *d, const struct veil *veil, const struct ellipse *e)
{
	for (int j = 0; j < OCCLUSION_CELLS; j++)
		for (int i = 0; i < OCCLUSION_CELLS; i++) {
			int count[OCCLUSION_CLASSES] = { 0 };
			for (int k = 0; k < FINE * FINE; k++) {
				double p[2];
				occlusion_place(p, e, OCCLUSION_REACH * (2 * (i + (k % FINE + 0.5) / FINE) / OCCLUSION_CELLS - 1),
				            OCCLUSION_REACH * (2 * (j + (k / FINE + 0.5) / FINE) / OCCLUSION_CELLS - 1));
				count[class_at(d, veil, p)]++;
			}
			for (int c = 0; c < OCCLUSION_CLASSES; c++)
				out[c][j][i] = (uint8_t)(255 * count[c] / (FINE * FINE));
		}
}

/* Centre, size and shape moved by so many radii. */
static struct ellipse moved(const struct ellipse *e, struct rng *rng)
{
	double q[ELLIPSE_N];
	ellipse_to_q(q, e);
	for (int i = 0; i < ELLIPSE_N; i++)
		q[i] += 0.02 * e->a * rng_normal(rng);
	struct ellipse f;
	return ellipse_from_q(&f, q) && f.b > 0.4 * f.a ? f : *e;
}

struct lesson { float seen[OCCLUSION_SEEN][OCCLUSION_SIDE][OCCLUSION_SIDE]; uint8_t truth[OCCLUSION_CLASSES][OCCLUSION_CELLS][OCCLUSION_CELLS]; };

/* Of one eye of a photograph. */
static void lessons_in(struct lesson lesson[STARTS], const struct drawn *d, const struct drawn_eye *eye, struct rng *rng, struct evidence_net *net)
{
	const float *l = eye->limbus;
	const struct ellipse e = { l[0], l[1], l[2], l[3], l[4] };
	struct photo photo = photo_of_bytes(d->rgb, d->width, d->height);
	struct evidence evidence;
	struct err err = { 0 };
	if (!evidence_window(&evidence, net, &photo, e.cx, e.cy, e.a, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	struct veil veil = veil_of(d, e.cx, e.cy, e.a);
	if (!veil.known)
		veil.iris = 0.02F;
	for (int s = 0; s < STARTS; s++) {
		const struct ellipse near = s ? moved(&e, rng) : e;
		occlusion_sample(lesson[s].seen, &photo, &evidence, &near);
		truth_of(lesson[s].truth, d, &veil, &near);
	}
	evidence_free(&evidence);
	photo_free(&photo);
}

/* The photograph of a number; false: it shows too little of an eye. */
static bool lessons_of(struct lesson lesson[STARTS], uint64_t number, bool test, struct evidence_net *net)
{
	struct rng rng = { number * 131 + 3 };
	const float radius = (float)exp(rng_range(&rng, log(24), log(130))), reach = (float)rng_range(&rng, 1.4, 3.2);
	const int width = (int)fminf(2 * reach * radius, WIDEST), height = (int)((float)width * (float)rng_range(&rng, 0.65, 0.95));
	struct drawn_view view = { .radius = radius, .x = (float)width * (float)rng_range(&rng, 0.42, 0.58), .y = (float)height * (float)rng_range(&rng, 0.42, 0.58),
		.turn = (float)(rng_below(&rng, 5) ? 0.2 * rng_normal(&rng) : rng_range(&rng, 0, 2 * M_PI)), .mirrored = rng_below(&rng, 2), .training = !test,
		.rough = (float)fmax(rng_range(&rng, -0.5, 1), 0), .portrait = !test && rng_below(&rng, 2), .around = rng_below(&rng, 4) > 0 };
	struct drawn d = drawn_photograph(number, &view, width, height);
	bool ok = false;
	for (int k = 0; k < d.n_eyes && !ok; k++) {
		const float *l = d.eye[k].limbus;
		ok = hypot(l[0] - view.x, l[1] - view.y) <= 0.5 * radius && d.eye[k].shown >= LEAST_SHOWN;
		if (ok)
			lessons_in(lesson, &d, &d.eye[k], &rng, net);
	}
	drawn_free(&d);
	return ok;
}

/* The next of a file. */
static bool lessons_kept(struct lesson lesson[STARTS], uint64_t number, FILE *file, struct evidence_net *net)
{
	struct rng rng = { number * 131 + 3 };
	struct drawn d;
	const struct drawn_eye *eye;
	if (!kept_next_eye(&d, &eye, file, LEAST_SHOWN))
		return false;
	lessons_in(lesson, &d, eye, &rng, net);
	drawn_free(&d);
	return true;
}

/* Where lessons come from. */
struct source { bool test; FILE *kept; struct evidence_net *net; };

static bool lessons_from(struct lesson lesson[STARTS], uint64_t number, const struct source *source)
{
	return source->kept && number % 2 ? lessons_kept(lesson, number, source->kept, source->net) : lessons_of(lesson, number, source->test, source->net);
}

static void write_lesson(const struct lesson *l)
{
	static uint8_t bytes[OCCLUSION_SEEN * OCCLUSION_SIDE * OCCLUSION_SIDE];
	for (int i = 0; i < OCCLUSION_SEEN * OCCLUSION_SIDE * OCCLUSION_SIDE; i++)
		bytes[i] = (uint8_t)lrintf(255 * (&l->seen[0][0][0])[i]);
	fwrite(bytes, 1, sizeof bytes, stdout);
	fwrite(l->truth, 1, sizeof l->truth, stdout);
}

static int sheet(struct lesson *lesson, uint64_t first, int columns, int rows, const char *path, const struct source *source)
{
	static const uint8_t colour[OCCLUSION_CLASSES][3] = { { 60, 130, 230 }, { 0, 0, 0 }, { 255, 60, 200 }, { 60, 40, 30 } };
	const int w = columns * OCCLUSION_SIDE, h = 2 * rows * OCCLUSION_SIDE;
	uint8_t *px = mem_new((size_t)w * (size_t)h, 3);
	for (int k = 0; k < rows * columns; first++) {
		if (!lessons_from(lesson, first, source))
			continue;
		for (int i = 0; i < OCCLUSION_SIDE * OCCLUSION_SIDE; i++) {
			const int x = i % OCCLUSION_SIDE, y = i / OCCLUSION_SIDE;
			uint8_t *to = px + 3 * ((long)(2 * (k / columns) * OCCLUSION_SIDE + y) * w + k % columns * OCCLUSION_SIDE + x), *truth = to + 3L * w * OCCLUSION_SIDE;
			for (int c = 0; c < 3; c++) {
				float sum = 0;
				for (int q = 0; q < OCCLUSION_CLASSES; q++)
					sum += (float)lesson->truth[q][y / 2][x / 2] / 255 * colour[q][c];
				to[c] = (uint8_t)(255 * lesson->seen[c][y][x]);
				truth[c] = (uint8_t)sum;
			}
		}
		k++;
	}
	struct err err = { 0 };
	const bool ok = picture_png_write(path, px, w, h, 3, &err);
	free(px);
	return !ok;
}

int main(int argc, char **argv)
{
	struct source source = { 0 };
	struct err err = { 0 };
	struct lesson *lesson = mem_array(STARTS, sizeof *lesson);
	const bool is_sheet = argc > 5 && strcmp(argv[1], "sheet") == 0;
	const char *more = argc > (is_sheet ? 6 : 3) ? argv[is_sheet ? 6 : 3] : 0;
	int status = 2;
	if (argc < 3) {
		fprintf(stderr, "usage: make_occlusions FIRST COUNT [test | PHOTOGRAPHS]\n       make_occlusions sheet FIRST COLUMNS ROWS OUT.png [test | PHOTOGRAPHS]\n");
	} else if (!evidence_open(&source.net, "config/evidence.onnx", &err)) {
		fprintf(stderr, "%s\n", err.msg);
		status = 1;
	} else {
		const uint64_t first = strtoull(argv[is_sheet ? 2 : 1], 0, 10);
		source.test = more && strcmp(more, "test") == 0;
		source.kept = more && !source.test ? kept_open(more, first) : 0;
		if (is_sheet) {
			status = sheet(lesson, first, atoi(argv[3]), atoi(argv[4]), argv[5], &source);
		} else {
			for (long i = 0; i < atol(argv[2]) && !ferror(stdout); i++)
				if (lessons_from(lesson, first + (uint64_t)i, &source))
					for (int s = 0; s < STARTS; s++)
						write_lesson(&lesson[s]);
			status = ferror(stdout) ? 1 : 0;
		}
		if (source.kept)
			fclose(source.kept);
		evidence_close(source.net);
	}
	free(lesson);
	return status;
}
