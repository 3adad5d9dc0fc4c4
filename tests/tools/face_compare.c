/* A driven face by another program, against render's own still, part by part: NAME_look_layers.exr OTHER.exr [SHEET.png [PARTS.exr [HAIR.exr]]]; of the first alone its width and height.
 * Prints: CIEDE2000 (mean) and structural similarity of skin away from the eyes, of skin within 6 mm of the lids' opening, of the eyeballs and of the wet line on
 * them; of their white and irises, where PARTS.exr has them (ViewLayer.IndexOB.X: 1, 2), and of lashes over skin and eyes, where HAIR.exr has them (3); px between the
 * outlines, of the head, and of the eyeballs between the lids. The exposure puts the skin's mean at 0.35. SHEET.png: ours; the other; how far it is off, four times. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/face/portrait.h"
#include "image/colour.h"
#include "image/distance/distance.h"
#include "image/exr.h"
#include "image/picture.h"
#include "tests/lib/score/likeness.h"

enum part { SKIN, LIDS, EYES, WET, WHITE, IRIS, LASHES, PARTS, NONE = -1 };
static const char *const part_names[PARTS] = { "skin", "round the eyes", "eyeballs", "wet line", "white of the eyes", "irises", "lashes" };

static bool of_globe(const float *layers)
{
	return layers[PORTRAIT_Z] > 0 && isfinite(layers[PORTRAIT_DISTANCE]);
}

/* Light of both kinds, and where there is any thing. */
static struct image picture_of(const struct image *layers)
{
	struct image out = image_new(layers->width, layers->height, 4);
	for (long i = 0; i < (long)out.width * out.height; i++) {
		const float *l = layers->px + PORTRAIT_LAYERS * i;
		for (int c = 0; c < 3; c++)
			out.px[4 * i + c] = l[PORTRAIT_DIFFUSE + c] + l[PORTRAIT_SPECULAR + c];
		out.px[4 * i + 3] = l[PORTRAIT_Z] > 0;
	}
	return out;
}

/* Px from the middle of the eyeball seen in one half of the picture to that in the other. */
static double eyes_apart(const struct image *layers)
{
	double at[2] = { 0 };
	long n[2] = { 0 };
	for (int y = 0; y < layers->height; y++)
		for (int x = 0; x < layers->width; x++)
			if (of_globe(image_at(layers, x, y))) {
				const int half = 2 * x >= layers->width;
				at[half] += x;
				n[half]++;
			}
	return at[1] / (double)n[1] - at[0] / (double)n[0];
}

/* Of each pixel; the eyes are taken as 62 mm apart. free(). */
static int8_t *parts(const struct image *layers)
{
	const long n = (long)layers->width * layers->height;
	uint8_t *material = mem_new((size_t)n, 1);
	float *off = mem_array((size_t)n, sizeof *off);
	int8_t *part = mem_array((size_t)n, 1);
	const double near_px = 6 * eyes_apart(layers) / 62;
	for (long i = 0; i < n; i++) {
		// How far skin is from the eyeballs: what the field does for them, the other way round.
		const float *l = layers->px + PORTRAIT_LAYERS * i;
		material[i] = of_globe(l) ? DISTANCE_SKIN : l[PORTRAIT_Z] > 0 ? DISTANCE_GLOBE : DISTANCE_OTHER;
		off[i] = 0;
	}
	struct distance_scene flat = { .width = layers->width, .height = layers->height, .material = material };
	distance_band(off, 0, &flat, near_px, 0);
	for (long i = 0; i < n; i++)
		part[i] = material[i] == DISTANCE_OTHER  ? NONE
		          : material[i] == DISTANCE_GLOBE ? (isfinite(off[i]) ? LIDS : SKIN)
		          : layers->px[PORTRAIT_LAYERS * i + PORTRAIT_LAKE] > 0 ? WET
		                                                                 : EYES;
	free(material);
	free(off);
	return part;
}

static double luminance(const float *p)
{
	return 0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2];
}

/* Ours where the part is, both: structure is judged where both cover. */
static double structure(const struct image *a, const struct image *b, const int8_t *part, int which, double gain)
{
	struct image p = image_new(a->width, a->height, 4), q = image_new(a->width, a->height, 4);
	memcpy(p.px, a->px, (size_t)a->width * (size_t)a->height * 4 * sizeof(float));
	memcpy(q.px, b->px, (size_t)a->width * (size_t)a->height * 4 * sizeof(float));
	for (long i = 0; i < (long)a->width * a->height; i++)
		if (part[i] != which)
			p.px[4 * i + 3] = 0;
	double s = likeness_structure(&p, &q, 0, gain);
	image_free(&p);
	image_free(&q);
	return s;
}

/* Which thing the other program has at each pixel. image_free. */
static bool things(struct image *of, const struct image *layers, const char *path, struct err *err)
{
	static const char *const index[] = { "ViewLayer.IndexOB.X" };
	return exr_read(of, path, 1, index, 1L << 24, 0, err)
	       && ((of->width == layers->width && of->height == layers->height) || err_set(err, "%s: of another size", path));
}

