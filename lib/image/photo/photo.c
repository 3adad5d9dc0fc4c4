#include "image/photo/photo.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/photo/heif.h"
#include "image/photo/impl.h"
#include "image/photo/raw.h"
#include "image/photo/webp.h"

/* Linear values are stored as 16-bit sRGB code values, like those of every other kind. */
static bool decode_exr(const struct photo *photo, uint16_t *rgb, const char *path, double limit_mpx, struct err *err)
{
	static const char *const colour[] = { "R", "G", "B" }, *const grey[] = { "Y" };
	struct image image = { 0 };
	int channels = photo->grey ? 1 : 3;
	if (!exr_read(&image, path, channels, photo->grey ? grey : colour, (long)(1e6 * limit_mpx), 0, err))
		return false;
	bool same = image.width == photo->width && image.height == photo->height;
	long n = (long)image.width * image.height;
	for (long i = 0; same && i < n; i++)
		for (int c = 0; c < 3; c++) {
			float v = image.px[i * channels + (channels == 3 ? c : 0)];
			rgb[3 * i + c] = (uint16_t)(65535 * srgb_from_linear(v > 0 ? v < 1 ? v : 1 : 0) + 0.5f);
		}
	image_free(&image);
	return same ? true : err_set(err, "%s: has a size that is not the one its header gives", path);
}

static bool decode(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, const char *path,
                   double limit_mpx, struct err *err)
{
	switch (photo->kind) {
	case PHOTO_JPEG:
		return photo_decode_jpeg(photo, rgb, space, file, err);
	case PHOTO_PNG:
		return photo_decode_png(photo, rgb, space, file, err);
	case PHOTO_TIFF:
		return photo_decode_tiff(photo, rgb, space, file, err);
	case PHOTO_EXR:
		return decode_exr(photo, rgb, path, limit_mpx, err);
	case PHOTO_HEIF:
		return photo_decode_heif(photo, rgb, space, file, err);
	case PHOTO_WEBP:
		return photo_decode_webp(photo, rgb, space, file, err);
	case PHOTO_RAW:
		return photo_decode_raw(photo, rgb, file, err);
	case PHOTO_NONE:
		break;
	}
	return err_set(err, "is no photograph");
}

/* To sRGB. */
static bool convert(struct photo *photo, const struct photo_space *space, struct err *err)
{
	size_t n = (size_t)photo->width * (size_t)photo->height;
	if (space->size)
		return photo_profile_apply(photo->profile, photo->rgb, n, photo->grey, space->icc, space->size, err);
	return photo_cicp_apply(photo->profile, photo->rgb, n, &space->cicp, err);
}

/* EXIF 2.3, tag 274: orientations 5 to 8 exchange the axes; each but 1 and 5 reverses one or both. */
static void turn_upright(struct photo *photo)
{
	int o = photo->exif.orientation, w = photo->width, h = photo->height;
	if (o == 1)
		return;
	bool swap = o >= 5;
	bool flip_x = o == 2 || o == 3 || o == 7 || o == 8, flip_y = o == 3 || o == 4 || o == 6 || o == 7;
	int width = swap ? h : w, height = swap ? w : h;
	uint16_t *out = mem_array((size_t)w * (size_t)h * 3, sizeof *out);
	for (int v = 0; v < height; v++)
		for (int u = 0; u < width; u++) {
			int x = swap ? v : u, y = swap ? u : v;
			const uint16_t *from = photo->rgb + 3 * ((long)(flip_y ? h - 1 - y : y) * w + (flip_x ? w - 1 - x : x));
			memcpy(out + 3 * ((long)v * width + u), from, 3 * sizeof *out);
		}
	free(photo->rgb);
	photo->rgb = out;
	photo->width = width;
	photo->height = height;
}

bool photo_load(struct photo *photo, const char *path, double limit_mpx, struct err *err)
{
	// An upper bound: pixels in 16 bits and four channels, and some metadata.
	size_t limit = (size_t)(8e6 * limit_mpx) + ((size_t)64 << 20), size;
	struct err why = { 0 };
	bool named = false;  // why names the file itself
	char *data;
	*photo = (struct photo){ 0 };
	if (!file_read(&data, &size, path, limit, err))
		return false;
	bool ok = photo_header(photo, data, size, limit_mpx, &why);
	if (ok) {
		photo->rgb = mem_array((size_t)photo->width * (size_t)photo->height * 3, sizeof *photo->rgb);
		named = photo->kind == PHOTO_EXR;
		struct photo_space space = { 0 };
		ok = decode(photo, photo->rgb, &space, (struct bytes){ (const uint8_t *)data, size }, path, limit_mpx, &why)
		     && convert(photo, &space, &why);
		free(space.icc);
	}
	free(data);
	if (!ok) {
		photo_free(photo);
		return named ? err_set(err, "%s", why.msg) : err_set(err, "%s: %s", path, why.msg);
	}
	turn_upright(photo);
	return true;
}

struct image photo_linear(const struct photo *photo, int x0, int y0, int width, int height)
{
	struct image out = { width, height, 3, mem_array((size_t)width * (size_t)height * 3, sizeof(float)) };
	// An 8-bit value is its 16-bit one over 257, which is the upper byte.
	int shift = photo->bits == 8 ? 8 : 0, steps = 65535 >> shift;
	float *linear = mem_array((size_t)steps + 1, sizeof *linear);
	for (int i = 0; i <= steps; i++)
		linear[i] = linear_from_srgb((float)i / (float)steps);
#pragma omp parallel for schedule(static) if ((long)width * height > 1 << 16)
	for (int y = 0; y < height; y++) {
		const uint16_t *from = photo->rgb + 3 * ((long)(y0 + y) * photo->width + x0);
		float *to = out.px + 3 * (long)y * width;
		for (int i = 0; i < 3 * width; i++)
			to[i] = linear[from[i] >> shift];
	}
	free(linear);
	return out;
}

void photo_free(struct photo *photo)
{
	free(photo->rgb);
	*photo = (struct photo){ 0 };
}
