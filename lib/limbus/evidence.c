#include "limbus/evidence.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_net.h"
#include "image/mask.h"
#include "image/plane.h"

enum { STEP = 32, WINDOW_WIDE = 256, WINDOW_HIGH = 160, TAPS = 4, LONG_FIRST = 64, LONG_SURE = 256, LONG_LAST = 512 };

struct evidence_net {
	struct cv_net *net;
};

bool evidence_open(struct evidence_net **out, const char *path, struct err *err)
{
	*out = 0;
	struct cv_net *net;
	if (!cv_net_open(&net, path, err))
		return false;
	float *in = mem_new((size_t)3 * STEP * STEP, sizeof *in), *planes = 0;
	int size[3] = { 0 };
	bool ok = cv_net_run(&planes, size, net, in, 3, STEP, STEP, err);
	if (ok && (size[0] != EVIDENCE_CLASSES || size[1] != STEP / 2 || size[2] != STEP / 2))
		ok = err_set(err, "%d planes of %d x %d px, must be %d of %d x %d", size[0], size[2], size[1], EVIDENCE_CLASSES, STEP / 2, STEP / 2);
	free(in);
	free(planes);
	if (!ok) {
		cv_net_close(net);
		return err_wrap(err, "%s", path);
	}
	*out = mem_new(1, sizeof **out);
	(*out)->net = net;
	return true;
}

void evidence_close(struct evidence_net *net)
{
	if (net)
		cv_net_close(net->net);
	free(net);
}

static void photo_at(float rgb[3], const struct photo *photo, double x, double y)
{
	const double u = fmin(fmax(x - 0.5, 0), photo->width - 1), v = fmin(fmax(y - 0.5, 0), photo->height - 1);
	const int i = (int)u, j = (int)v, k = i + 1 < photo->width ? 3 : 0;
	const long down = j + 1 < photo->height ? 3L * photo->width : 0;
	const float a = (float)(u - i), b = (float)(v - j);
	const uint16_t *p = photo->rgb + 3 * ((long)j * photo->width + i), *q = p + down;
	for (int c = 0; c < 3; c++) {
		const float top = p[c] + a * (float)(p[c + k] - p[c]), bottom = q[c] + a * (float)(q[c + k] - q[c]);
		rgb[c] += (top + b * (bottom - top)) / 65535;
	}
}

/* The photograph's part at (x0, y0), `scale` of its px in one of the result: the mean of up to TAPS x TAPS places in each. */
static float *resample(const struct photo *photo, double x0, double y0, double scale, int width, int height)
{
	const int taps = scale > TAPS - 1 ? TAPS : (int)ceil(fmax(scale, 1));
	const long n = (long)width * height;
	float *out = mem_array((size_t)(3 * n), sizeof *out);
#pragma omp parallel for
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			float sum[3] = { 0 };
			for (int j = 0; j < taps; j++)
				for (int i = 0; i < taps; i++)
					photo_at(sum, photo, x0 + (x + (i + 0.5) / taps) * scale, y0 + (y + (j + 0.5) / taps) * scale);
			for (int c = 0; c < 3; c++)
				out[c * n + (long)y * width + x] = sum[c] / (float)(taps * taps);
		}
	return out;
}

static void softmax(float *planes, long n)
{
#pragma omp parallel for
	for (long i = 0; i < n; i++) {
		float most = planes[i], sum = 0;
		for (int c = 1; c < EVIDENCE_CLASSES; c++)
			most = fmaxf(most, planes[c * n + i]);
		for (int c = 0; c < EVIDENCE_CLASSES; c++)
			sum += planes[c * n + i] = expf(planes[c * n + i] - most);
		for (int c = 0; c < EVIDENCE_CLASSES; c++)
			planes[c * n + i] /= sum;
	}
}

static void mirror_rows(float *planes, int n_planes, int width, int height)
{
	for (long row = 0; row < (long)n_planes * height; row++)
		for (float *p = planes + row * width, *q = p + width - 1; p < q; p++, q--) {
			const float t = *p;
			*p = *q;
			*q = t;
		}
}

/* The classes' probabilities of one picture in [3][height][width], both sides multiples of STEP. both: the mean of what the
 * picture and its mirror image say, so that mirrored photographs have mirrored evidence; `in` is changed. */
