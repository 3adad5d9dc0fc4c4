#include "tissue/pigment/white.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

const char *const white_names[] = { "camera", "sclera", "card", 0 };

enum { AROUND = 180, ACROSS = 10, SAMPLES = AROUND * ACROSS };
static const double clipped = 0.93;  // linear; above it a channel has lost its slope in most cameras' curves

struct sample {
	float rgb[3], light, redness;
};

/* Mean of a square of the photograph, linear. False outside it or where clipped. */
static bool patch(double rgb[3], const struct photo *photo, double x, double y, double radius)
{
	int r = (int)fmax(radius, 0), x0 = (int)floor(x) - r, y0 = (int)floor(y) - r, size = 2 * r + 1;
	if (x0 < 0 || y0 < 0 || x0 + size > photo->width || y0 + size > photo->height)
		return false;
	struct image part = photo_linear(photo, x0, y0, size, size);
	rgb[0] = rgb[1] = rgb[2] = 0;
	bool ok = true;
	for (int i = 0; i < 3 * size * size; i++) {
		rgb[i % 3] += part.px[i] / (size * size);
		ok = ok && part.px[i] < clipped;
	}
	image_free(&part);
	return ok;
}

struct white white_camera(void)
{
	return (struct white) { .rgb = { 1, 1, 1 }, .source = WHITE_CAMERA, .spread = 0.5 };
}

bool white_better(const struct white *a, const struct white *b)
{
	return a->source > b->source || (a->source == b->source && a->share > b->share);
}

bool white_card(struct white *out, const struct photo *photo, const double disc[3], const struct white_conf *conf,
                struct err *err)
{
	*out = (struct white) { .source = WHITE_CARD, .share = 1, .spread = 0.02 };
	if (!patch(out->rgb, photo, disc[0], disc[1], disc[2] / sqrt(2)))
		return err_set(err, "card at (%g, %g), radius %g px: outside the photograph or over-exposed", disc[0], disc[1], disc[2]);
	for (int c = 0; c < 3; c++)
		out->rgb[c] /= conf->card;
	return true;
}

static int by_light(const void *a, const void *b)
{
	const struct sample *s = a, *t = b;
	return (s->light > t->light) - (s->light < t->light);
}

static int by_redness(const void *a, const void *b)
{
	const struct sample *s = a, *t = b;
	return (s->redness > t->redness) - (s->redness < t->redness);
}

static int ring(struct sample s[SAMPLES], const struct photo *photo, const struct fit *fit, const struct white_conf *conf)
{
	const struct ellipse *e = &fit->limbus;
	double side = e->a * 0.006, c = cos(e->angle), d = sin(e->angle);
	int n = 0;
	for (int i = 0; i < SAMPLES; i++) {
		double turn = 2 * M_PI * (i / ACROSS) / AROUND;
		double scale = conf->inner + (conf->outer - conf->inner) * (i % ACROSS + 0.5) / ACROSS;
		double u = scale * e->a * cos(turn), v = scale * e->b * sin(turn), rgb[3];
		if (!patch(rgb, photo, e->cx + u * c - v * d, e->cy + u * d + v * c, side))
			continue;
		double light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
		if (light > 0.004)
			s[n++] = (struct sample) { { (float)rgb[0], (float)rgb[1], (float)rgb[2] }, (float)light, (float)log(rgb[0] / fmax(rgb[1], 1e-4)) };
	}
	return n;
}

/* Sclera is the palest bright surface beside an iris: skin is redder, lashes and folds are darker. The mean of its brighter half is
 * taken, which the lids shade as little as the iris. */
bool white_sclera(struct white *out, const struct photo *photo, const struct fit *fit, const struct white_conf *conf)
{
	struct sample *s = mem_array(SAMPLES, sizeof *s);
	int n = ring(s, photo, fit, conf), m = 0;
	*out = white_camera();
	qsort(s, (size_t)n, sizeof *s, by_light);
	float bright = n ? s[n * 9 / 10].light : 0;
	for (int i = 0; i < n; i++)
		if (s[i].light > conf->dark * bright)
			s[m++] = s[i];
	qsort(s, (size_t)m, sizeof *s, by_redness);
	int pale = 0;
	while (pale < m && s[pale].redness < fmin(s[m / 50].redness + conf->redness, conf->reddest))
		pale++;
	bool ok = pale > conf->share_min * SAMPLES;
	if (ok) {
		qsort(s, (size_t)pale, sizeof *s, by_light);
		int low = pale / 2, high = pale - pale / 20, k = high - low;
		double sum[3] = { 0 };
		for (int i = low; i < high; i++)
			for (int c = 0; c < 3; c++)
				sum[c] += s[i].rgb[c] / k;
		*out = (struct white) { .source = WHITE_SCLERA, .share = (double)pale / SAMPLES };
		for (int c = 0; c < 3; c++)
			out->rgb[c] = sum[c] / conf->sclera[c];
		out->spread = log(s[high - 1].light / s[low].light) / 2;
	}
	free(s);
	return ok;
}
