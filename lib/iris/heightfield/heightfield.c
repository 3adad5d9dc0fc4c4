#include "iris/heightfield/heightfield.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"

/* A weighted map: value times weight, and weight. Blurring both and dividing is normalised convolution: a mean over what was
 * seen. */
struct seen {
	int n;        // texels a side
	double scale; // texels a mm
	float *px;    // [n][n][2]
};

static struct seen seen_new(int n, double extent)
{
	return (struct seen) { n, n / (2 * extent), mem_array((size_t)n * n * 2, sizeof(float)) };
}

/* out = mean of `in` under a Gaussian of sigma mm, with the weight that went into it. */
static bool mean(struct seen *out, const struct seen *in, double sigma, struct err *err)
{
	return cv_blur(out->px, in->px, in->n, in->n, 2, sigma * in->scale, err);
}

static float ratio(const float p[2])
{
	return p[1] > 1e-6f ? p[0] / p[1] : 0;
}

static float luminance(const float p[])
{
	return 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
}

/* ln luminance, weighted; weight 0 where no photograph saw the iris. shares: iris_share of every texel. Luminance is limited
 * to a hundredth of the mean from below: texels darker than that have no more information. */
static double log_luminance(struct seen *out, const struct image *clean, const float shares[])
{
	double sum = 0, weight = 0;
	long in = 0, seen = 0, n = (long)out->n * out->n;
	for (long i = 0; i < n; i++) {
		const float *p = clean->px + 4 * i;
		bool iris = shares[i] > 0 && shares[i] < 1;
		in += iris;
		seen += iris && p[3] > 0;
		out->px[2 * i + 1] = iris && isfinite(p[0] + p[1] + p[2]) ? fmaxf(p[3], 0) : 0;
		if (out->px[2 * i + 1] > 0) {
			sum += (double)out->px[2 * i + 1] * luminance(p);
			weight += out->px[2 * i + 1];
		}
	}
	float floor = weight > 0 ? (float)fmax(0.01 * sum / weight, 1e-6) : 1;
	for (long i = 0; i < n; i++) {
		float w = out->px[2 * i + 1];
		out->px[2 * i] = w > 0 ? w * logf(fmaxf(luminance(clean->px + 4 * i), floor)) : 0;
	}
	return in ? (double)seen / (double)in : 0;
}

/* Detail = fine mean - coarse mean. Texels that were not seen take their neighbours' detail, fading to none over `reach`.
 * detail [n][n]; sure [n][n] gets 1 where seen, 0 where nothing near was. */
static bool local_detail(float *detail, float *sure, const struct seen *light, const struct heightfield_conf *c,
                         struct err *err)
{
	double extent = light->n / (2 * light->scale);
	struct seen fine = seen_new(light->n, extent), coarse = seen_new(light->n, extent);
	bool ok = mean(&fine, light, c->fine, err) && mean(&coarse, light, c->coarse, err);
	long n = (long)light->n * light->n;
	for (long i = 0; ok && i < n; i++) {
		float w = fine.px[2 * i + 1], d = w > 0.02f ? ratio(fine.px + 2 * i) - ratio(coarse.px + 2 * i) : 0;
		sure[i] = fminf(w, 1);
		detail[i] = d;
		fine.px[2 * i] = w * d;
	}
	ok = ok && mean(&coarse, &fine, c->reach, err);
	for (long i = 0; ok && i < n; i++) {
		float near = coarse.px[2 * i + 1];
		// A texel's own detail has its weight, its neighbours' detail has theirs, and zero detail has a weight of 0.1.
		float own = sure[i], rest = (1 - own) * near;
		detail[i] = (own * detail[i] + rest * ratio(coarse.px + 2 * i)) / (own + rest + 0.1f * (1 - own) + 1e-6f);
	}
	free(fine.px);
	free(coarse.px);
	return ok;
}

static int ascending(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static void summary(struct heightfield_result *out, const float shares[])
{
	long n = (long)out->map.width * out->map.height, m = 0;
	float *sorted = mem_array((size_t)n / 16 + 1, sizeof *sorted);
	double sum = 0;
	for (long i = 0; i < n; i += 16) {
		if (shares[i] > 0 && shares[i] < 1)
			sum += sorted[m++] = out->map.px[2 * i];
	}
	if (m) {
		qsort(sorted, (size_t)m, sizeof *sorted, ascending);
		out->mean = sum / (double)m;
		out->low = sorted[m / 20];
		out->high = sorted[m - 1 - m / 20];
	}
	free(sorted);
}

static void compose(struct heightfield_result *out, const float detail[], const float sure[], const float shares[],
                    const struct profile *profile, const struct heightfield_conf *c)
{
	long n = (long)out->map.width * out->map.height, m = 0;
	double limit = log(c->limit), square = 0;
	for (long i = 0; i < n; i++)
		if (shares[i] > 0 && shares[i] < 1 && sure[i] > 0.5f) {
			square += c->gain * c->gain * detail[i] * detail[i];
			m++;
		}
	out->detail_rms = m ? sqrt(square / (double)m) : 0;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		double sigma, mm = profile_at(profile, shares[i], &sigma);
		bool iris = shares[i] > 0 && shares[i] < 1;
		double factor = iris ? exp(limit * tanh(c->gain * detail[i] / limit)) : 1;
		double unseen = iris ? (1 - sure[i]) * out->detail_rms : 0;
		out->map.px[2 * i] = (float)(mm * factor);
		out->map.px[2 * i + 1] = (float)(factor * hypot(sigma, mm * unseen));
	}
}

bool heightfield_run(struct heightfield_result *out, const struct image *clean, double extent, const struct pupil *pupil,
                     double limbus, const struct heightfield_conf *c, struct err *err)
{
	int n = clean->width;
	if (clean->height != n || clean->channels != 4)
		return err_set(err, "clean texture: %d x %d: must be square", n, clean->height);
	*out = (struct heightfield_result) { .root = limbus + c->profile.root_beyond_limbus };
	if (hypot(pupil->x, pupil->y) + pupil->r > out->root - 0.5)
		return err_set(err, "pupil of radius %.2f mm: leaves less than 0.5 mm of iris; photograph it in brighter light", pupil->r);
	struct profile profile;
	profile_make(&profile, &c->profile, out->root - pupil->r);

	float *shares = mem_array((size_t)n * n, sizeof *shares), *detail = mem_array((size_t)n * n, sizeof *detail);
	float *sure = mem_array((size_t)n * n, sizeof *sure);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++)
			shares[(long)y * n + x] = (float)iris_share(pupil, out->root, (2 * (x + 0.5) / n - 1) * extent, (2 * (y + 0.5) / n - 1) * extent);
	struct seen light = seen_new(n, extent);
	out->seen = log_luminance(&light, clean, shares);
	out->map = image_new(n, n, 2);
	bool ok = local_detail(detail, sure, &light, c, err);
	if (ok) {
		compose(out, detail, sure, shares, &profile, c);
		summary(out, shares);
	} else {
		image_free(&out->map);
	}
	free(light.px);
	free(shares);
	free(detail);
	free(sure);
	return ok;
}
