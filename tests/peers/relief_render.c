#include "tests/peers/relief_render.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "tissue/relief/model.h"

static void shade(struct image *out, const struct image *thickness, const struct relief_table *table)
{
	long n = (long)out->width * out->height;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		float f;
		int k = relief_place(table, logf(fmaxf(thickness->px[i * thickness->channels], 1e-4f)), &f);
		for (int c = 0; c < 3; c++)
			out->px[3 * i + c] = table->rgb[k][c] + f * (table->rgb[k + 1][c] - table->rgb[k][c]);
	}
}

bool relief_render(struct image *out, const struct image *thickness, double extent, const double white[3],
                   const double x[PIGMENT_N], const struct pigment_conf *pigment, const struct relief_conf *conf,
                   struct err *err)
{
	struct relief_table *table = mem_new(1, sizeof *table);
	struct tissue tissue = pigment_tissue(x, pigment);
	float kappa = (float)(conf->occlusion * relief_kappa(&tissue) / conf->reach);
	int n = thickness->width;
	float *one = mem_array((size_t)n * n, sizeof *one), *wide = mem_array((size_t)n * n, sizeof *wide);
	relief_table_make(table, conf->low, conf->high, white, x, pigment);
	*out = image_new(n, n, 3);
	shade(out, thickness, table);
	for (long i = 0; i < (long)n * n; i++)
		one[i] = thickness->px[i * thickness->channels];
	bool ok = cv_blur(wide, one, n, n, 1, conf->reach * n / (2 * extent), err);
	for (long i = 0; ok && i < (long)n * n; i++) {
		float f = expf(kappa * (one[i] - wide[i]));
		for (int c = 0; c < 3; c++)
			out->px[3 * i + c] *= f;
	}
	free(one);
	free(wide);
	free(table);
	if (!ok)
		image_free(out);
	return ok;
}
