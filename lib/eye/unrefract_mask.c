#include "eye/unrefract_mask.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"

enum { OUTSIDE, IRIS, LID, GLINT, LASH };

static const float darkest = 2e-4f;  // of full scale; below it the logarithm is noise

struct work {
	int size;
	double texel;      // mm
	float *log[3];     // of the colour, blurred a little
	float *t;          // sheet coordinate
	uint8_t *kind;
};

static double plane_mm(int i, const struct unrefract_survey *survey)
{
	return (i + 0.5) * 2 * survey->extent / survey->size - survey->extent;
}

/* log of each channel, blurred over `sigma` texels among what is seen. */
static void take_logs(struct work *work, const struct unrefract_survey *survey, const float *seen, double sigma)
{
	long n = (long)work->size * work->size;
	for (int c = 0; c < 3; c++) {
		for (long i = 0; i < n; i++)
			work->log[c][i] = survey->rgb[3 * i + c];
		plane_blur_weighted(work->log[c], seen, work->size, work->size, sigma, 0);
		for (long i = 0; i < n; i++)
			work->log[c][i] = logf(fmaxf(work->log[c][i], darkest));
	}
}

static void mark_lids(struct work *work, const struct unrefract_survey *survey, const float *seen,
                      const struct sheet *sheet, const struct unrefract_conf *conf)
{
	double lid_t[SHEET_ANGLES];
	take_logs(work, survey, seen, 0.06 / work->texel);
	unrefract_lids(lid_t, (const float *const *)work->log, seen, sheet, conf);
	for (int y = 0; y < work->size; y++)
		for (int x = 0; x < work->size; x++) {
			double phi = atan2(plane_mm(y, survey) - sheet->pupil.cy, plane_mm(x, survey) - sheet->pupil.cx);
			int a = (int)((phi < 0 ? phi + 2 * M_PI : phi) * SHEET_ANGLES / (2 * M_PI)) % SHEET_ANGLES;
			long i = (long)y * work->size + x;
			if (work->kind[i] == IRIS && work->t[i] > lid_t[a])
				work->kind[i] = LID;
		}
}

/* The channel in which the iris is darkest: an added reflection shows there most. */
static int darkest_channel(const struct work *work, const float *weight, const struct sheet *sheet)
{
	int best = 0;
	float low = INFINITY;
	for (int c = 0; c < 3; c++) {
		struct rings rings = rings_of(work->log[c], weight, sheet, false, 0.1f);
		if (rings.median[SHEET_RINGS / 2] < low) {
			low = rings.median[SHEET_RINGS / 2];
			best = c;
		}
	}
	return best;
}

static void iris_weight(float *weight, const struct work *work, const float *seen)
{
	for (long i = 0; i < (long)work->size * work->size; i++)
		weight[i] = work->kind[i] == IRIS ? seen[i] : 0;
}

/* Reflections: too bright, over an area, in the iris' own darkest channel; or saturated. */
static void mark_glints(struct work *work, const struct unrefract_survey *survey, const float *seen,
                        const struct sheet *sheet, const struct unrefract_conf *conf)
{
	long n = (long)work->size * work->size;
	float *weight = mem_array((size_t)n, sizeof *weight);
	uint8_t *glint = mem_new((size_t)n, 1);
	iris_weight(weight, work, seen);
	take_logs(work, survey, seen, 0.07 / work->texel);
	int c = darkest_channel(work, weight, sheet);
	struct rings rings = rings_of(work->log[c], weight, sheet, false, 0.12f);
	for (long i = 0; i < n; i++) {
		const float *rgb = survey->rgb + 3 * i;
		bool full = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2])) > (float)conf->saturated;
		bool added = !conf->polarised && rings_z(&rings, work->log[c][i], work->t[i]) > (float)conf->glint_z;
		glint[i] = seen[i] > 0 && work->t[i] > -0.05f && work->t[i] < 0.97f && (full || added);
	}
	mask_grow(glint, work->size, work->size, conf->glint_grow / work->texel);
	for (long i = 0; i < n; i++)
		if (glint[i] && work->kind[i] == IRIS)
			work->kind[i] = GLINT;
	free(glint);
	free(weight);
}

