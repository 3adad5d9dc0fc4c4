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

static bool save(const char *path, const struct picture_out *out, const char *made_by, struct err *err)
{
	static const char *const names[] = { "R", "G", "B", "A" };
	struct exr_info info = { .made_by = made_by };
	return out->image->channels == 4 ? exr_write(path, out->image, names, EXR_HALF, &info, err)
	                                 : picture_png_write_linear(path, out->image, err);
}

bool pictures_save(struct job *job, int n, const struct picture_out out[], int n_in, const char *const in[], struct err *err)
{
	const char *made_by = stage_made_by(job->stage, n_in, in), *path[PICTURES_MAX];
	struct err late[PICTURES_MAX] = { 0 };
	for (int i = 0; i < n; i++)
		path[i] = stage_path(job->stage, "%s", out[i].rel);
#pragma omp parallel for schedule(dynamic)  // compression takes as long as tracing
	for (int i = 0; i < n; i++)
		save(path[i], &out[i], made_by, &late[i]);
	for (int i = 0; i < n; i++) {
		if (err_is(&late[i])) {
			*err = late[i];
			return false;
		}
		if (!stage_made(job->stage, out[i].rel, n_in, in, err))
			return false;
	}
	return true;
}
