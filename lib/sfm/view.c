#include "sfm/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/picture.h"

enum { SHARP_PX = 800, JPEG_QUALITY = 96 };

char *view_name(const struct view *view)
{
	const char *slash = strrchr(view->file, '/'), *file = slash ? slash + 1 : view->file, *dot = strrchr(file, '.');
	int n = dot && dot != file ? (int)(dot - file) : (int)strlen(file);
	return view->frame < 0 ? mem_printf("%.*s", n, file) : mem_printf("%.*s_%ld", n, file, view->frame);
}

bool view_is_named(const struct view *view, const char *name)
{
	char *own = view_name(view);
	bool same = !strcmp(own, name);
	free(own);
	return same;
}

static uint8_t *grey_at(const uint8_t *px, int w, int h, int channels, int new_w, int new_h)
{
	uint8_t *small = cv_resize8(px, w, h, channels, new_w, new_h), *grey = mem_array((size_t)new_w * (size_t)new_h, 1);
	for (long i = 0; i < (long)new_w * new_h; i++)
		grey[i] = channels == 1 ? small[i] : (uint8_t)((54 * small[3 * i] + 183 * small[3 * i + 1] + 19 * small[3 * i + 2]) >> 8);
	free(small);
	return grey;
}

double view_sharpness(const uint8_t *px, int w, int h, int channels)
{
	double f = fmin(1, (double)SHARP_PX / fmax(w, h)), sum = 0;
	int W = (int)fmax(3, lround(f * w)), H = (int)fmax(3, lround(f * h));
	uint8_t *g = grey_at(px, w, h, channels, W, H);
	for (int y = 1; y < H - 1; y++)
		for (int x = 1; x < W - 1; x++) {
			const uint8_t *p = g + (long)y * W + x;
			double laplacian = 4.0 * p[0] - p[-1] - p[1] - p[-W] - p[W];
			sum += laplacian * laplacian;
		}
	free(g);
	return sum / ((double)(W - 2) * (H - 2));
}

void view_thumb(uint8_t thumb[THUMB * THUMB], const uint8_t *px, int width, int height, int channels)
{
	uint8_t *grey = grey_at(px, width, height, channels, THUMB, THUMB);
	memcpy(thumb, grey, THUMB * THUMB);
	free(grey);
}

bool view_picture(struct view *view, const char *path, const uint8_t *px, int channels, int picture_px, struct err *err)
{
	double f = fmin(1, (double)picture_px / fmax(view->width, view->height));
	int w = (int)fmax(1, lround(f * view->width)), h = (int)fmax(1, lround(f * view->height));
	uint8_t *reduced = f < 1 ? cv_resize8(px, view->width, view->height, channels, w, h) : 0, *jpeg = 0;
	const uint8_t *small = reduced ? reduced : px;
	view->picture_width = w;
	view->picture_height = h;
	view->sharpness = view_sharpness(small, w, h, channels);
	view_thumb(view->thumb, small, w, h, channels);
	size_t size;
	bool ok = picture_jpeg_encode(&jpeg, &size, small, w, h, channels, JPEG_QUALITY, err) && file_write(path, jpeg, size, err);
	free(reduced);
	free(jpeg);
	return ok;
}

double view_difference(const uint8_t *thumb, const uint8_t *other)
{
	double sum = 0;
	for (int i = 0; i < THUMB * THUMB; i++)
		sum += abs(thumb[i] - other[i]);
	return sum / (THUMB * THUMB);
}

double view_focal_known(const struct view *view, const struct calibrate_options *o)
{
	// capture.conf's camera.* holds for the eye's photographs and the views alike; without it EXIF counts.
	double focal = camera_keys_focal(&o->camera, view->width, view->height);
	return isfinite(focal) ? focal : view->focal_px;
}
