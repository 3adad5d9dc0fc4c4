#include "lens.h"

#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

/* Weighted mean along one direction: n taps at (dx, dy) px spacing. */
static void along(struct canvas *c, float dx, float dy, int n, const float *weight)
{
	const size_t size = (size_t)c->width * (size_t)c->height * 3;
	float *out = calloc(size, sizeof(float));
	for (int k = 0; k < n; k++) {
		const int ox = (int)lroundf(dx * (float)(k - n / 2)), oy = (int)lroundf(dy * (float)(k - n / 2));
		for (int y = 0; y < c->height; y++) {
			const int sy = y + oy < 0 ? 0 : y + oy >= c->height ? c->height - 1 : y + oy;
			const float *from = c->rgb + (long)sy * c->width * 3;
			float *to = out + (long)y * c->width * 3;
			for (int x = 0; x < c->width; x++) {
				const int sx = x + ox < 0 ? 0 : x + ox >= c->width ? c->width - 1 : x + ox;
				for (int i = 0; i < 3; i++)
					to[3 * x + i] += weight[k] * from[3 * sx + i];
			}
		}
	}
	free(c->rgb);
	c->rgb = out;
}

static void blur(struct canvas *c, float sigma)
{
	enum { MOST = 21 };
	int half = (int)ceilf(2.5F * sigma);
	half = half > MOST / 2 ? MOST / 2 : half;
	float weight[MOST], sum = 0;
	for (int k = -half; k <= half; k++)
		sum += weight[k + half] = expf(-0.5F * (float)(k * k) / (sigma * sigma));
	for (int k = 0; k <= 2 * half; k++)
		weight[k] /= sum;
	along(c, 1, 0, 2 * half + 1, weight);
	along(c, 0, 1, 2 * half + 1, weight);
}

static void sharpen(struct canvas *c, struct rng *rng)
{
	const size_t size = (size_t)c->width * (size_t)c->height * 3;
	float *was = malloc(size * sizeof(float));
	memcpy(was, c->rgb, size * sizeof(float));
	blur(c, range_of(rng, 0.6, 1.5));
	const float by = range_of(rng, 0.3, 1.5);
	for (size_t i = 0; i < size; i++)
		c->rgb[i] = fmaxf(was[i] + by * (was[i] - c->rgb[i]), 0);
	free(was);
}

static void optics(struct canvas *c, struct rng *rng)
{
	const float soft = expf((float)(-0.75 + 0.65 * rng_normal(rng)));
	if (soft > 0.25F)
		blur(c, fminf(soft, 4));
	if (!rng_below(rng, 12)) {
		enum { TAPS = 9 };
		float weight[TAPS];
		for (int k = 0; k < TAPS; k++)
			weight[k] = 1.0F / TAPS;
		const float turn = range_of(rng, 0, 3.14159), length = range_of(rng, 0.2, 1.3);
		along(c, length * cosf(turn), length * sinf(turn), TAPS, weight);
	}
	if (!rng_below(rng, 6))
		sharpen(c, rng);
}

struct develop {
	float gain[3], mix, contrast, gamma, lift, vignette, noise[2];
	int grey;  // 0 colour, 1 grey, 2 sepia
};

static struct develop develop_make(const float white[3], bool photo, struct rng *rng)
{
	struct develop d = { .mix = range_of(rng, 0.4, 1.5), .contrast = range_of(rng, -0.15, 0.6), .gamma = range_of(rng, 0.75, 1.3) };
	float stops = (float)((photo ? 0.5 : 0.75) * rng_normal(rng)), balanced = range_of(rng, photo ? 0.1 : -0.2, 1.1);
	stops = stops < -2 ? -2 : stops > 2 ? 2 : stops;
	for (int i = 0; i < 3; i++)
		d.gain[i] = 0.75F * exp2f(stops) / white[1] * powf(white[1] / white[i], balanced) * (1 + 0.06F * (float)rng_normal(rng));
	d.lift = rng_below(rng, 3) ? 0 : range_of(rng, 0, 0.1);
	d.vignette = rng_below(rng, 4) ? 0 : range_of(rng, 0, 0.7);
	const float noisy = range_of(rng, 0, 1);
	d.noise[0] = 0.0003F + 0.008F * noisy * noisy * noisy;
	d.noise[1] = 0.001F + 0.02F * noisy * noisy * noisy;
	const int grey = rng_below(rng, 40);
	d.grey = grey < 4 ? 1 : grey == 4 ? 2 : 0;
	if (photo && rng_below(rng, 10) < 7) {
		d.contrast = d.lift = 0;
		d.gamma = 1;
	}
	return d;
}

/* Encoded values of linear 0..1 in 4096 steps of the square root, after the tone curve. */
static void tone_table(uint8_t table[4096], const struct develop *d)
{
	for (int i = 0; i < 4096; i++) {
		const float root = (float)i / 4095, linear = root * root;
		float v = linear <= 0.0031308F ? 12.92F * linear : 1.055F * powf(linear, 1 / 2.4F) - 0.055F;
		v = powf(v, d->gamma);
		v += d->contrast * (v * v * (3 - 2 * v) - v);
		v = d->lift + (1 - d->lift) * v;
		table[i] = (uint8_t)(v < 0 ? 0 : v > 1 ? 255 : lroundf(255 * v));
	}
}