/* Lashes: thin, darker than any crypt of the ring, and hanging on a lid or on the rim of the iris. */
static void mark_lashes(struct work *work, const struct unrefract_survey *survey, const float *seen,
                        const struct unrefract_conf *conf)
{
	int size = work->size;
	long n = (long)size * size;
	float *fine = mem_array((size_t)n, sizeof *fine), *wide = mem_array((size_t)n, sizeof *wide);
	for (long i = 0; i < n; i++) {
		const float *rgb = survey->rgb + 3 * i;
		fine[i] = wide[i] = logf(fmaxf(0.3f * rgb[0] + 0.6f * rgb[1] + 0.1f * rgb[2], darkest));
	}
	plane_blur_weighted(wide, seen, size, size, 2 * conf->lash_width / work->texel, 0);
	uint8_t *dark = mem_array((size_t)n, 1);
	int *label = mem_array((size_t)n, sizeof *label);
	for (long i = 0; i < n; i++)
		dark[i] = work->kind[i] == LID
		          || (work->kind[i] == IRIS && fine[i] < wide[i] - (float)conf->lash_contrast);
	int count = mask_label(label, dark, size, size);
	uint8_t *hangs = mem_new((size_t)count + 1, 1);
	for (long i = 0; i < n; i++)
		hangs[label[i]] |= work->kind[i] == LID;
	for (long i = 0; i < n; i++)
		if (label[i] && hangs[label[i]] && work->kind[i] == IRIS)
			work->kind[i] = LASH;
	free(hangs);
	free(label);
	free(dark);
	free(wide);
	free(fine);
}

/* Grown, so that nothing of a mask's own blur is left; then feathered inwards. */
static void weigh(struct unrefract_survey *survey, const struct work *work, const float *seen)
{
	int size = work->size;
	long n = (long)size * size, lid = 0, glint = 0, all = 0;
	uint8_t *bad = mem_array((size_t)n, 1);
	for (long i = 0; i < n; i++) {
		lid += work->kind[i] == LID || work->kind[i] == LASH;
		glint += work->kind[i] == GLINT;
		all += work->kind[i] != OUTSIDE;
		bad[i] = work->kind[i] > IRIS;
	}
	double feather = fmax(1, 0.04 / work->texel);
	mask_grow(bad, size, size, 2.5 * feather);
	for (long i = 0; i < n; i++)
		survey->weight[i] = bad[i] ? 0 : 1;
	plane_blur(survey->weight, size, size, feather);
	for (long i = 0; i < n; i++)
		survey->weight[i] *= seen[i];
	survey->lid_share = all ? (double)lid / (double)all : 0;
	survey->glint_share = all ? (double)glint / (double)all : 0;
	free(bad);
}

void unrefract_mask(struct unrefract_survey *survey, const float *seen, const struct sheet *sheet, double coverage,
                    const struct unrefract_conf *conf)
{
	const double open_limbus = 0.985;  // the fit saw all of the limbus: there is no lid to look for
	int size = survey->size;
	size_t n = (size_t)size * (size_t)size;
	struct work work = { .size = size, .texel = 2 * survey->extent / size };
	for (int c = 0; c < 3; c++)
		work.log[c] = mem_array(n, sizeof(float));
	work.t = mem_array(n, sizeof(float));
	work.kind = mem_array(n, 1);
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			long i = (long)y * size + x;
			work.t[i] = (float)sheet_t(sheet, plane_mm(x, survey), plane_mm(y, survey));
			work.kind[i] = seen[i] > 0 && work.t[i] > 0 && work.t[i] < 1 ? IRIS : OUTSIDE;
		}
	if (coverage < open_limbus)
		mark_lids(&work, survey, seen, sheet, conf);
	if (coverage < open_limbus)
		mark_lashes(&work, survey, seen, conf);
	mark_glints(&work, survey, seen, sheet, conf);
	weigh(survey, &work, seen);
	for (int c = 0; c < 3; c++)
		free(work.log[c]);
	free(work.t);
	free(work.kind);
}