static bool classify(float **planes, int size[3], struct evidence_net *net, float *in, int width, int height, bool both, struct err *err)
{
	if (!cv_net_run(planes, size, net->net, in, 3, height, width, err))
		return false;
	const long n = (long)size[1] * size[2];
	softmax(*planes, n);
	if (!both)
		return true;
	float *other;
	mirror_rows(in, 3, width, height);
	if (!cv_net_run(&other, size, net->net, in, 3, height, width, err))
		return false;
	softmax(other, n);
	mirror_rows(other, EVIDENCE_CLASSES, size[2], size[1]);
	for (long i = 0; i < EVIDENCE_CLASSES * n; i++)
		(*planes)[i] = 0.5F * ((*planes)[i] + other[i]);
	free(other);
	return true;
}

static bool run(struct evidence *out, struct evidence_net *net, const struct photo *photo, double x0, double y0, double scale, int width,
                int height, bool both, struct err *err)
{
	float *in = resample(photo, x0, y0, scale, width, height), *planes = 0;
	int size[3];
	const bool ok = classify(&planes, size, net, in, width, height, both, err);
	free(in);
	*out = (struct evidence){ 0 };
	if (!ok) {
		free(planes);
		return false;
	}
	*out = (struct evidence){ .width = size[2], .height = size[1], .x0 = x0, .y0 = y0, .scale = scale * width / size[2] };
	for (int c = 0; c < EVIDENCE_CLASSES; c++)
		out->plane[c] = planes + c * (long)out->width * out->height;
	return true;
}

bool evidence_window(struct evidence *out, struct evidence_net *net, const struct photo *photo, double cx, double cy, double radius,
                     struct err *err)
{
	const double scale = radius / EVIDENCE_RADIUS;
	return run(out, net, photo, cx - 0.5 * WINDOW_WIDE * scale, cy - 0.5 * WINDOW_HIGH * scale, scale, WINDOW_WIDE, WINDOW_HIGH, true, err);
}

bool evidence_whole(struct evidence *out, struct evidence_net *net, const struct photo *photo, int long_px, struct err *err)
{
	const double scale = fmax(photo->width, photo->height) / (double)long_px;
	const int width = (int)ceil(photo->width / scale / STEP - 0.01) * STEP, height = (int)ceil(photo->height / scale / STEP - 0.01) * STEP;
	// What is added to reach a multiple lies on both sides.
	return run(out, net, photo, 0.5 * (photo->width - width * scale), 0.5 * (photo->height - height * scale), scale, width, height, false, err);
}

float evidence_at(const struct evidence *evidence, enum evidence_class class, double x, double y)
{
	return plane_sample(evidence->plane[class], evidence->width, evidence->height, (x - evidence->x0) / evidence->scale,
	                    (y - evidence->y0) / evidence->scale);
}

void evidence_free(struct evidence *evidence)
{
	free(evidence->plane[0]);
	*evidence = (struct evidence){ 0 };
}

struct blob {
	double mass, x, y, xx, xy, yy;
};

/* Mean evidence of the eye's parts beside the iris, on a ring of 1.15 to 1.5 radii: sclera counts as what it is. */
static double sclera_beside(const struct evidence *e, double x, double y, double radius)
{
	enum { PLACES = 48 };
	double sum = 0;
	for (int i = 0; i < PLACES; i++)
		for (int r = 0; r < 3; r++) {
			const double turn = 2 * M_PI * i / PLACES, at = radius * (1.15 + 0.15 * r);
			sum += plane_sample(e->plane[EVIDENCE_SCLERA], e->width, e->height, x + at * cos(turn), y + at * sin(turn));
		}
	return sum / (3 * PLACES);
}

static struct evidence_region region_of(const struct blob *b, const struct evidence *e, int pixels)
{
	const double x = b->x / b->mass, y = b->y / b->mass, xx = b->xx / b->mass - x * x, yy = b->yy / b->mass - y * y, xy = b->xy / b->mass - x * y;
	const double middle = 0.5 * (xx + yy), longer = middle + hypot(0.5 * (xx - yy), xy), radius = 2 * sqrt(fmax(longer, 0.25));
	const double beside = fmin(sclera_beside(e, x, y, radius) / 0.2, 1), filled = fmin(b->mass / (0.35 * M_PI * radius * radius), 1);
	// Irises of less than 6 px or more than 48 px in the input, 3 and 24 here, are told at another scale.
	const double fits = fmin(radius / 4, 1) * fmin(26 / radius, 1);
	return (struct evidence_region){ e->x0 + x * e->scale, e->y0 + y * e->scale, radius * e->scale, b->mass / pixels * (0.25 + 0.75 * beside) * filled * fits };
}

