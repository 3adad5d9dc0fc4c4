/* bench_white: the light's colour beside each eye of drawn faces, by the sclera there and by that beside both eyes, and how far the colours of the two
 * differ. FACES=N of the test split, SEED. The sclera's own colour and brightness against labels: EYES=N drawn portraits, and EYEWRIGHT_HEADS=FILE. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "iris/balance.h"
#include "limbus/evidence.h"
#include "math/rng.h"
#include "math/stats.h"
#include "tests/evidence/kept.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/conf/white_conf.h"
#include "tests/lib/truth/iris.h"
#include "tests/lib/unseen/faces.h"
#include "tests/lib/unseen/unseen_impl.h"
#include "image/image.h"
#include "image/photo/patch.h"
#include "tissue/light/sclera_light.h"

enum { OWN, MEAN, JOINED, METHODS, ENV_ROWS = 128 };
static const char *const methods[METHODS] = { "the sclera beside the eye", "mean of both eyes'", "both eyes', by white_pair" };
static const struct bench_time untimed = { NAN, NAN, NAN };
static const struct eye anatomy = { .limbus_radius = 5.85, .cornea_radius = 7.8, .cornea_asphericity = 0.75, .iris_depth = 3.3, .index = 1.376 };

struct side { bool found; double chroma[CHROMA], iris[CHROMA]; };

/* Median colour of what the evidence takes for iris, half to four fifths of the way out. */
static bool iris_of(double out[CHROMA], const struct photo *photo, const struct fit *fit, const struct evidence *evidence)
{
	enum { MOST = 4096 };
	static double x[CHROMA][MOST];
	int n = 0;
	const double c = cos(fit->limbus.angle), s = sin(fit->limbus.angle);
	for (double r = 0.5; r < 0.8; r += 0.03)
		for (double t = 0; t < 2 * M_PI && n < MOST; t += 0.02) {
			const double u = r * fit->limbus.a * cos(t), v = r * fit->limbus.b * sin(t), px = fit->limbus.cx + c * u - s * v, py = fit->limbus.cy + s * u + c * v;
			double rgb[3];
			if (!(evidence_at(evidence, EVIDENCE_IRIS, px, py) > 0.5F) || !photo_patch(rgb, photo, px, py, 1) || !(fmin(rgb[0], fmin(rgb[1], rgb[2])) > 0.002))
				continue;
			double chroma[CHROMA];
			chroma_of(chroma, rgb);
			x[0][n] = chroma[0];
			x[1][n++] = chroma[1];
		}
	for (int k = 0; k < CHROMA; k++)
		out[k] = n ? stats_median(n, x[k]) : 0;
	return n > 50;
}

/* As the stage measures it (stages/pigment/find_white.c): the light by the sclera's shading, then white under it. */
static struct side side_of(const struct photo *photo, const struct unseen_eye *eye, struct evidence_net *net, const struct white_conf *conf)
{
	static struct pale samples[PALE_MAX];
	const struct balance_conf balance = iris_balance_conf();
	struct fit fit = { .ok = true, .limbus = eye->limbus, .width = photo->width, .height = photo->height };
	struct side out = { 0 };
	struct evidence evidence;
	struct err err = { 0 };
	struct white white;
	if (!evidence_window(&evidence, net, photo, fit.limbus.cx, fit.limbus.cy, fit.limbus.a, &err))
		return out;
	const struct balance first = balance_sclera(photo, &fit, &evidence, &balance);
	struct pale_conf pale = conf->pale;
	pale.white = first.found ? log(first.rgb[0] / first.rgb[1]) : 0;
	const int n = pale_find(samples, photo, &fit, &anatomy, &evidence, &pale);
	const struct sclera_light shading = sclera_light_fit(samples, n);
	struct envmap env = sclera_light_environment(&shading, ENV_ROWS);
	out.found = white_sclera(&white, samples, n, &env, conf) && iris_of(out.iris, photo, &fit, &evidence);
	if (out.found)
		chroma_of(out.chroma, white.rgb);
	envmap_free(&env);
	evidence_free(&evidence);
	return out;
}

