#include "image/exr.h"
#include "image/picture.h"
#include "render/render.h"

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