static void develop(uint8_t *rgb, const struct canvas *c, const struct develop *d, struct rng *rng)
{
	uint8_t table[4096];
	tone_table(table, d);
	const float cx = 0.5F * (float)c->width, cy = 0.5F * (float)c->height;
	for (int y = 0; y < c->height; y++)
		for (int x = 0; x < c->width; x++) {
			const float *from = c->rgb + 3 * ((long)y * c->width + x), ex = ((float)x - cx) / cx, ey = ((float)y - cy) / cx;
			const float fall = 1 - d->vignette * 0.5F * (ex * ex + ey * ey);
			float v[3];
			for (int i = 0; i < 3; i++) {
				v[i] = from[i] * d->gain[i] * fall;
				// Sums of uniform numbers are near enough to normal ones.
				const uint64_t bits = rng_bits(rng);
				const float sum = (float)(bits & 0xffff) + (float)(bits >> 16 & 0xffff) + (float)(bits >> 32 & 0xffff) + (float)(bits >> 48);
				v[i] += (sum / 65535 - 2) * 1.73F * sqrtf(d->noise[0] * fmaxf(v[i], 0) + d->noise[1] * d->noise[1]);
			}
			const float luma = 0.2126F * v[0] + 0.7152F * v[1] + 0.0722F * v[2];
			static const float sepia[3] = { 1.15F, 0.95F, 0.7F };
			for (int i = 0; i < 3; i++) {
				float w = d->grey ? luma * (d->grey == 2 ? sepia[i] : 1) : luma + d->mix * (v[i] - luma);
				w = w < 0 ? 0 : w > 1 ? 1 : w;
				rgb[3 * ((long)y * c->width + x) + i] = table[(int)(sqrtf(w) * 4095)];
			}
		}
}

static void jpeg(uint8_t *rgb, int width, int height, int least, struct rng *rng)
{
	tjhandle in = tjInitCompress(), out = tjInitDecompress();
	unsigned char *data = 0;
	unsigned long size = 0;
	const int quality = least + rng_below(rng, 95 - least);
	if (tjCompress2(in, rgb, width, 0, height, TJPF_RGB, &data, &size, rng_below(rng, 2) ? TJSAMP_420 : TJSAMP_444, quality, 0) == 0)
		tjDecompress2(out, data, size, rgb, width, 0, height, TJPF_RGB, 0);
	tjFree(data);
	tjDestroy(in);
	tjDestroy(out);
}

static void take(uint8_t *rgb, struct canvas *c, const struct develop *d, int least_quality, struct rng *rng)
{
	optics(c, rng);
	develop(rgb, c, d, rng);
	if (rng_below(rng, 5) < 3)
		jpeg(rgb, c->width, c->height, least_quality, rng);
}

/* The picture with `by` of its px in one, each the mean of what it covers. */
static struct canvas reduced(const struct canvas *c, float by)
{
	struct canvas out = canvas_new((int)ceilf((float)c->width / by), (int)ceilf((float)c->height / by));
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++) {
			const int x0 = (int)((float)x * by), y0 = (int)((float)y * by), x1 = (int)fminf((float)(x + 1) * by, (float)c->width), y1 = (int)fminf((float)(y + 1) * by, (float)c->height);
			float *to = out.rgb + 3 * ((long)y * out.width + x);
			for (int j = y0; j < y1; j++)
				for (int i = x0; i < x1; i++)
					for (int k = 0; k < 3; k++)
						to[k] += c->rgb[3 * ((long)j * c->width + i) + k] / (float)((x1 - x0) * (y1 - y0));
		}
	return out;
}

/* Bilinear, borders repeated. */
static void enlarge(uint8_t *rgb, int width, int height, const uint8_t *from, int w, int h, float by)
{
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const float u = fminf(fmaxf(((float)x + 0.5F) / by - 0.5F, 0), (float)w - 1.001F), v = fminf(fmaxf(((float)y + 0.5F) / by - 0.5F, 0), (float)h - 1.001F);
			const uint8_t *p = from + 3 * ((int)v * w + (int)u), *q = p + 3 * (long)w;
			const float a = u - floorf(u), b = v - floorf(v);
			for (int k = 0; k < 3; k++) {
				const float top = p[k] + a * (float)(p[k + 3] - p[k]), bottom = q[k] + a * (float)(q[k + 3] - q[k]);
				rgb[3 * ((long)y * width + x) + k] = (uint8_t)lroundf(top + b * (bottom - top));
			}
		}
}

void lens_expose(uint8_t *rgb, struct canvas *c, float white[3], float radius, bool photo, float poor, struct rng *rng)
{
	const struct develop d = develop_make(white, photo, rng);
	for (long i = 0; i < (long)c->width * c->height * 3; i++)
		c->rgb[i] = fminf(c->rgb[i], 4 / d.gain[1]);
	for (int i = 0; i < 3; i++)
		white[i] *= d.gain[i];
	const int quality = photo ? 50 - (int)(25 * poor) : 25;
	const bool whole = photo ? !(poor > 0) || range_of(rng, 0, 1) > poor : false;
	const float by = whole ? 1 : photo ? range_of(rng, 1.1, 3) : range_of(rng, 1.3, 6);
	if (whole || (!photo && rng_below(rng, 6)) || by > radius / (photo ? 8 : 5)) {
		take(rgb, c, &d, quality, rng);
		return;
	}
	struct canvas small = reduced(c, by);
	uint8_t *taken = malloc((size_t)small.width * (size_t)small.height * 3);
	take(taken, &small, &d, quality, rng);
	enlarge(rgb, c->width, c->height, taken, small.width, small.height, by);
	free(taken);
	canvas_free(&small);
}
