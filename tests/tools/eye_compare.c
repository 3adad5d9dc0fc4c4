/* A picture of an exported eye by another program, against render's own: EYE.json DEG REFERENCE.exr OTHER.npy|.exr [SIDE_BY_SIDE.png
 * [HALF.exr HALF.exr]]
 * Prints: difference of the iris and of the eye (CIEDE2000, mean), px between the glints' middles, px of the iris' registration, structural
 * similarity, px between the outlines; structural similarity without the noise that two halves of OTHER, of a seed each, tell by their difference. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/npy/npy.h"
#include "bridge/cv_blur.h"
#include "image/colour.h"
#include "image/exr.h"
#include "image/mask.h"
#include "image/picture.h"
#include "tests/lib/score/likeness.h"

static bool load(struct image *out, const char *path, struct err *err)
{
	static const char *const rgba[] = { "R", "G", "B", "A" };
	size_t n = strlen(path);
	if (n > 4 && !strcmp(path + n - 4, ".exr"))
		return exr_read(out, path, 4, rgba, 1L << 24, 0, err);
	struct npy a;
	if (!npy_read(&a, path, NPY_LIMIT, err) || !npy_expect(&a, path, 3, (long[]){ -1, -1, 4 }, err))
		return false;
	*out = image_new((int)a.shape[1], (int)a.shape[0], 4);
	memcpy(out->px, a.data, (size_t)npy_count(&a) * sizeof(float));
	npy_free(&a);
	return true;
}

static bool load_as(struct image *out, const char *path, const struct image *like, struct err *err)
{
	return load(out, path, err) && ((out->width == like->width && out->height == like->height) || err_set(err, "%s: of another size", path));
}

/* The limbus of the turned eye, px: centre, half-widths. */
struct ring {
	double cx, cy, a, b;
};

static struct ring limbus(const json_t *says, double deg, int px)
{
	const json_t *view = json_object_get(says, "reference"), *cornea = json_object_get(says, "cornea");
	double D = json_number_value(json_object_get(view, "camera_z_mm")), fov = json_number_value(json_object_get(view, "field_of_view_deg")) * M_PI / 180;
	double a = json_number_value(json_array_get(json_object_get(says, "limbus_mm"), 0)), b = json_number_value(json_array_get(json_object_get(says, "limbus_mm"), 1));
	double R = json_number_value(json_object_get(cornea, "radius_mm")), p = json_number_value(json_object_get(cornea, "asphericity"));
	double depth = a * a / (R + sqrt(R * R - p * a * a)), z = json_number_value(json_object_get(cornea, "apex_from_origin_mm")) - depth, t = deg * M_PI / 180;
	double scale = 0.5 * px / tan(0.5 * fov) / (D - z * cos(t));
	return (struct ring){ 0.5 * px + scale * z * sin(t), 0.5 * px, scale * a * cos(t), scale * b };
}

static bool inside(const struct ring *r, double k, int x, int y)
{
	return hypot((x + 0.5 - r->cx) / r->a, (y + 0.5 - r->cy) / r->b) < k;
}

