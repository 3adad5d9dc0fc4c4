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
	if (photo->exif.adobe_rgb && !space->cicp.primaries && photo->kind != PHOTO_RAW && !photo->grey)
		return photo_adobe_apply(photo->profile, photo->rgb, n, err);
	return photo_cicp_apply(photo->profile, photo->rgb, n, &space->cicp, err);
}

/* Whether a photograph of three channels is grey all the same: hardly a pixel's channels differ by more than rounding leaves. */
static bool is_colourless(const struct photo *photo)
{
	const int rounding = 3 * 257;  // three 8-bit steps: a JPEG's chroma, a profile's white point
	long n = (long)photo->width * photo->height, coloured = 0;
#pragma omp parallel for schedule(static) reduction(+ : coloured)
	for (long i = 0; i < n; i++) {
		const uint16_t *p = photo->rgb + 3 * i;
		int least = p[0] < p[1] ? p[0] : p[1], most = p[0] > p[1] ? p[0] : p[1];
		least = p[2] < least ? p[2] : least;
		most = p[2] > most ? p[2] : most;
		coloured += most - least > rounding;
	}
	return coloured <= n / 1000;
}

/* Where what has to stand at pixel i of the upright picture, `width` px wide, stands in the one that was decoded, w x h px. EXIF 2.3, tag 274:
 * orientations 5 to 8 exchange the axes; each but 1 and 5 reverses one or both. */
static size_t from_of(size_t i, int orientation, size_t w, size_t h, size_t width)
{
	const int o = orientation;
	const size_t u = i % width, v = i / width, x = o >= 5 ? v : u, y = o >= 5 ? u : v;
	const bool flip_x = o == 2 || o == 3 || o == 7 || o == 8, flip_y = o == 3 || o == 4 || o == 6 || o == 7;
	return (flip_y ? h - 1 - y : y) * w + (flip_x ? w - 1 - x : x);
}

void photo_turn_in_place(uint16_t (*rgb)[3], int orientation, int w, int h)
{
	const size_t n = (size_t)w * (size_t)h, width = (size_t)(orientation >= 5 ? h : w);
	uint8_t *done = mem_new(n / 8 + 1, 1);
	// A pixel's place is taken by another's, whose place is taken by a third's, until that of the first is reached.
	for (size_t first = 0; first < n; first++) {
		uint16_t kept[3];
		size_t at = first, from;
		if (done[first / 8] >> first % 8 & 1)
			continue;
		memcpy(kept, rgb[first], sizeof kept);
		for (; (from = from_of(at, orientation, (size_t)w, (size_t)h, width)) != first; at = from) {
			done[at / 8] |= (uint8_t)(1 << at % 8);
			memcpy(rgb[at], rgb[from], sizeof kept);
		}
		done[at / 8] |= (uint8_t)(1 << at % 8);
		memcpy(rgb[at], kept, sizeof kept);
	}
	free(done);
}

static void turn_upright(struct photo *photo)
{
	// Larger pictures are turned where they stand, which takes thrice as long: a copy of them would be the most that a stage needs.
	enum { COPIED_MOST = 40 * 1000 * 1000 };
	const int o = photo->exif.orientation, w = photo->width, h = photo->height;
	const size_t n = (size_t)w * (size_t)h, width = (size_t)(o >= 5 ? h : w);
	if (o == 1)
		return;
	if (n > COPIED_MOST)
		photo_turn_in_place((uint16_t (*)[3])photo->rgb, o, w, h);
	else {
		uint16_t *out = mem_array(n * 3, sizeof *out);
		for (size_t i = 0; i < n; i++)
			memcpy(out + 3 * i, photo->rgb + 3 * from_of(i, o, (size_t)w, (size_t)h, width), 3 * sizeof *out);
		free(photo->rgb);
		photo->rgb = out;
	}
	photo->width = o >= 5 ? h : w;
	photo->height = o >= 5 ? w : h;
}

bool photo_load(struct photo *photo, const char *path, double limit_mpx, struct err *err)
{
	return photo_load_small(photo, path, 0, limit_mpx, err);
}

bool photo_load_small(struct photo *photo, const char *path, int side, double limit_mpx, struct err *err)
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
		if (side > 0 && photo->kind == PHOTO_JPEG)
			photo_reduce_jpeg(photo, side);
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
	photo->grey = photo->grey || is_colourless(photo);
	turn_upright(photo);
	return true;
}

/* Linear value of each code value, an 8-bit one being its 16-bit one over 257, which is the upper byte: [65536 >> *shift]; free(). */
static float *linear_table(int *shift, const struct photo *photo)
{
	*shift = photo->bits == 8 ? 8 : 0;
	const int steps = 65535 >> *shift;
	float *linear = mem_array((size_t)steps + 1, sizeof *linear);
	for (int i = 0; i <= steps; i++)
		linear[i] = linear_from_srgb((float)i / (float)steps);
	return linear;
}

/* Adds a line's pixels, times weight, to the sums of the pixels that they fall into. */
static void add_line(double *sum, int out_width, const uint16_t *line, int width, const float *linear, int shift, double weight)
{
	const double scale = (double)out_width / width;
	for (int x = 0; x < width; x++) {
		const double a = x * scale, b = (x + 1) * scale;
		const int i = (int)a, j = i + 1 < out_width ? i + 1 : i;
		const double inside = b <= i + 1 ? b - a : i + 1 - a;  // share of it in the first pixel; the rest falls into the second
		for (int c = 0; c < 3; c++) {
			const double v = weight * linear[line[3 * x + c] >> shift];
			sum[3 * i + c] += v * inside;
			sum[3 * j + c] += v * (b - a - inside);
		}
	}
}

struct image photo_shrunk(const struct photo *photo, int x0, int y0, int width, int height, int out_width, int out_height)
{
	struct image out = image_new(out_width, out_height, 3);
	const double scale = (double)out_height / height;
	int shift;
	float *linear = linear_table(&shift, photo);
#pragma omp parallel
	{
		double *sum = mem_array(3 * (size_t)out_width, sizeof *sum);
#pragma omp for schedule(static)
		for (int row = 0; row < out_height; row++) {
			memset(sum, 0, 3 * (size_t)out_width * sizeof *sum);
			for (int y = (int)(row / scale); y < height && y * scale < row + 1; y++) {
				const double from = y * scale > row ? y * scale : row, to = (y + 1) * scale < row + 1 ? (y + 1) * scale : row + 1;
				if (to > from)
					add_line(sum, out_width, photo->rgb + 3 * ((long)(y0 + y) * photo->width + x0), width, linear, shift, to - from);
			}
			for (int i = 0; i < 3 * out_width; i++)
				out.px[3 * (long)row * out_width + i] = (float)sum[i];
		}
		free(sum);
	}
	free(linear);
	return out;
}

struct image photo_linear(const struct photo *photo, int x0, int y0, int width, int height)
{
	struct image out = { width, height, 3, mem_array((size_t)width * (size_t)height * 3, sizeof(float)) };
	int shift;
	float *linear = linear_table(&shift, photo);
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

struct photo photo_of_bytes(const uint8_t *rgb, int width, int height)
{
	const size_t values = 3 * (size_t)width * (size_t)height;
	struct photo photo = { .width = width, .height = height, .bits = 8, .rgb = mem_array(values + 1, sizeof *photo.rgb) };
	for (size_t i = 0; i < values; i++)
		photo.rgb[i] = (uint16_t)(257 * rgb[i]);
	return photo;
}

void photo_free(struct photo *photo)
{
	free(photo->rgb);
	*photo = (struct photo){ 0 };
}
