#include "iris/unrefract/mask.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/mask.h"
#include "image/plane.h"
#include "iris/unrefract/lids.h"
#include "iris/unrefract/shade.h"

enum { OUTSIDE, IRIS, LID, GLINT, LASH };

static const float darkest = 2e-4f;  // of full scale; below it the logarithm is noise

struct work {
	int size;
	double texel;      // mm
	float *log[3];     // of the colour, blurred a little
	float white[3];    // logarithm of white
	float *t;          // sheet coordinate
	uint8_t *kind;
};

static double plane_mm(int i, const struct unrefract_survey *survey)
{
	return (i + 0.5) * 2 * survey->extent / survey->size - survey->extent;
}

/* Logarithm of each channel against white, blurred over `sigma` texels among what is seen. */
static void take_logs(struct work *work, const struct unrefract_survey *survey, const float *seen, double sigma)
{
	long n = (long)work->size * work->size;
	for (int c = 0; c < 3; c++) {
#pragma omp parallel for schedule(static)
		for (long i = 0; i < n; i++)
			work->log[c][i] = survey->rgb[3 * i + c];
		plane_blur_weighted(work->log[c], seen, work->size, work->size, sigma, 0);
#pragma omp parallel for schedule(static)
		for (long i = 0; i < n; i++)
			work->log[c][i] = logf(fmaxf(work->log[c][i], darkest)) - work->white[c];
	}
}

/* The lid's edge at an angle, interpolated between the two nearest angles. */
static double lid_at(const double lid_t[SHEET_ANGLES], double phi)
{
	double at = (phi < 0 ? phi + 2 * M_PI : phi) * SHEET_ANGLES / (2 * M_PI) - 0.5 + SHEET_ANGLES;
	int a = (int)at;
	double f = at - a;
	return (1 - f) * lid_t[a % SHEET_ANGLES] + f * lid_t[(a + 1) % SHEET_ANGLES];
}

static void mark_lids(struct work *work, double lid_t[SHEET_ANGLES], const struct unrefract_survey *survey, const float *seen, const struct told *told,
                      const struct sheet *sheet, const struct unrefract_conf *conf)
{
	take_logs(work, survey, seen, 0.06 / work->texel);
	float *iris = told_iris(told, seen, (size_t)work->size * (size_t)work->size);
	unrefract_lids(lid_t, (const float *const *)work->log, seen, iris, told->lid, sheet, conf);
	free(iris);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < work->size; y++)
		for (int x = 0; x < work->size; x++) {
			long i = (long)y * work->size + x;
			if (work->kind[i] != IRIS)
				continue;
			double phi = atan2(plane_mm(y, survey) - sheet->pupil.cy, plane_mm(x, survey) - sheet->pupil.cx);
			if (work->t[i] > lid_at(lid_t, phi))
				work->kind[i] = LID;
		}
}

/* The channel in which the iris is darkest, against white: an added reflection changes it most. */
static int darkest_channel(const struct rings rings[3])
{
	int best = 0, middle = SHEET_RINGS / 2;
	for (int c = 1; c < 3; c++)
		best = rings[c].median[middle] < rings[best].median[middle] ? c : best;
	return best;
}

static void iris_weight(float *weight, const struct work *work, const float *seen)
{
	for (long i = 0; i < (long)work->size * work->size; i++)
		weight[i] = work->kind[i] == IRIS ? seen[i] : 0;
}

/* A reflection adds the colour of the light, which is white in these logarithms: the ratio of the iris' weakest colour to its strongest rises, the more the further apart they
 * are. A pale fibre scales all channels alike; a yellow fleck keeps its hue. */
static bool turns_white(const float log_rgb[3], const struct rings rings[3], int weak, double t)
{
	const float least = 0.25f;  // of the way to white, in logarithms
	int strong = 0;
	for (int c = 1; c < 3; c++)
		strong = rings_median(&rings[c], t) > rings_median(&rings[strong], t) ? c : strong;
	float iris = rings_median(&rings[strong], t) - rings_median(&rings[weak], t);
	return log_rgb[strong] - log_rgb[weak] < (1 - least) * iris;
}

