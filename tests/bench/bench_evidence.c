/* The evidence network on drawn eyes of the test split and on the rendered captures: intersection over union of each class, by
 * light, size and openness, and how often the first candidate region is the iris; beside k-means over colour and place whose
 * clusters are named by the truth. Time a photograph.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "image/picture.h"
#include "limbus/evidence.h"
#include "math/stats.h"
#include "tests/evidence/light.h"
#include "tests/evidence/scene.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/truth.h"
#include "tests/peers/colour_means.h"

enum { WIDTH = 256, HEIGHT = 192, NETWORK = 0, MEANS, METHODS, BINS = 10, LONGEST = 2000, LEAST = 5 };  // px: radius of the smallest iris that is to be found
static const char *const class_name[EVIDENCE_CLASSES] = { "skin, all else", "lash, brow", "sclera", "iris", "pupil", "reflection" };
static const char *const method_name[METHODS] = { "network", "k-means, named by the truth" };
static const char *const bin_name[BINS] = { "all", "lights as in training", "ring lights, trees: never trained on", "radius below 12 px",
	"radius 12 to 24 px", "radius above 24 px", "opening below 0.4 of the iris", "opening 0.4 to 0.8", "opening above 0.8", "no eye" };

struct score { long both[EVIDENCE_CLASSES], either[EVIDENCE_CLASSES]; };

static double iou(const struct score *s, int class)
{
	return s->either[class] ? (double)s->both[class] / (double)s->either[class] : NAN;
}

static void count(struct score *s, const uint8_t *got, const uint8_t *truth, long n)
{
	for (long i = 0; i < n; i++) {
		if (truth[i] == 255)
			continue;
		s->either[truth[i]]++;
		if (got[i] == truth[i])
			s->both[truth[i]]++;
		else
			s->either[got[i]]++;
	}
}

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void classes_of(uint8_t *out, const struct evidence *e, int classes)
{
	for (long i = 0; i < (long)e->width * e->height; i++) {
		out[i] = 0;
		for (int c = 1; c < classes; c++)
			if (e->plane[c][i] > e->plane[out[i]][i])
				out[i] = (uint8_t)c;
	}
}

/* The class most common in each 2 x 2 px, and the mean colour. */
static void halve(uint8_t *label, float *rgb, const struct drawn *d)
{
	const int w = d->width / 2, h = d->height / 2;
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			int votes[EVIDENCE_CLASSES] = { 0 }, best = 0;
			float sum[3] = { 0 };
			for (int k = 0; k < 4; k++) {
				const long i = (long)(2 * y + k / 2) * d->width + 2 * x + k % 2;
				votes[d->label[i]]++;
				for (int c = 0; c < 3; c++)
					sum[c] += (float)d->rgb[3 * i + c] / (4 * 255);
			}
			for (int c = 1; c < EVIDENCE_CLASSES; c++)
				best = votes[c] > votes[best] ? c : best;
			label[y * w + x] = (uint8_t)best;
			for (int c = 0; c < 3; c++)
				rgb[c * w * h + y * w + x] = sum[c];
		}
}

static void bins_of(bool in[BINS], const struct drawn *d)
{
	memset(in, 0, BINS * sizeof *in);
	in[0] = true;
	in[9] = d->n_eyes == 0;
	if (!d->n_eyes)
		return;
	const double radius = d->eye[0].limbus[2], open = d->eye[0].openness;
	in[d->light >= LIGHT_RING ? 2 : 1] = true;
	in[radius < 12 ? 3 : radius < 24 ? 4 : 5] = true;
	in[open < 0.4 ? 6 : open < 0.8 ? 7 : 8] = true;
}

static bool is_the_iris(const struct evidence_region *r, const struct drawn *d)
{
	for (int e = 0; e < d->n_eyes; e++) {
		const float *l = d->eye[e].limbus;
		if (hypot(r->x - l[0], r->y - l[1]) < 0.3 * l[2] && r->radius > 0.75 * l[2] && r->radius < 1.33 * l[2])
			return true;
	}
	return false;
}

struct sums {
	struct score score[METHODS][BINS];
	double seconds[METHODS][LONGEST];
	int n, shown, first, any, without, mistaken;
};