static int insert(struct evidence_region out[EVIDENCE_REGIONS], int n, struct evidence_region r)
{
	int at = n < EVIDENCE_REGIONS ? n++ : EVIDENCE_REGIONS;
	while (at > 0 && r.score > out[at - 1].score) {
		if (at < EVIDENCE_REGIONS)
			out[at] = out[at - 1];
		at--;
	}
	if (at < EVIDENCE_REGIONS)
		out[at] = r;
	return n;
}

int evidence_regions(struct evidence_region out[EVIDENCE_REGIONS], const struct evidence *e)
{
	const double least_pixels = 12;
	const long size = (long)e->width * e->height;
	uint8_t *mask = mem_array((size_t)size, 1);
	int *label = mem_array((size_t)size, sizeof *label);
	for (long i = 0; i < size; i++)
		mask[i] = e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_PUPIL][i] + e->plane[EVIDENCE_REFLECTION][i] > 0.5F;
	const int blobs = mask_label(label, mask, e->width, e->height);
	struct blob *blob = mem_new((size_t)blobs + 1, sizeof *blob);
	int *pixels = mem_new((size_t)blobs + 1, sizeof *pixels), n = 0;
	for (long i = 0; i < size; i++) {
		if (!label[i])
			continue;
		struct blob *b = &blob[label[i]];
		const double p = e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_PUPIL][i], x = (double)(i % e->width) + 0.5, y = (double)(i / e->width) + 0.5;
		pixels[label[i]]++;
		b->mass += p;
		b->x += p * x;
		b->y += p * y;
		b->xx += p * x * x;
		b->xy += p * x * y;
		b->yy += p * y * y;
	}
	for (int k = 1; k <= blobs; k++)
		if (blob[k].mass >= least_pixels)
			n = insert(out, n, region_of(&blob[k], e, pixels[k]));
	free(mask);
	free(label);
	free(blob);
	free(pixels);
	return n;
}

/* Candidates of one scale among those of others: of two at one place the better stays; where they agree on the radius, too, it
 * gains what the other says. */
static int merge(struct evidence_region out[EVIDENCE_REGIONS], int n, const struct evidence_region *more, int m)
{
	for (int i = 0; i < m; i++) {
		struct evidence_region best = more[i];
		for (int k = n - 1; k >= 0; k--) {
			const struct evidence_region was = out[k];
			const double apart = hypot(was.x - best.x, was.y - best.y), ratio = was.radius / best.radius;
			if (apart > 0.8 * fmax(was.radius, best.radius))
				continue;
			const double less = fmin(was.score, best.score);
			best = was.score > best.score ? was : best;
			if (ratio > 0.75 && ratio < 1.33)
				best.score += 0.5 * less * (1 - best.score);
			for (int j = k; j + 1 < n; j++)
				out[j] = out[j + 1];
			n--;
		}
		n = insert(out, n, best);
	}
	return n;
}

bool evidence_find(struct evidence_region out[EVIDENCE_REGIONS], int *n, struct evidence_net *net, const struct photo *photo, struct err *err)
{
	const double sure = 0.5;
	const int longer = photo->width > photo->height ? photo->width : photo->height;
	*n = 0;
	for (int size = LONG_FIRST; size <= LONG_LAST; size *= 2) {
		// Enlarged pictures show nothing new; the first scale is looked at in any case.
		if (size > LONG_FIRST && (size >= 2 * longer || (size > LONG_SURE && *n > 0 && out[0].score > sure)))
			break;
		struct evidence e;
		if (!evidence_whole(&e, net, photo, size, err))
			return false;
		struct evidence_region found[EVIDENCE_REGIONS];
		const int m = evidence_regions(found, &e);
		evidence_free(&e);
		*n = merge(out, *n, found, m);
	}
	return true;
}