/* Keeps bright fibres: blobs narrower than a reflection's blur stay, unless they are far brighter than their ring. */
static void drop_small(uint8_t *glint, const float *z, const struct work *work, const struct unrefract_conf *conf)
{
	long n = (long)work->size * work->size;
	int *label = mem_array((size_t)n, sizeof *label);
	int count = mask_label(label, glint, work->size, work->size);
	long *area = mem_new((size_t)count + 1, sizeof *area);
	float *peak = mem_new((size_t)count + 1, sizeof *peak);
	for (long i = 0; i < n; i++) {
		area[label[i]]++;
		peak[label[i]] = fmaxf(peak[label[i]], z[i]);
	}
	double least = 0.12 / (work->texel * work->texel);  // mm²
	for (long i = 0; i < n; i++)
		if (glint[i] && (double)area[label[i]] < least && peak[label[i]] < 1.7f * (float)conf->glint_z)
			glint[i] = 0;
	free(peak);
	free(area);
	free(label);
}

/* Goes on from what is surely a reflection to what hangs together with it, is brighter than its ring, and to the network may be one: a window is plain in
 * one place and faint in another. */
static void spread(uint8_t *glint, const float *z, const struct told *told, const struct work *work, const float *seen)
{
	const float may = 0.4f;                   // chance
	const double far = 1.5 / work->texel;     // mm
	const long n = (long)work->size * work->size;
	if (!told->mirror)
		return;
	uint8_t *all = mem_array((size_t)n, 1);
	memcpy(all, glint, (size_t)n);
	mask_grow(all, work->size, work->size, far);
	for (long i = 0; i < n; i++)
		all[i] = glint[i] || (all[i] && seen[i] > 0 && work->kind[i] == IRIS && work->t[i] < 0.9f && told->mirror[i] > may && z[i] > 0);
	mask_keep(all, glint, work->size, work->size);
	memcpy(glint, all, (size_t)n);
	free(all);
}

/* Reflections: blobs too bright in the channel in which the iris is darkest, or saturated. */
static void mark_glints(struct work *work, const struct unrefract_survey *survey, const float *seen, const struct told *told,
                        const struct sheet *sheet, const struct unrefract_conf *conf)
{
	long n = (long)work->size * work->size;
	float *weight = mem_array((size_t)n, sizeof *weight), *z = mem_array((size_t)n, sizeof *z);
	uint8_t *glint = mem_new((size_t)n, 1);
	const float told_p = 0.5f;  // chance: what the network takes for a reflection is only to be brighter than its ring
	iris_weight(weight, work, seen);
	for (long i = 0; i < n && told->mirror; i++)
		weight[i] *= 1 - told->mirror[i];
	take_logs(work, survey, seen, 0.05 / work->texel);
	struct rings rings[3];
	for (int k = 0; k < 3; k++)
		rings[k] = rings_of(work->log[k], weight, sheet, false, 0.12f);
	int c = darkest_channel(rings);
	rings_even(&rings[c]);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		const float *rgb = survey->rgb + 3 * i;
		float mirror = told->mirror ? told->mirror[i] : 0;
		bool is_told = mirror > told_p;
		bool here = seen[i] > 0 && work->t[i] > -0.05f && (work->t[i] < 0.9f || is_told);  // beyond: the limbus' haze
		// a yellow fleck may saturate red; a light saturates nearly all
		bool full = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2])) > (float)conf->saturated
		            && fminf(rgb[0], fminf(rgb[1], rgb[2])) > 0.5f * (float)conf->saturated;
		z[i] = full ? INFINITY : conf->polarised ? 0 : rings_z(&rings[c], work->log[c][i], work->t[i]);
		float logs[3] = { work->log[0][i], work->log[1][i], work->log[2][i] };
		glint[i] = here && z[i] > (is_told ? 0 : (float)conf->glint_z)
		           && (full || is_told || turns_white(logs, rings, c, work->t[i]));
	}
	drop_small(glint, z, work, conf);
	spread(glint, z, told, work, seen);
	mask_grow(glint, work->size, work->size, conf->glint_grow / work->texel);
	for (long i = 0; i < n; i++)
		if (glint[i] && work->kind[i] == IRIS)
			work->kind[i] = GLINT;
	free(glint);
	free(z);
	free(weight);
}

