#include <math.h>
#include <stdlib.h>

#include "image/exr.h"
#include "image/picture.h"
#include "render/render.h"

struct image picture_on_grey(const struct image *rgba, double gain)
{
	// A photographer's grey, falling off towards the corners.
	static const float middle = 0.115f, corner = 0.030f;
	struct image out = image_new(rgba->width, rgba->height, 3);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++) {
			float u = 2 * ((float)x + 0.5f) / (float)out.width - 1, v = 2 * ((float)y + 0.5f) / (float)out.height - 1;
			float t = fminf((u * u + v * v) / 2, 1), grey = middle + t * (corner - middle);
			const float *p = image_at(rgba, x, y);
			for (int c = 0; c < 3; c++)
				image_at(&out, x, y)[c] = p[c] * (float)gain + (1 - p[3]) * grey;
		}
	return out;
}

bool picture_save(struct job *job, const char *rel, const struct image *image, int n_in, const char *const in[],
                  struct err *err)
{
	return picture_png_write_linear(stage_path(job->stage, "%s", rel), image, err)
	       && stage_made(job->stage, rel, n_in, in, err);
}

bool picture_save_exr(struct job *job, const char *rel, const struct image *rgba, int n_in, const char *const in[],
                      struct err *err)
{
	static const char *const names[] = { "R", "G", "B", "A" };
	struct exr_info info = { .made_by = stage_made_by(job->stage, n_in, in) };
	return exr_write(stage_path(job->stage, "%s", rel), rgba, names, EXR_HALF, &info, err)
	       && stage_made(job->stage, rel, n_in, in, err);
}
