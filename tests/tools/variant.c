/* variant: one photograph made into another, for the scripts of tests/chain.
 *
 *     variant KIND IN OUT
 * KIND: grey, png8, png16, tiff16, exr, cmyk, mpx200, truncated, over, under, dark, closed, noise, cut, half, turned,
 * warm (lamps' light, not balanced away), cool (the sky's), dim (as bright as these, without colour), dusk (two stops darker),
 * middle (its inner quarter: the same lens nearer up), blurred, bent, exif (a Canon EOS 600D with 100 mm, and no more)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/photo/photo.h"
#include "tests/lib/variants/bent.h"
#include "tests/lib/variants/variant.h"

static struct pixels crop(const struct photo *photo, int x0, int y0, int width, int height, int step)
{
	struct pixels p = { width / step, height / step, 3, 0 };
	p.px = mem_array((size_t)p.width * (size_t)p.height * 3, sizeof *p.px);
	for (int y = 0; y < p.height; y++)
		for (int x = 0; x < p.width; x++)
			memcpy(p.px + 3 * ((long)y * p.width + x),
			       photo->rgb + 3 * ((long)(y0 + y * step) * photo->width + x0 + x * step), 3 * sizeof *p.px);
	return p;
}

/* A quarter turn clockwise. */
static struct pixels turn(const struct pixels *p)
{
	struct pixels t = { p->height, p->width, 3, mem_array((size_t)p->width * (size_t)p->height * 3, sizeof *t.px) };
	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < p->width; x++)
			memcpy(t.px + 3 * ((long)x * t.width + (p->height - 1 - y)), p->px + 3 * ((long)y * p->width + x), 3 * sizeof *t.px);
	return t;
}

/* Three running means of each row and column of 41 px: a hand that shook. */
static void blur(struct pixels *p)
{
	enum { HALF = 20 };
	uint16_t *line = mem_array((size_t)(p->width > p->height ? p->width : p->height), sizeof *line);
	for (int pass = 0; pass < 6; pass++) {
		int n = pass % 2 ? p->height : p->width, lines = pass % 2 ? p->width : p->height;
		long step = pass % 2 ? 3L * p->width : 3, next = pass % 2 ? 3 : 3L * p->width;
		for (int i = 0; i < 3 * lines; i++) {
			uint16_t *at = p->px + i / 3 * next + i % 3;
			long sum = 0;
			for (int k = 0; k < n; k++)
				line[k] = at[k * step];
			for (int k = -HALF; k < HALF; k++)
				sum += line[k < 0 ? 0 : k];
			for (int k = 0; k < n; k++) {
				sum += line[k + HALF < n ? k + HALF : n - 1];
				at[k * step] = (uint16_t)(sum / (2 * HALF + 1));
				sum -= line[k - HALF < 0 ? 0 : k - HALF];
			}
		}
	}
	free(line);
}

/* As a wide-angle lens bends: OpenCV's k1 k2 p1 p2 for a focal length of the picture's width. */
static void bend(struct pixels *p)
{
	const struct camera lens = { .focal_px = p->width, .center_px = { 0.5 * p->width, 0.5 * p->height },
		                         .distortion = { -0.1, 0.02, 0.002, -0.003, 0 } };
	uint16_t *out = mem_array((size_t)p->width * (size_t)p->height * 3, sizeof *out);
	bent_rgb16(out, p->px, p->width, p->height, &lens);
	free(p->px);
	p->px = out;
}

/* Exposure in linear light, clipped as a sensor does. */
static void expose(struct pixels *p, double gain)
{
	for (long i = 0; i < (long)p->width * p->height * 3; i++) {
		float v = linear_from_srgb((float)p->px[i] / 65535) * (float)gain;
		p->px[i] = (uint16_t)(65535 * srgb_from_linear(v < 1 ? v : 1));
	}
}

static double uniform(unsigned *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (*seed >> 8) / 16777216.0;
}

/* Skin with a fold where the lids meet, and its grain: a closed eye has no limbus. */
static void paint_closed(struct pixels *p)
{
	unsigned seed = 1;
	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < p->width; x++) {
			double u = (x - 0.5 * p->width) / p->width, fold = y - p->height * (0.6 - 0.5 * u * u);
			double shade = 0.75 + 0.1 * sin(0.004 * x + 0.006 * y) - 0.45 * exp(-fold * fold / 60) + 0.05 * uniform(&seed);
			for (int c = 0; c < 3; c++)
				p->px[3 * ((long)y * p->width + x) + c] = (uint16_t)(65535 * shade * (1 - 0.17 * c));
		}
}

static void paint_noise(struct pixels *p)
{
	unsigned seed = 2;
	for (long i = 0; i < (long)p->width * p->height * 3; i++)
		p->px[i] = (uint16_t)(65535 * uniform(&seed));
}