/* Lashes: thin, darker than any crypt of the ring, and connected to a lid or to the rim of the iris. */
static void mark_lashes(struct work *work, const struct unrefract_survey *survey, const float *seen,
                        const struct unrefract_conf *conf)
{
	int size = work->size;
	long n = (long)size * size;
	float *fine = mem_array((size_t)n, sizeof *fine), *wide = mem_array((size_t)n, sizeof *wide);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		const float *rgb = survey->rgb + 3 * i;
		fine[i] = wide[i] = logf(fmaxf(0.3f * rgb[0] + 0.6f * rgb[1] + 0.1f * rgb[2], darkest));
	}
	plane_blur_weighted(wide, seen, size, size, 2 * conf->lash_width / work->texel, 0);
	uint8_t *dark = mem_array((size_t)n, 1), *lid = mem_array((size_t)n, 1);
	for (long i = 0; i < n; i++) {
		lid[i] = work->kind[i] == LID;
		dark[i] = lid[i] || (work->kind[i] == IRIS && fine[i] < wide[i] - (float)conf->lash_contrast);
	}
	mask_keep(dark, lid, size, size);
	for (long i = 0; i < n; i++)
		if (dark[i] && work->kind[i] == IRIS)
			work->kind[i] = LASH;
	free(lid);
	free(dark);
	free(wide);
	free(fine);
}

/* Dilates the mask beyond its own blur, then feathers it inwards. */
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
		survey->weight[i] = bad[i] || survey->weight[i] < 0.01f ? 0 : survey->weight[i] * seen[i];
	survey->lid_share = all ? (double)lid / (double)all : 0;
	survey->glint_share = all ? (double)glint / (double)all : 0;
	free(bad);
}

static bool any_lid(const double lid_t[SHEET_ANGLES])
{
	for (int a = 0; a < SHEET_ANGLES; a++)
		if (lid_t[a] < 1)
			return true;
	return false;
}

void unrefract_mask(struct unrefract_survey *survey, const float *seen, const struct told *told, const double white[3], const struct sheet *sheet,
                    const struct unrefract_conf *conf)
{
	int size = survey->size;
	size_t n = (size_t)size * (size_t)size;
	struct work work = { .size = size, .texel = 2 * survey->extent / size };
	double lid_t[SHEET_ANGLES];
	for (int c = 0; c < 3; c++) {
		work.log[c] = mem_array(n, sizeof(float));
		work.white[c] = logf((float)fmax(white[c] / white[1], darkest));
	}
	work.t = mem_array(n, sizeof(float));
	work.kind = mem_array(n, 1);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			long i = (long)y * size + x;
			work.t[i] = (float)sheet_t(sheet, plane_mm(x, survey), plane_mm(y, survey));
			work.kind[i] = seen[i] > 0 && work.t[i] > 0 && work.t[i] < 1 ? IRIS : OUTSIDE;
		}
	mark_lids(&work, lid_t, survey, seen, told, sheet, conf);
	mark_lashes(&work, survey, seen, conf);
	mark_glints(&work, survey, seen, told, sheet, conf);
	weigh(survey, &work, seen);
	if (conf->lid_shade > 0 && any_lid(lid_t)) {
		take_logs(&work, survey, survey->weight, 0.06 / work.texel);
		unrefract_shade(survey, (const float *const *)work.log, work.t, lid_t, survey->weight, sheet, conf);
	}
	for (int c = 0; c < 3; c++)
		free(work.log[c]);
	free(work.t);
	free(work.kind);
}