static double apart(const double a[CHROMA], const double b[CHROMA]) { return hypot(a[0] - b[0], a[1] - b[1]); }

/* Each method's colours at both eyes. */
static void measure(double chroma[METHODS][2][CHROMA], const struct side side[2], const struct white_pair_conf *conf)
{
	for (int k = 0; k < 2; k++) {
		double iris[CHROMA];
		for (int c = 0; c < CHROMA; c++) {
			chroma[OWN][k][c] = side[k].chroma[c];
			chroma[MEAN][k][c] = (side[0].chroma[c] + side[1].chroma[c]) / 2;
			iris[c] = side[k].iris[c] - side[1 - k].iris[c];
		}
		white_pair(chroma[JOINED][k], side[k].chroma, side[1 - k].chroma, iris, conf);
	}
}

/* The left eye's half of a face in light of another colour; truth: white there, moved with it. */
static void tint_half(struct unseen *u, double truth[CHROMA], int i)
{
	struct rng rng = { 7000 + (uint64_t)i };
	const double warm = rng_range(&rng, -0.3, 0.3), by[3] = { exp(fmin(0, warm)), exp(-fabs(warm) / 2), exp(fmin(0, -warm)) };
	const struct ellipse *a = &u->eye[FACES_LEFT].limbus, *b = &u->eye[FACES_RIGHT].limbus;
	for (int y = 0; y < u->photo.height; y++)
		for (int x = 0; x < u->photo.width; x++) {
			if (hypot(x - a->cx, y - a->cy) > hypot(x - b->cx, y - b->cy))
				continue;
			uint16_t *p = u->photo.rgb + 3 * ((size_t)y * (size_t)u->photo.width + (size_t)x);
			for (int c = 0; c < 3; c++)
				p[c] = (uint16_t)(65535 * srgb_from_linear(linear_from_srgb((float)p[c] / 65535) * (float)by[c]) + 0.5F);
		}
	truth[0] += log(by[0] / by[1]);
	truth[1] += log(by[2] / by[1]);
}

/* Faces in one light, or with a second one that reaches one eye alone: that half of the picture is multiplied by a colour. */
static void faces(struct evidence_net *net, bool two_lights, const char *setting)
{
	enum { MOST = 400 };
	static double off[METHODS][2 * MOST], differ[METHODS][MOST];
	const char *said = getenv("FACES"), *seed = getenv("SEED");
	const int wanted = said ? atoi(said) : bench_quick() ? 20 : 150;
	int n = 0;
	for (int i = 0; i < wanted && i < MOST; i++) {
		struct unseen u = faces_make(seed ? strtoull(seed, 0, 10) : 1, i, false, i % 2);
		struct side side[2];
		double truth[2][CHROMA], chroma[METHODS][2][CHROMA];
		for (int k = 0; k < 2; k++)
			chroma_of(truth[k], u.white);
		if (two_lights)
			tint_half(&u, truth[FACES_LEFT], i);
		for (int k = 0; k < 2; k++)
			side[k] = side_of(&u.photo, &u.eye[k], net, &white_defaults);
		if (side[0].found && side[1].found) {
			measure(chroma, side, &white_pair_defaults);
			for (int m = 0; m < METHODS; m++) {
				for (int k = 0; k < 2; k++)
					off[m][2 * n + k] = apart(chroma[m][k], truth[k]);
				double d[CHROMA];
				for (int c = 0; c < CHROMA; c++)
					d[c] = chroma[m][0][c] - chroma[m][1][c] - (truth[0][c] - truth[1][c]);
				differ[m][n] = hypot(d[0], d[1]);
			}
			n++;
		}
		unseen_free(&u);
	}
	if (!n)
		return;
	for (int m = 0; m < METHODS; m++) {
		double mean = 0;
		for (int i = 0; i < 2 * n; i++)
			mean += off[m][i] / (2 * n);
		bench_row("white of faces", methods[m], setting, untimed, "eye", mean, "ln", "error of ln R/G, ln B/G together, mean");
		bench_row("white of faces", methods[m], setting, untimed, "eye", stats_quantile(2 * n, off[m], 0.9), "ln", "the same, 90 %");
		bench_row("white of faces", methods[m], setting, untimed, "face", stats_quantile(n, differ[m], 0.5), "ln", "error of the difference between both eyes, median");
		bench_row("white of faces", methods[m], setting, untimed, "face", stats_quantile(n, differ[m], 0.9), "ln", "the same, 90 %");
	}
}

