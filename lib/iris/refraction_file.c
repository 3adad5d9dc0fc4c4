#include "iris/refraction_file.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "image/exr.h"

enum { FORMAT = 2, CONSTANTS = 17, NARROWEST = 32, LIMIT_PX = 1 << 24 };
static const char *const xyz[] = { "X", "Y", "Z" };

static int columns(const struct refraction *f)
{
	int table = f->thetas * f->phis;
	return table > NARROWEST ? table : NARROWEST;
}

bool refraction_save(const struct refraction *f, const char *path, const char *made_by, struct err *err)
{
	const struct cornea *c = &f->cornea;
	const double constants[CONSTANTS] = { FORMAT,   f->method,   f->steps,    f->degree, f->points,   f->thetas,
		                              f->phis,  c->R,        c->p,        c->n,      c->rim,      f->depth,
		                              f->radius, f->error_mm, f->worst_mm, f->mean_mm, f->n_data };
	int width = columns(f);
	struct image image = image_new(width, 1 + (f->n_data + width - 1) / width, 3);
	for (int i = 0; i < CONSTANTS; i++)
		image.px[3 * i] = constants[i];
	if (f->n_data)
		memcpy(image_at(&image, 0, 1), f->data, f->n_data * sizeof *f->data);
	bool ok = exr_write(path, &image, xyz, EXR_FLOAT, &(struct exr_info){ .made_by = made_by }, err);
	image_free(&image);
	return ok;
}

/* A whole number of a constant, in its range. */
static bool whole(int *out, double value, int low, int high)
{
	*out = value >= low && value <= high ? (int)value : 0;
	return *out == value;
}

static bool constants(struct refraction *f, const float *px)
{
	double v[CONSTANTS];
	int format;
	for (int i = 0; i < CONSTANTS; i++)
		v[i] = px[3 * i];
	f->cornea = (struct cornea){ .R = v[7], .p = v[8], .n = v[9], .rim = v[10] };
	f->depth = v[11];
	f->radius = v[12];
	f->error_mm = v[13];
	f->worst_mm = v[14];
	f->mean_mm = v[15];
	bool ok = whole(&format, v[0], FORMAT, FORMAT) && whole(&f->method, v[1], REFRACTION_NEWTON, REFRACTION_METHODS - 1)
	          && whole(&f->steps, v[2], 0, 100) && whole(&f->degree, v[3], 0, REFRACTION_MAX_DEGREE)
	          && whole(&f->points, v[4], 0, 10000) && whole(&f->thetas, v[5], 0, 1000) && whole(&f->phis, v[6], 0, 1000);
	ok = ok && v[7] > 0 && v[8] >= 0 && v[9] >= 1 && v[10] > 0 && v[11] > 0 && v[12] > 0 && v[13] >= 0;
	bool table = f->method == REFRACTION_TABLE_LINEAR || f->method == REFRACTION_TABLE_NEAREST;
	if (table) {
		ok = ok && f->points > 1 && f->thetas > 1 && f->phis > 1;
		f->n_data = (long)f->points * f->thetas * f->phis;
	} else {
		f->thetas = f->phis = 0;
		f->n_data = f->degree ? (f->degree + 1) * (f->degree + 2) * (f->degree + 3) / 6 : 0;
		ok = ok && (f->degree > 0) == (f->method == REFRACTION_POLYNOMIAL);
	}
	return ok && f->n_data == v[16] && isfinite(f->cornea.R + f->cornea.p + f->cornea.n + f->cornea.rim + f->depth);
}

bool refraction_load(struct refraction *f, const char *path, struct err *err)
{
	struct image image;
	*f = (struct refraction){ 0 };
	if (!exr_read(&image, path, 3, xyz, LIMIT_PX, 0, err))
		return false;
	bool ok = image.width >= CONSTANTS && constants(f, image.px) && image.width == columns(f)
	          && (long)(image.height - 1) * image.width >= f->n_data;
	if (ok && f->n_data) {
		f->data = mem_new(f->n_data, sizeof *f->data);
		memcpy(f->data, image_at(&image, 0, 1), f->n_data * sizeof *f->data);
	}
	image_free(&image);
	if (!ok)
		*f = (struct refraction){ 0 };
	return ok || err_set(err, "%s: holds no refraction function; run the stage refraction again", path);
}
