/* What the film does not show of the skin. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/complexion/impl.h"
#include "draw/smooth.h"

static const double alike_mm = 3;        // over more than this both halves of a face have the same colour
static const double seam_mm = 0.8;       // over which what is seen goes over into what is not
static const double brighter_ln = 0.15;  // shadows are cast, lights hardly: of halves that differ by more than this the brighter counts
static const double most_grey = 0.14, most_hue = 0.07;  // ln: of skin over centimetres: dark rings, red cheeks
enum { SCALES = 6 };
static const double first_mm = 1.5;      // the finest scale of the fill; each further one is twice as wide

bool complexion_blur(float *out, float *sum, const float *map, const float *weight, int channels, double mm, const struct complexion *c, struct err *err)
{
	const size_t n = (size_t)c->side * (size_t)c->side;
	float *both = mem_array(n * (size_t)(channels + 1) + 1, sizeof *both);
	for (size_t i = 0; i < n; i++) {
		float *to = both + i * (size_t)(channels + 1);
		for (int k = 0; k < channels; k++)
			to[k] = weight[i] > 0 ? weight[i] * map[i * (size_t)channels + (size_t)k] : 0;
		to[channels] = weight[i];
	}
	const bool ok = cv_blur(both, both, c->side, c->side, channels + 1, mm / c->texel_mm, err);
	for (size_t i = 0; i < n && ok; i++) {
		const float *from = both + i * (size_t)(channels + 1), all = fmaxf(from[channels], 0);
		for (int k = 0; k < channels; k++)
			out[i * (size_t)channels + (size_t)k] = all > 1e-6f ? from[k] / all : 0;
		if (sum)
			sum[i] = all > 1e-6f ? all : 0;
	}
	free(both);
	return ok;
}

bool complexion_place(float x[3], const struct complexion *c, long i)
{
	const struct complexion_spot *s = &c->spot[i];
	if (s->face < 0)
		return false;
	const int32_t *v = c->mesh->faces[s->face];
	complexion_spot_mean(x, (const float(*)[3])c->mesh->vertices, v, s);
	return true;
}

static long other(const struct complexion *c, long i)
{
	return i - i % c->side + c->side - 1 - i % c->side;
}

/* Takes off what differs between the halves over centimetres: light. */
static bool even(float (*ln)[3], const float *weight, const struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	float (*low)[3] = mem_array((size_t)n + 1, sizeof *low), (*off)[3] = mem_array((size_t)n + 1, sizeof *off);
	float *near = mem_array((size_t)n + 1, sizeof *near), *both = mem_array((size_t)n + 1, sizeof *both);
	bool ok = complexion_blur(&low[0][0], near, &ln[0][0], weight, 3, alike_mm, c, err);
	for (long i = 0; i < n && ok; i++) {
		const long o = other(c, i);
		both[i] = smooth(0, 1, 2 * fminf(near[i], near[o]));
		for (int k = 0; k < 3; k++) {
			const float apart = (low[o][k] - low[i][k]) / (float)brighter_ln;
			off[i][k] = -(float)brighter_ln * logf(0.5f + 0.5f * expf(fminf(apart, 20)));
		}
	}
	// Where one half alone is seen, as much as beside it.
	ok = ok && complexion_blur(&low[0][0], near, &off[0][0], both, 3, 2 * alike_mm, c, err);
	for (long i = 0; i < n && ok; i++)
		for (int k = 0; k < 3; k++)
			ln[i][k] -= both[i] * off[i][k] + (1 - both[i]) * smooth(0, 1, 4 * near[i]) * low[i][k];
	free(low);
	free(off);
	free(near);
	free(both);
	return ok;
}

/* Where colour and brightness leave the mean over centimetres by more than skin's do, they are shadow or gloss: draws them in. */
static bool temper(float (*ln)[3], const float *weight, const struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	float (*low)[3] = mem_array((size_t)n + 1, sizeof *low);
	const bool ok = complexion_blur(&low[0][0], 0, &ln[0][0], weight, 3, alike_mm, c, err);
	for (long i = 0; i < n && ok; i++) {
		if (!(weight[i] > 0))
			continue;
		float off[3];
		for (int k = 0; k < 3; k++)
			off[k] = low[i][k] - c->mean[k];
		const double grey = complexion_luminance(off), less = most_grey * tanh(grey / most_grey);
		for (int k = 0; k < 3; k++) {
			const double hue = (double)off[k] - grey;
			ln[i][k] += (float)(less + most_hue * tanh(hue / most_hue) - (double)off[k]);
		}
	}
	free(low);
	return ok;
}

