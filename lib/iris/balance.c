#include "iris/balance.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/photo/patch.h"

static const float sure = 0.6f;      // evidence from which a place counts as sclera

struct sample {
	float rgb[3], light, redness;
};

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

/* Distance of a place from the limbus's middle, in its semi-axes. */
static double axes_away(const struct ellipse *e, double x, double y)
{
	double dx = x - e->cx, dy = y - e->cy, c = cos(e->angle), s = sin(e->angle);
	return hypot((c * dx + s * dy) / e->a, (c * dy - s * dx) / e->b);
}

/* The places of the ring that are sclera; *ring: how many places it has. */
static int take(struct sample s[], int *ring, const struct photo *photo, const struct fit *fit, const struct evidence *e,
                const struct balance_conf *conf)
{
	int n = 0;
	*ring = 0;
	for (int j = 0; j < e->height; j++)
		for (int i = 0; i < e->width; i++) {
			double x = e->x0 + (i + 0.5) * e->scale, y = e->y0 + (j + 0.5) * e->scale, rgb[3], away = axes_away(&fit->limbus, x, y);
			if (away < conf->inner || away > conf->outer)
				continue;
			++*ring;
			if (e->plane[EVIDENCE_SCLERA][(long)j * e->width + i] < sure || !photo_patch(rgb, photo, x, y, 0.2 * e->scale))
				continue;
			double light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
			if (light > 0.004)
				s[n++] = (struct sample){ { (float)rgb[0], (float)rgb[1], (float)rgb[2] }, (float)light, (float)log(rgb[0] / fmax(rgb[1], 1e-4)) };
		}
	return n;
}

struct balance balance_none(void)
{
	return (struct balance){ .rgb = { 1, 1, 1 } };
}

struct balance balance_sclera(const struct photo *photo, const struct fit *fit, const struct evidence *evidence, const struct balance_conf *conf)
{
	struct balance out = balance_none();
	if (!evidence)
		return out;
	int ring, from = 0;
	struct sample *s = mem_array((size_t)evidence->width * (size_t)evidence->height, sizeof *s);
	int n = take(s, &ring, photo, fit, evidence, conf);
	qsort(s, (size_t)n, sizeof *s, by_light);
	while (from < n && s[from].light < conf->dark * s[n * 9 / 10].light)
		from++;
	struct sample *lit = s + from;
	n -= from;
	out.share = ring ? (double)n / ring : 0;
	qsort(lit, (size_t)n, sizeof *lit, by_redness);
	n -= n / 4;
	qsort(lit, (size_t)n, sizeof *lit, by_light);
	int low = n / 2, high = n - n / 20, k = high - low;
	out.found = k > 0 && out.share > conf->share_min;
	if (out.found) {
		double sum[3] = { 0 };
		for (int i = low; i < high; i++)
			for (int c = 0; c < 3; c++)
				sum[c] += lit[i].rgb[c] / k;
		for (int c = 0; c < 3; c++)
			out.rgb[c] = (out.sclera[c] = sum[c]) / conf->sclera[c];
		out.spread = log(lit[high - 1].light / lit[low].light) / 2;
	}
	free(s);
	return out;
}

double balance_kelvin(const double rgb[3])
{
	double X = 0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2], Y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
	double Z = 0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2], sum = X + Y + Z, x = X / sum, y = Y / sum;
	double n = (x - 0.3320) / (0.1858 - y);
	double kelvin = 449 * n * n * n + 3525 * n * n + 6823.3 * n + 5520.33;
	return sum > 0 && kelvin > 1500 && kelvin < 25000 ? kelvin : NAN;
}
