#include "limbus/candidates.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/mask.h"
#include "image/plane.h"

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

static int insert(struct evidence_region out[CANDIDATES_MAX], int n, struct evidence_region r)
{
	int at = n < CANDIDATES_MAX ? n++ : CANDIDATES_MAX;
	while (at > 0 && r.score > out[at - 1].score) {
		if (at < CANDIDATES_MAX)
			out[at] = out[at - 1];
		at--;
	}
	if (at < CANDIDATES_MAX)
		out[at] = r;
	return n;
}

int candidates_of(struct evidence_region out[CANDIDATES_MAX], const struct evidence *e)
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

/* Sums over all above and to the left: [height + 1][width + 1]. */
static double *integral_of(const struct evidence *e)
{
	const int w = e->width + 1;
	double *sum = mem_new((size_t)w * (size_t)(e->height + 1), sizeof *sum);
	for (int y = 0; y < e->height; y++) {
		double row = 0;
		for (int x = 0; x < e->width; x++) {
			const long i = (long)y * e->width + x;
			row += e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_PUPIL][i];
			sum[(y + 1) * w + x + 1] = sum[y * w + x + 1] + row;
		}
	}
	return sum;
}

/* Mean over the square of so many px to each side of pixel (x, y), clipped. */
static double mean_round(const double *sum, const struct evidence *e, int x, int y, int side)
{
	const int w = e->width + 1, x0 = x > side ? x - side : 0, x1 = x + side < e->width ? x + side + 1 : e->width;
	const int y0 = y > side ? y - side : 0, y1 = y + side < e->height ? y + side + 1 : e->height;
	return (sum[y1 * w + x1] - sum[y0 * w + x1] - sum[y1 * w + x0] + sum[y0 * w + x0]) / ((double)(x1 - x0) * (y1 - y0));
}

int candidates_spots(struct evidence_region out[CANDIDATES_MAX], const struct evidence *e)
{
	static const int inner[] = { 1, 2, 3 };
	const double least = 0.15;
	double *sum = integral_of(e);
	float *response = mem_array((size_t)e->width * (size_t)e->height, sizeof *response);
	int n = 0;
	for (int k = 0; k < COUNT(inner); k++) {
		const int r = inner[k], outer = 3 * r;
		for (int y = 0; y < e->height; y++)
			for (int x = 0; x < e->width; x++)
				response[y * e->width + x] = (float)(mean_round(sum, e, x, y, r) - mean_round(sum, e, x, y, outer));
		for (int y = 1; y + 1 < e->height; y++)
			for (int x = 1; x + 1 < e->width; x++) {
				const float *p = &response[y * e->width + x];
				bool most = *p > least;
				for (int j = -1; most && j <= 1; j++)
					for (int i = -1; i <= 1; i++)
						most = most && (*p >= p[j * e->width + i]);
				if (!most)
					continue;
				const struct evidence_region spot = { e->x0 + (x + 0.5) * e->scale, e->y0 + (y + 0.5) * e->scale, (r + 0.5) * e->scale, *p };
				n = candidates_merge(out, n, &spot, 1);
			}
	}
	free(response);
	free(sum);
	return n;
}

int candidates_merge(struct evidence_region out[CANDIDATES_MAX], int n, const struct evidence_region *more, int m)
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