/* Means over wider and wider surroundings, the finest that know enough. ln: in and out where known is 0. */
static bool around(float (*out)[3], const float (*ln)[3], const float *known, const struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	float (*mean)[3] = mem_array((size_t)n + 1, sizeof *mean), *near = mem_array((size_t)n + 1, sizeof *near);
	bool ok = true;
	for (long i = 0; i < n; i++)
		memcpy(out[i], c->mean, sizeof *out);
	for (int s = SCALES - 1; s >= 0 && ok; s--) {
		ok = complexion_blur(&mean[0][0], near, &ln[0][0], known, 3, first_mm * (1 << s), c, err);
		for (long i = 0; i < n && ok; i++) {
			const float t = smooth(0, 1, near[i] / 0.3f);
			for (int k = 0; k < 3; k++)
				out[i][k] += t * (mean[i][k] - out[i][k]);
		}
	}
	free(mean);
	free(near);
	return ok;
}

/* Share of each texel that is shown as seen: 0 where it is not, rising from there. */
static bool shares(float *share, const float *weight, const struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	for (long i = 0; i < n; i++)
		share[i] = weight[i] > 0;
	const bool ok = cv_blur(share, share, c->side, c->side, 1, seam_mm / c->texel_mm, err);
	for (long i = 0; i < n; i++)
		share[i] = weight[i] > 0 ? smooth(0, 1, 2 * share[i] - 1) : 0;
	return ok;
}

static void mean_of(float mean[3], const float (*ln)[3], const float *weight, long n)
{
	double sum[3] = { 0 }, all = 1e-9;
	for (long i = 0; i < n; i++)
		if (weight[i] > 0) {
			for (int k = 0; k < 3; k++)
				sum[k] += (double)ln[i][k];
			all++;
		}
	for (int k = 0; k < 3; k++)
		mean[k] = (float)(sum[k] / all);
}

/* Shares of the face near the eyes. */
static void shares_near(double *seen, double *mirrored, const float *own, const float *real, const struct complexion *c)
{
	static const double near_mm = 60;
	double all = 1e-9, mine = 0, both = 0;
	for (long i = 0; i < (long)c->side * c->side; i += 7) {
		float x[3];
		double d[3];
		if (!complexion_place(x, c, i))
			continue;
		for (int k = 0; k < 3; k++)
			d[k] = (double)x[k] - 0.5 * (c->eye[0][k] + c->eye[1][k]);
		if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > near_mm * near_mm)
			continue;
		all++;
		mine += (double)own[i];
		both += (double)real[i];
	}
	*seen = mine / all;
	*mirrored = (both - mine) / all;
}

bool complexion_fill(float (*ln)[3], float *real, const float *weight, double *seen, double *mirrored, struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	float *own = mem_array((size_t)n + 1, sizeof *own), *known = mem_array((size_t)n + 1, sizeof *known);
	float (*all)[3] = mem_array((size_t)n + 1, sizeof *all), (*low)[3] = mem_array((size_t)n + 1, sizeof *low);
	bool ok = even(ln, weight, c, err) && shares(own, weight, c, err);
	mean_of(c->mean, (const float(*)[3])ln, weight, n);
	ok = ok && temper(ln, weight, c, err);
	for (long i = 0; i < n && ok; i++) {
		const long o = other(c, i);
		const float a = own[i], b = (1 - a) * own[o];
		known[i] = a + b;
		for (int k = 0; k < 3; k++)
			all[i][k] = a + b > 0 ? (a * ln[i][k] + b * ln[o][k]) / (a + b) : 0;
	}
	ok = ok && around(low, (const float(*)[3])all, known, c, err);
	for (long i = 0; i < n && ok; i++) {
		real[i] = known[i];
		for (int k = 0; k < 3; k++)
			ln[i][k] = low[i][k] + known[i] * (all[i][k] - low[i][k]);
	}
	if (ok)
		shares_near(seen, mirrored, own, real, c);
	free(own);
	free(known);
	free(all);
	free(low);
	return ok;
}