static void candidates(struct sums *s, struct evidence_net *net, const struct photo *photo, const struct drawn *d)
{
	struct evidence_region region[EVIDENCE_REGIONS];
	struct err err = { 0 };
	int n;
	if (!evidence_find(region, &n, net, photo, &err))
		return;
	bool whole = d->n_eyes > 0;
	for (int e = 0; e < d->n_eyes; e++)
		whole = whole && d->eye[e].shown > 0.5 && d->eye[e].limbus[2] >= LEAST;
	if (whole) {
		bool found = false;
		for (int i = 0; i < n; i++)
			found = found || is_the_iris(&region[i], d);
		s->shown++;
		s->any += found;
		s->first += n > 0 && is_the_iris(&region[0], d);
	} else if (d->n_eyes == 0) {
		s->without++;
		s->mistaken += n > 0 && region[0].score > 0.5;
	}
}

static void one(struct sums *s, struct evidence_net *net, uint64_t number)
{
	enum { N = WIDTH * HEIGHT / 4 };
	static uint8_t truth[N], got[METHODS][N];
	static float rgb[3 * N];
	struct drawn d = drawn_make(number, true, WIDTH, HEIGHT);
	struct photo photo = photo_of_bytes(d.rgb, d.width, d.height);
	struct evidence e;
	struct err err = { 0 };
	halve(truth, rgb, &d);
	double t = now();
	const bool ok = evidence_whole(&e, net, &photo, WIDTH, &err);
	s->seconds[NETWORK][s->n] = now() - t;
	if (ok) {
		classes_of(got[NETWORK], &e, EVIDENCE_CLASSES);
		t = now();
		colour_means(got[MEANS], rgb, truth, WIDTH / 2, HEIGHT / 2, 8, 0.5, EVIDENCE_CLASSES);
		s->seconds[MEANS][s->n++] = now() - t;
		bool in[BINS];
		bins_of(in, &d);
		for (int m = 0; m < METHODS; m++)
			for (int b = 0; b < BINS; b++)
				if (in[b])
					count(&s->score[m][b], got[m], truth, N);
		candidates(s, net, &photo, &d);
		evidence_free(&e);
	}
	photo_free(&photo);
	drawn_free(&d);
}

static void drawn_split(struct evidence_net *net)
{
	static struct sums s;
	const int n = bench_quick() ? 100 : 1000;
	for (int i = 0; i < n; i++)
		one(&s, net, (uint64_t)i);
	for (int m = 0; m < METHODS; m++) {
		const struct bench_time time = bench_time_of(s.n, s.seconds[m]);
		for (int b = 0; b < BINS; b++)
			for (int c = 0; c < EVIDENCE_CLASSES; c++)
				if (!isnan(iou(&s.score[m][b], c)) && !(b == 9 && c))
					bench_row(bin_name[b], method_name[m], class_name[c], time, "photograph", 100 * (1 - iou(&s.score[m][b], c)), "%", "1 - IoU");
		printf("%-28s", method_name[m]);
		for (int c = 0; c < EVIDENCE_CLASSES; c++)
			printf(" %s %.3f", class_name[c], iou(&s.score[m][0], c));
		printf("\n");
	}
	printf("candidates: %d of %d eyes first, %d among all; %d of %d pictures without an eye mistaken\n", s.first, s.shown, s.any, s.mistaken, s.without);
	bench_goal("test split: IoU of the iris", ">= 0.8", iou(&s.score[NETWORK][0], EVIDENCE_IRIS), "", iou(&s.score[NETWORK][0], EVIDENCE_IRIS) >= 0.8);
	bench_goal("test split: first candidate is the iris, 5 px or more, half of it showing", ">= 95 %", 100.0 * s.first / s.shown, "%", s.first >= 0.95 * s.shown);
	bench_goal("test split: no eye, but a candidate above 0.5", "<= 5 %", 100.0 * s.mistaken / s.without, "%", s.mistaken <= 0.05 * s.without);
}

/* Classes of a capture's labels.png at the planes' pixels; 255 outside of it. */
static bool capture_labels(uint8_t *out, const struct evidence *e, const char *dir, struct err *err)
{
	static const uint8_t class_of[8] = { EVIDENCE_SKIN, EVIDENCE_SKIN, EVIDENCE_LASH, EVIDENCE_SCLERA, EVIDENCE_IRIS, EVIDENCE_PUPIL, EVIDENCE_IRIS, EVIDENCE_SCLERA };
	uint8_t *px;
	int width, height;
	char *path = mem_printf("%s/labels.png", dir);
	const bool ok = picture_read(&px, &width, &height, path, 100, err);
	free(path);
	if (!ok)
		return false;
	for (int j = 0; j < e->height; j++)
		for (int i = 0; i < e->width; i++) {
			const double x = e->x0 + (i + 0.5) * e->scale, y = e->y0 + (j + 0.5) * e->scale;
			const bool in = x >= 0 && y >= 0 && x < width && y < height;
			out[j * e->width + i] = in ? class_of[px[3 * ((long)y * width + (long)x)] & 7] : 255;
		}
	free(px);
	return true;
}