static double light(const struct image *m, int x, int y)
{
	const float *p = image_at(m, x, y);
	return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

static void differences(double *iris, double *eye, const struct image *a, const struct image *b, const struct ring *r, double gain)
{
	long n_iris = 0, n_eye = 0;
	*iris = *eye = 0;
	for (int y = 0; y < a->height; y++)
		for (int x = 0; x < a->width; x++) {
			float p[3], q[3];
			if (image_at(a, x, y)[3] < 1 || image_at(b, x, y)[3] < 1)
				continue;
			for (int c = 0; c < 3; c++) {
				p[c] = (float)gain * image_at(a, x, y)[c];
				q[c] = (float)gain * image_at(b, x, y)[c];
			}
			double d = colour_difference(p, q);
			*eye += d;
			n_eye++;
			if (inside(r, 0.97, x, y)) {
				*iris += d;
				n_iris++;
			}
		}
	*iris /= (double)n_iris;
	*eye /= (double)n_eye;
}

/* Mean light of each channel inside the limbus, other over reference; pixels of reflections, far above it in the reference, left out. */
static void ratio_of(double ratio[3], const struct image *a, const struct image *b, const struct ring *r)
{
	for (int c = 0; c < 3; c++) {
		double p = 0, q = 0;
		for (int y = 0; y < a->height; y++)
			for (int x = 0; x < a->width; x++)
				if (inside(r, 0.9, x, y) && light(a, x, y) < 0.3) {
					p += image_at(a, x, y)[c];
					q += image_at(b, x, y)[c];
				}
		ratio[c] = q / p;
	}
}

/* What changes within some pixels: of light, a reflection's outline; of its logarithm, the iris' detail. */
static struct image detail(const struct image *m, bool of_logarithm, double sigma)
{
	struct image out = image_new(m->width, m->height, 1), mean = image_new(m->width, m->height, 1);
	struct err err = { 0 };
	for (int i = 0; i < m->width * m->height; i++) {
		double l = light(m, i % m->width, i / m->width);
		out.px[i] = (float)(of_logarithm ? log(fmax(l, 0.002)) : l);
	}
	cv_blur(mean.px, out.px, m->width, m->height, 1, sigma, &err);
	for (int i = 0; i < m->width * m->height; i++)
		out.px[i] -= mean.px[i];
	image_free(&mean);
	return out;
}

/* Middle of the largest patch inside the limbus that stands out of its surroundings half as much as the pixel that does most: a lamp's
 * reflection. */
static void glint(double at[2], const struct image *m, const struct ring *r)
{
	double top = 0;
	int n = m->width * m->height, *label = calloc((size_t)n, sizeof *label), best = 0;
	uint8_t *bright = calloc((size_t)n, 1);
	struct image over = detail(m, false, 12);
	for (int i = 0; i < n; i++) {
		over.px[i] = inside(r, 0.8, i % m->width, i / m->width) ? over.px[i] : 0;
		top = fmax(top, over.px[i]);
	}
	for (int i = 0; i < n; i++)
		bright[i] = over.px[i] > 0.5 * top;
	image_free(&over);
	int patches = mask_label(label, bright, m->width, m->height);
	for (int k = 1; k <= patches; k++) {
		double x = 0, y = 0;
		int count = 0;
		for (int i = 0; i < n; i++)
			if (label[i] == k) {
				x += i % m->width;
				y += i / m->width;
				count++;
			}
		if (count <= best)
			continue;
		best = count;
		at[0] = x / count;
		at[1] = y / count;
	}
	free(label);
	free(bright);
}

/* Which pixels are matched: iris without the pupil's margin, off the lamp's reflection; or those of the reflection alone. */
struct part {
	const struct ring *ring;
	const double *glint;
	bool at_glint;
};

static double match(const struct image *a, const struct image *b, const struct part *p, int dx, int dy)
{
	double ab = 0, aa = 0, bb = 0;
	for (int y = 8; y < a->height - 8; y++)
		for (int x = 8; x < a->width - 8; x++) {
			double off = hypot(x - p->glint[0], y - p->glint[1]);
			if (p->at_glint ? off > 24 : off < 30 || !inside(p->ring, 0.85, x, y) || inside(p->ring, 0.45, x, y))
				continue;
			double u = *image_at(a, x, y), v = *image_at(b, x + dx, y + dy);
			ab += u * v;
			aa += u * u;
			bb += v * v;
		}
	return ab / sqrt(aa * bb + 1e-30);
}

/* Top of the parabola through the correlation at -1, 0, 1. */
static double vertex(double low, double mid, double high)
{
	double bend = low - 2 * mid + high;
	return bend < 0 ? 0.5 * (low - high) / bend : 0;
}

/* The shift, px, at which they correlate best. */
static void registration(double off[2], double *best, const struct image *a, const struct image *b, const struct part *part)
{
	bool glint = part->at_glint;
	struct image p = detail(a, !glint, glint ? 8 : 4), q = detail(b, !glint, glint ? 8 : 4);
	int bx = 0, by = 0;
	*best = -1;
	for (int dy = -6; dy <= 6; dy++)
		for (int dx = -6; dx <= 6; dx++) {
			double m = match(&p, &q, part, dx, dy);
			if (m > *best) {
				*best = m;
				bx = dx;
				by = dy;
			}
		}
	off[0] = bx + vertex(match(&p, &q, part, bx - 1, by), *best, match(&p, &q, part, bx + 1, by));
	off[1] = by + vertex(match(&p, &q, part, bx, by - 1), *best, match(&p, &q, part, bx, by + 1));
	image_free(&p);
	image_free(&q);
}

static bool beside(const char *path, const struct image *a, const struct image *b, double gain, struct err *err)
{
	struct image out = image_new(2 * a->width, a->height, 3);
	for (int y = 0; y < a->height; y++)
		for (int x = 0; x < 2 * a->width; x++)
			for (int c = 0; c < 3; c++)
				image_at(&out, x, y)[c] = (float)gain * (x < a->width ? image_at(a, x, y) : image_at(b, x - a->width, y))[c];
	bool ok = picture_png_write_linear(path, &out, err);
	image_free(&out);
	return ok;
}

int main(int argc, char **argv)
{
	struct err err = { 0 };
	struct image a, b, half[2];
	const bool halves = argc > 7;
	json_t *says = argc >= 5 ? json_read(argv[1], 1 << 20, &err) : 0;
	if (!says || !load(&a, argv[3], &err) || !load_as(&b, argv[4], &a, &err) || (halves && (!load_as(&half[0], argv[6], &a, &err) || !load_as(&half[1], argv[7], &a, &err)))) {
		fprintf(stderr, "eye_compare: %s\n", err.msg);
		return 1;
	}
	double deg = atof(argv[2]), gain = json_number_value(json_object_get(json_object_get(says, "reference"), "exposure")), iris, eye, p[2], glints[2], ncc, ratio[3], off[2];
	struct ring r = limbus(says, deg, a.width);
	differences(&iris, &eye, &a, &b, &r, gain);
	glint(p, &a, &r);
	registration(glints, &ncc, &a, &b, &(struct part){ &r, p, true });
	registration(off, &ncc, &a, &b, &(struct part){ &r, p, false });
	ratio_of(ratio, &a, &b, &r);
	printf("%g deg: iris %.2f eye %.2f CIEDE2000, light %.3f %.3f %.3f of ours; glint %.2f px; iris detail %.2f %.2f px off, correlation %.2f; structure %.4f; outlines %.3f px\n", deg, iris, eye, ratio[0],
	       ratio[1], ratio[2], hypot(glints[0], glints[1]), off[0], off[1], ncc, likeness_structure(&a, &b, 0, gain), likeness_outline(&a, &b));
	if (halves)
		printf("without noise: %.4f\n", likeness_structure(&a, &b, (const struct image *const[2]){ &half[0], &half[1] }, gain));
	if (argc > 5 && !beside(argv[5], &a, &b, gain, &err))
		fprintf(stderr, "eye_compare: %s\n", err.msg);
	json_decref(says);
	image_free(&a);
	image_free(&b);
	for (int k = 0; k < 2 && halves; k++)
		image_free(&half[k]);
	return err_is(&err);
}