/* ---- the sclera's own colour and brightness ------------------------------------------------------------------------------- */
enum { BY_COLOUR, BY_EVIDENCE, FINDERS };
static const char *const finders[FINDERS] = { "the palest beside the iris", "of what the network takes for sclera" };

struct found_sclera { int n, wrong, lost, eyes; double level[4096], chroma[4096]; };

static double luminance(const double rgb[3]) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }

static int by_first(const void *a, const void *b)
{
	const double *p = a, *q = b;
	return (*p > *q) - (*p < *q);
}

/* The mean of the brighter half, without the brightest twentieth, of what is labelled as sclera within the ring. False: it is less of the ring than is asked for. */
static bool labelled(double out[3], const struct drawn *d, const struct photo *photo, const struct ellipse *e, const struct white_conf *conf)
{
	enum { MOST = 20000 };
	static double s[MOST][4];
	const double c = cos(e->angle), t = sin(e->angle), step = fmax(1, e->a / 40);
	int n = 0, ring = 0;
	for (double y = e->cy - 1.6 * e->a; y < e->cy + 1.6 * e->a; y += step)
		for (double x = e->cx - 1.6 * e->a; x < e->cx + 1.6 * e->a; x += step) {
			const double u = x - e->cx, v = y - e->cy, away = hypot((c * u + t * v) / e->a, (c * v - t * u) / e->b);
			if (away < conf->pale.inner || away > conf->pale.outer)
				continue;
			ring++;
			if (x < 0 || y < 0 || x >= d->width || y >= d->height || d->label[(long)y * d->width + (long)x] != EVIDENCE_SCLERA || n == MOST
			    || !photo_patch(s[n] + 1, photo, x, y, 0.5))
				continue;
			s[n][0] = luminance(s[n] + 1);
			n++;
		}
	if (!(n > 1.5 * conf->share_min * ring))
		return false;
	qsort(s, (size_t)n, sizeof *s, by_first);
	const int low = n / 2, high = n - n / 20;
	for (int k = 0; k < 3; k++) {
		out[k] = 0;
		for (int i = low; i < high; i++)
			out[k] += s[i][k + 1] / (high - low);
	}
	return true;
}

static void find_sclera(struct found_sclera by[FINDERS], const struct drawn *d, const struct photo *photo, int eye, struct evidence_net *net, const struct envmap *even)
{
	static struct pale samples[PALE_MAX];
	const float *l = d->eye[eye].limbus;
	struct fit fit = { .ok = true, .limbus = { (double)l[0], (double)l[1], (double)l[2], (double)l[3], (double)l[4] }, .width = photo->width, .height = photo->height };
	const struct white_conf *conf = &white_defaults;
	const struct balance_conf balance = iris_balance_conf();
	struct evidence evidence;
	struct err err = { 0 };
	double truth[3];
	if (d->eye[eye].shown < 0.3F || !evidence_window(&evidence, net, photo, fit.limbus.cx, fit.limbus.cy, fit.limbus.a, &err))
		return;
	const bool there = labelled(truth, d, photo, &fit.limbus, conf);
	const struct balance first = balance_sclera(photo, &fit, &evidence, &balance);
	struct pale_conf pale = conf->pale;
	pale.white = first.found ? log(first.rgb[0] / first.rgb[1]) : 0;
	for (int m = 0; m < FINDERS; m++) {
		struct white white;
		const bool found = white_sclera(&white, samples, pale_find(samples, photo, &fit, &anatomy, m == BY_EVIDENCE ? &evidence : 0, &pale), even, conf);
		by[m].eyes++;
		by[m].lost += there && !found;
		if (!there || !found || by[m].n == 4096)
			continue;
		double seen[3], a[CHROMA], b[CHROMA];
		for (int k = 0; k < 3; k++)
			seen[k] = white.rgb[k] * conf->sclera[k];
		chroma_of(a, seen);
		chroma_of(b, truth);
		by[m].level[by[m].n] = fabs(log(luminance(seen) / luminance(truth)));
		by[m].chroma[by[m].n++] = apart(a, b);
	}
	evidence_free(&evidence);
}