struct found { struct evidence_region region[EVIDENCE_REGIONS]; int n; struct evidence_net *net; const struct photo *photo; struct evidence e; bool ok; };

/* All that a photograph costs: the candidates, and the evidence round the best. */
static void find(void *ctx)
{
	struct found *f = ctx;
	struct err err = { 0 };
	evidence_free(&f->e);
	f->ok = evidence_find(f->region, &f->n, f->net, f->photo, &err) && f->n > 0
	        && evidence_window(&f->e, f->net, f->photo, f->region[0].x, f->region[0].y, f->region[0].radius, &err);
}

static void captures(struct evidence_net *net)
{
	char *dirs[64];
	const int n = truth_captures(dirs, 64);
	double seconds[64], worst = 0;
	int used = 0;
	struct score all = { 0 };
	for (int i = 0; i < n; i++) {
		struct truth truth;
		struct photo photo;
		struct err err = { 0 };
		if (!truth_load(&truth, dirs[i], &err) || !photo_load(&photo, truth.photo, 100, &err))
			continue;
		struct found f = { .net = net, .photo = &photo };
		const struct bench_time time = bench_time(find, &f, 5);
		uint8_t *labels = f.ok ? mem_array((size_t)f.e.width * (size_t)f.e.height, 1) : 0, *got = f.ok ? mem_array((size_t)f.e.width * (size_t)f.e.height, 1) : 0;
		if (f.ok && capture_labels(labels, &f.e, dirs[i], &err)) {
			struct score s = { 0 };
			classes_of(got, &f.e, EVIDENCE_CLASSES - 1);
			count(&s, got, labels, (long)f.e.width * f.e.height);
			for (int c = 0; c < EVIDENCE_CLASSES - 1; c++) {
				all.both[c] += s.both[c];
				all.either[c] += s.either[c];
				if (!isnan(iou(&s, c)))
					bench_row("captures", class_name[c], truth.name, time, "photograph", 100 * (1 - iou(&s, c)), "%", "1 - IoU");
			}
			const double off = hypot(f.region[0].x - truth.limbus.cx, f.region[0].y - truth.limbus.cy) / truth.limbus.a;
			worst = fmax(worst, off);
			printf("%-22s sclera %.3f iris %.3f pupil %.3f; candidate off by %.2f a, radius %.2f a, score %.2f\n", truth.name, iou(&s, EVIDENCE_SCLERA),
			       iou(&s, EVIDENCE_IRIS), iou(&s, EVIDENCE_PUPIL), off, f.region[0].radius / truth.limbus.a, f.region[0].score);
		} else {
			worst = INFINITY;
		}
		seconds[used++] = time.median;
		free(labels);
		free(got);
		evidence_free(&f.e);
		photo_free(&photo);
	}
	for (int i = 0; i < n; i++)
		free(dirs[i]);
	if (!used)
		return;
	printf("captures: skin %.3f lash %.3f sclera %.3f iris %.3f pupil %.3f\n", iou(&all, 0), iou(&all, 1), iou(&all, 2), iou(&all, 3), iou(&all, 4));
	bench_goal("captures: IoU of the iris", ">= 0.8", iou(&all, EVIDENCE_IRIS), "", iou(&all, EVIDENCE_IRIS) >= 0.8);
	bench_goal("captures: candidate's centre, worst", "<= 0.3 a", worst, "a", worst <= 0.3);
	const double time = 1000 * stats_median(used, seconds);
	bench_goal("candidates and evidence, 1600 x 1200", "<= 60 ms", time, "ms", time <= 60);
}

int main(int argc, char **argv)
{
	bench_open("evidence", argc, argv);
	struct evidence_net *net;
	struct err err = { 0 };
	if (!evidence_open(&net, "config/evidence.onnx", &err)) {
		fprintf(stderr, "bench_evidence: %s\n", err.msg);
		return 1;
	}
	captures(net);
	drawn_split(net);
	evidence_close(net);
	return bench_close();
}