/* Px between the outlines of what is seen of the eyeballs, hairs away. */
static double openings(const struct image *layers, const struct image *of)
{
	struct image cover[2];
	for (int k = 0; k < 2; k++)
		cover[k] = image_new(of->width, of->height, 4);
	for (long i = 0; i < (long)of->width * of->height; i++) {
		cover[0].px[4 * i + 3] = of_globe(layers->px + PORTRAIT_LAYERS * i);
		cover[1].px[4 * i + 3] = of->px[i] > 0.5f;
	}
	const double px = likeness_outline(&cover[0], &cover[1]);
	for (int k = 0; k < 2; k++)
		image_free(&cover[k]);
	return px;
}

/* Mean difference and structure of a part. */
static void tell(enum part which, const struct image *own, const struct image *other, const int8_t *part, double gain)
{
	double sum = 0;
	long n = 0;
	for (long i = 0; i < (long)own->width * own->height; i++) {
		float p[3], q[3];
		if (part[i] != (int8_t)which || other->px[4 * i + 3] < 1)
			continue;
		for (int c = 0; c < 3; c++) {
			p[c] = (float)gain * own->px[4 * i + c];
			q[c] = (float)gain * other->px[4 * i + c];
		}
		sum += colour_difference(p, q);
		n++;
	}
	if (n)
		printf("%s: difference %.2f, structure %.3f, of %ld px\n", part_names[which], sum / (double)n, structure(own, other, part, which, gain), n);
}

static bool sheet(const char *path, const struct image *a, const struct image *b, double gain, struct err *err)
{
	struct image out = image_new(3 * a->width, a->height, 3);
	for (int y = 0; y < a->height; y++)
		for (int x = 0; x < a->width; x++)
			for (int c = 0; c < 3; c++) {
				const float p = (float)gain * image_at(a, x, y)[c], q = (float)gain * image_at(b, x, y)[c];
				image_at(&out, x, y)[c] = p;
				image_at(&out, x + a->width, y)[c] = q;
				image_at(&out, x + 2 * a->width, y)[c] = linear_from_srgb(fminf(4 * fabsf(srgb_from_linear(p) - srgb_from_linear(q)), 1));
			}
	const bool ok = picture_png_write_linear(path, &out, err);
	image_free(&out);
	return ok;
}

int main(int argc, char **argv)
{
	static const char *const names[PORTRAIT_LAYERS] = { "Z", "distance", "lake", "N.X", "N.Y", "N.Z", "diffuse.R", "diffuse.G", "diffuse.B",
		                                                "specular.R", "specular.G", "specular.B" };
	static const char *const rgba[] = { "R", "G", "B", "A" };
	struct image layers, other;
	struct err err = { 0 };
	if (argc < 2 || !exr_read(&layers, argv[1], PORTRAIT_LAYERS, names, 1L << 24, 0, &err)) {
		fprintf(stderr, "face_compare: %s\n", argc < 2 ? "LAYERS.exr [OTHER.exr [SHEET.png [PARTS.exr [HAIR.exr]]]]" : err.msg);
		return 2;
	}
	if (argc < 3) {
		printf("%d %d\n", layers.width, layers.height);
		return 0;
	}
	if (!exr_read(&other, argv[2], 4, rgba, 1L << 24, 0, &err)
	    || ((other.width != layers.width || other.height != layers.height) && !err_set(&err, "%s: of another size", argv[2]))) {
		fprintf(stderr, "face_compare: %s\n", err.msg);
		return 2;
	}
	const int width = layers.width, height = layers.height;
	const long n = (long)width * height;
	const struct image own = picture_of(&layers);
	int8_t *part = parts(&layers);
	double sum = 0;
	long count = 0;
	for (long i = 0; i < n; i++)
		if (part[i] == SKIN) {
			sum += luminance(own.px + 4 * i);
			count++;
		}
	const double gain = 0.35 * (double)count / sum;
	struct image eyes, hair;
	if ((argc > 4 && !things(&eyes, &layers, argv[4], &err)) || (argc > 5 && !things(&hair, &layers, argv[5], &err))) {
		fprintf(stderr, "face_compare: %s\n", err.msg);
		return 2;
	}
	for (int k = SKIN; k <= WET; k++)
		tell((enum part)k, &own, &other, part, gain);
	for (long i = 0; i < n && argc > 4; i++)
		if (part[i] == EYES || part[i] == WET)
			part[i] = eyes.px[i] > 1.5f ? IRIS : WHITE;
	for (int k = WHITE; k <= IRIS && argc > 4; k++)
		tell((enum part)k, &own, &other, part, gain);
	for (long i = 0; i < n && argc > 5; i++)
		part[i] = part[i] != NONE && part[i] != SKIN && hair.px[i] > 2.5f ? LASHES : part[i];
	if (argc > 5)
		tell(LASHES, &own, &other, part, gain);
	printf("outlines %.2f px\n", likeness_outline(&own, &other));
	if (argc > 4)
		printf("outlines of the eyeballs between the lids %.2f px\n", openings(&layers, &eyes));
	if (argc > 3 && !sheet(argv[3], &own, &other, gain, &err)) {
		fprintf(stderr, "face_compare: %s\n", err.msg);
		return 2;
	}
	return 0;
}