static void sclera_rows(struct found_sclera by[FINDERS], const char *setting)
{
	for (int m = 0; m < FINDERS && by[m].n; m++) {
		bench_row("the sclera beside the iris", finders[m], setting, untimed, "eye", stats_quantile(by[m].n, by[m].level, 0.5), "ln", "brightness off by, median");
		bench_row("the sclera beside the iris", finders[m], setting, untimed, "eye", stats_quantile(by[m].n, by[m].level, 0.9), "ln", "the same, 90 %");
		bench_row("the sclera beside the iris", finders[m], setting, untimed, "eye", stats_quantile(by[m].n, by[m].chroma, 0.9), "ln", "ln R/G, ln B/G off by, 90 %");
		bench_row("the sclera beside the iris", finders[m], setting, untimed, "eye", 100.0 * by[m].lost / by[m].eyes, "%", "shows and is not found");
	}
}

/* The sclera's colour and brightness against labels: of drawn portraits of the test split, and of heads in three dimensions ($EYEWRIGHT_HEADS). */
static void scleras(struct evidence_net *net)
{
	static struct found_sclera by[FINDERS];
	static const double grey[3] = { 1, 1, 1 };
	const char *said = getenv("EYES"), *kept = getenv("EYEWRIGHT_HEADS");
	const int wanted = said ? atoi(said) : bench_quick() ? 30 : 300;
	struct envmap even = envmap_room(64, grey, grey, 1, 0, 0);
	struct drawn d;
	for (int i = 0; i < wanted; i++) {
		const struct drawn_view view = { .radius = 40 + 5.0F * (float)(i % 30), .x = 480, .y = 360, .portrait = true };
		d = drawn_photograph(52000 + (uint64_t)i, &view, 960, 720);
		struct photo photo = unseen_photo(d.rgb, d.width, d.height);
		for (int k = 0; k < d.n_eyes; k++)
			find_sclera(by, &d, &photo, k, net, &even);
		photo_free(&photo);
		drawn_free(&d);
	}
	sclera_rows(by, "drawn portraits");
	FILE *file = kept ? fopen(kept, "rb") : 0;
	memset(by, 0, sizeof by);
	while (file && kept_next(&d, file)) {
		struct photo photo = unseen_photo(d.rgb, d.width, d.height);
		for (int k = 0; k < d.n_eyes; k++)
			find_sclera(by, &d, &photo, k, net, &even);
		photo_free(&photo);
		drawn_free(&d);
	}
	if (file)
		fclose(file);
	sclera_rows(by, "heads in three dimensions");
	envmap_free(&even);
}

int main(int argc, char **argv)
{
	struct evidence_net *net;
	struct err err = { 0 };
	bench_open("white", argc, argv);
	if (!evidence_open(&net, "config/evidence.onnx", &err)) {
		fprintf(stderr, "bench_white: %s\n", err.msg);
		return 1;
	}
	faces(net, false, "drawn faces, one light");
	faces(net, true, "drawn faces, another light at one eye");
	scleras(net);
	evidence_close(net);
	return bench_close();
}