/* In light of another colour, that the camera leaves as it is; the brightest channel stays. */
static void colour(struct pixels *p, const float light[3])
{
	for (long i = 0; i < (long)p->width * p->height * 3; i++)
		p->px[i] = (uint16_t)(65535 * srgb_from_linear(light[i % 3] * linear_from_srgb((float)p->px[i] / 65535)) + 0.5F);
}

static struct pixels grey_of(const struct pixels *p)
{
	struct pixels g = { p->width, p->height, 1, mem_array((size_t)p->width * (size_t)p->height, 2) };
	for (long i = 0; i < (long)p->width * p->height; i++)
		g.px[i] = (uint16_t)((p->px[3 * i] * 2 + p->px[3 * i + 1] * 5 + p->px[3 * i + 2]) / 8);
	return g;
}

static struct pixels inks_of(const struct pixels *p)
{
	struct pixels c = { p->width, p->height, 4, mem_new((size_t)p->width * (size_t)p->height * 4, 2) };
	for (long i = 0; i < (long)p->width * p->height; i++)
		for (int k = 0; k < 3; k++)
			c.px[4 * i + k] = (uint16_t)(65535 - p->px[3 * i + k]);
	return c;
}

static bool write_exr(const struct pixels *p, const char *out, struct err *err)
{
	static const char *const rgb[] = { "R", "G", "B" };
	struct image image = image_new(p->width, p->height, 3);
	for (long i = 0; i < (long)p->width * p->height * 3; i++)
		image.px[i] = linear_from_srgb((float)p->px[i] / 65535);
	bool ok = exr_write(out, &image, rgb, EXR_FLOAT, 0, err);
	image_free(&image);
	return ok;
}

static struct blob encode(const char *kind, struct pixels *p)
{
	struct pixels other = { 0 };
	struct blob b;
	if (!strcmp(kind, "grey")) {
		other = grey_of(p);
		b = encode_jpeg(&other, 0);
	} else if (!strcmp(kind, "cmyk")) {
		other = inks_of(p);
		b = encode_jpeg(&other, 1);
	} else if (!strcmp(kind, "png8"))
		b = encode_png(p, 8);
	else if (!strcmp(kind, "png16"))
		b = encode_png(p, 16);
	else if (!strcmp(kind, "tiff16"))
		b = encode_tiff(p, 16, AS_LZW, 1);
	else
		b = encode_jpeg(p, 0);
	if (!strcmp(kind, "exif")) {
		struct blob plain = b;
		b = with_exif_of(plain, &(struct exif_block){ 1, 100, -1, -1, -1, -1 }, "Canon EOS 600D");
		free(plain.data);
	}
	if (!strcmp(kind, "mpx200"))
		claim_size(b, 20000, 10000);
	if (!strcmp(kind, "truncated"))
		b.size /= 2;
	pixels_free(&other);
	return b;
}

int main(int argc, char **argv)
{
	struct photo photo;
	struct err err = { 0 };
	if (argc != 4) {
		fprintf(stderr, "variant: KIND IN OUT\n");
		return 2;
	}
	const char *kind = argv[1];
	if (!photo_load(&photo, argv[2], 200, &err)) {
		fprintf(stderr, "variant: %s\n", err.msg);
		return 1;
	}
	int w = photo.width, h = photo.height;
	bool cut = !strcmp(kind, "cut"), middle = !strcmp(kind, "middle");  // cut: through the middle of the iris
	struct pixels p = middle ? crop(&photo, w / 4, h / 4, w / 2, h / 2, 1)
	                         : crop(&photo, 0, 0, cut ? w / 2 : w, h, strcmp(kind, "half") ? 1 : 2);
	expose(&p, !strcmp(kind, "over") ? 30 : !strcmp(kind, "under") ? 0.01 : !strcmp(kind, "dark") ? 0.1 : 1);
	if (!strcmp(kind, "dusk"))
		colour(&p, (float[3]){ 0.17F, 0.17F, 0.17F });
	if (!strcmp(kind, "warm") || !strcmp(kind, "cool") || !strcmp(kind, "dim"))
		colour(&p, *kind == 'w' ? (float[3]){ 1, 0.6F, 0.28F } : *kind == 'c' ? (float[3]){ 0.5F, 0.75F, 1 } : (float[3]){ 0.68F, 0.68F, 0.68F });
	if (!strcmp(kind, "turned")) {
		struct pixels upright = p;
		p = turn(&upright);
		pixels_free(&upright);
	}
	if (!strcmp(kind, "blurred"))
		blur(&p);
	if (!strcmp(kind, "bent"))
		bend(&p);
	if (!strcmp(kind, "closed"))
		paint_closed(&p);
	if (!strcmp(kind, "noise"))
		paint_noise(&p);
	bool ok;
	if (!strcmp(kind, "exr"))
		ok = write_exr(&p, argv[3], &err);
	else {
		struct blob b = encode(kind, &p);
		ok = file_write(argv[3], b.data, b.size, &err);
		free(b.data);
	}
	pixels_free(&p);
	photo_free(&photo);
	if (!ok)
		fprintf(stderr, "variant: %s\n", err.msg);
	return ok ? 0 : 1;
}
