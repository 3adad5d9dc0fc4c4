#include "tests/lib/variants/kind.h"

#include <lcms2.h>
#include <libheif/heif.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>
#include <webp/encode.h>
#include <zlib.h>

#include "base/err.h"
#include "base/file.h"
#include "base/mem.h"

const struct space space_p3 = { { { 0.680, 0.320 }, { 0.265, 0.690 }, { 0.150, 0.060 } }, 0 };
const struct space space_adobe = { { { 0.64, 0.33 }, { 0.21, 0.71 }, { 0.15, 0.06 } }, 2.19921875 };
const struct space space_srgb = { { { 0.64, 0.33 }, { 0.30, 0.60 }, { 0.15, 0.06 } }, 0 };

static const double white[2] = { 0.3127, 0.3290 };

static struct blob bytes_of(cmsHPROFILE profile)
{
	cmsUInt32Number n = 0;
	cmsSaveProfileToMem(profile, 0, &n);
	struct blob b = { mem_array(n, 1), n };
	cmsSaveProfileToMem(profile, b.data, &n);
	cmsCloseProfile(profile);
	return b;
}

struct blob icc_of(const struct space *space)
{
	const double curve[] = { 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045 };
	cmsToneCurve *tone = space->gamma > 0 ? cmsBuildGamma(0, space->gamma) : cmsBuildParametricToneCurve(0, 4, curve);
	cmsToneCurve *tones[3] = { tone, tone, tone };
	const cmsCIExyY d65 = { white[0], white[1], 1 };
	cmsCIExyYTRIPLE p = { { space->primary[0][0], space->primary[0][1], 1 }, { space->primary[1][0], space->primary[1][1], 1 },
		              { space->primary[2][0], space->primary[2][1], 1 } };
	struct blob b = bytes_of(cmsCreateRGBProfile(&d65, &p, tones));
	cmsFreeToneCurve(tone);
	return b;
}

struct blob icc_grey(double gamma)
{
	cmsToneCurve *tone = cmsBuildGamma(0, gamma);
	const cmsCIExyY d65 = { white[0], white[1], 1 };
	struct blob b = bytes_of(cmsCreateGrayProfile(&d65, tone));
	cmsFreeToneCurve(tone);
	return b;
}

struct blob icc_printer(void)
{
	cmsToneCurve *tone = cmsBuildGamma(0, 1), *tones[4] = { tone, tone, tone, tone };
	struct blob b = bytes_of(cmsCreateLinearizationDeviceLink(cmsSigCmykData, tones));
	cmsFreeToneCurve(tone);
	return b;
}

static double srgb_curve(double v)
{
	return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

/* x of M x = b, by Cramer's rule. */
static void solve3(double x[3], const double M[3][3], const double b[3])
{
	double det = 0, part[3] = { 0 };
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		det += M[0][k] * (M[1][i] * M[2][j] - M[1][j] * M[2][i]);
		double A[3][3];
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				A[r][c] = c == k ? b[r] : M[r][c];
		for (int c = 0; c < 3; c++)
			part[k] += A[0][c] * (A[1][(c + 1) % 3] * A[2][(c + 2) % 3] - A[1][(c + 2) % 3] * A[2][(c + 1) % 3]);
	}
	for (int k = 0; k < 3; k++)
		x[k] = part[k] / det;
}

/* XYZ of the primaries in columns, scaled so that they add up to the white point. */
static void matrix_of(double M[3][3], const struct space *space)
{
	double W[3] = { white[0] / white[1], 1, (1 - white[0] - white[1]) / white[1] }, s[3];
	for (int k = 0; k < 3; k++) {
		double x = space->primary[k][0], y = space->primary[k][1];
		M[0][k] = x / y;
		M[1][k] = 1;
		M[2][k] = (1 - x - y) / y;
	}
	solve3(s, M, W);
	for (int r = 0; r < 3; r++)
		for (int k = 0; k < 3; k++)
			M[r][k] *= s[k];
}

void space_to_srgb(double srgb[3], const struct space *space, const double rgb[3])
{
	double from[3][3], to[3][3], XYZ[3] = { 0 }, linear[3];
	matrix_of(from, space);
	matrix_of(to, &space_srgb);
	for (int k = 0; k < 3; k++) {
		double v = space->gamma > 0 ? pow(rgb[k], space->gamma) : rgb[k] <= 0.04045 ? rgb[k] / 12.92 : pow((rgb[k] + 0.055) / 1.055, 2.4);
		for (int r = 0; r < 3; r++)
			XYZ[r] += from[r][k] * v;
	}
	solve3(linear, to, XYZ);
	for (int c = 0; c < 3; c++)
		srgb[c] = srgb_curve(fmin(fmax(linear[c], 0), 1));
}

static void put(struct blob *b, const void *data, size_t n)
{
	b->data = mem_grow(b->data, b->size + n, 1);
	memcpy(b->data + b->size, data, n);
	b->size += n;
}

static void put_be(struct blob *b, uint32_t v, int n)
{
	for (int i = n - 1; i >= 0; i--)
		put(b, &(uint8_t){ (uint8_t)(v >> 8 * i) }, 1);
}

static void put_le(struct blob *b, uint32_t v, int n)
{
	for (int i = 0; i < n; i++)
		put(b, &(uint8_t){ (uint8_t)(v >> 8 * i) }, 1);
}

struct blob with_icc_jpeg(struct blob jpeg, struct blob icc, int parts)
{
	struct blob out = { 0 };
	put(&out, jpeg.data, 2);
	for (int i = 0; i < parts; i++) {
		size_t from = icc.size * (size_t)i / (size_t)parts, to = icc.size * (size_t)(i + 1) / (size_t)parts;
		put_be(&out, 0xffe2, 2);
		put_be(&out, (uint32_t)(2 + 14 + to - from), 2);
		put(&out, "ICC_PROFILE", 12);
		put_be(&out, (uint32_t)(i + 1), 1);
		put_be(&out, (uint32_t)parts, 1);
		put(&out, icc.data + from, to - from);
	}
	put(&out, jpeg.data + 2, jpeg.size - 2);
	free(jpeg.data);
	free(icc.data);
	return out;
}

struct blob with_icc_png(struct blob png, struct blob icc)
{
	struct blob out = { 0 }, chunk = { 0 };
	uLongf n = compressBound(icc.size);
	uint8_t *packed = mem_array(n, 1);
	compress(packed, &n, icc.data, icc.size);
	put(&chunk, "iCCP" "p\0\0", 7);  // its name, "p"; compression method 0
	put(&chunk, packed, n);
	put(&out, png.data, 33);         // signature and IHDR
	put_be(&out, (uint32_t)chunk.size - 4, 4);
	put(&out, chunk.data, chunk.size);
	put_be(&out, (uint32_t)crc32(0, chunk.data, (uInt)chunk.size), 4);
	put(&out, png.data + 33, png.size - 33);
	free(packed);
	free(chunk.data);
	free(png.data);
	free(icc.data);
	return out;
}

struct blob with_icc_webp(struct blob webp, struct blob icc, int width, int height)
{
	struct blob out = { 0 };
	put(&out, "RIFF\0\0\0\0WEBPVP8X\x0a\0\0\0\x20\0\0\0", 24);
	put_le(&out, (uint32_t)width - 1, 3);
	put_le(&out, (uint32_t)height - 1, 3);
	put(&out, "ICCP", 4);
	put_le(&out, (uint32_t)icc.size, 4);
	put(&out, icc.data, icc.size);
	if (icc.size & 1)
		put_le(&out, 0, 1);
	put(&out, webp.data + 12, webp.size - 12);
	for (int i = 0; i < 4; i++)
		out.data[4 + i] = (uint8_t)((out.size - 8) >> 8 * i);
	free(webp.data);
	free(icc.data);
	return out;
}

/* Upper bytes as RGB. */
static uint8_t *rgb8(const struct pixels *p)
{
	uint8_t *px = mem_array((size_t)p->width * (size_t)p->height * 3, 1);
	for (long i = 0; i < (long)p->width * p->height; i++)
		for (int c = 0; c < 3; c++)
			px[3 * i + c] = (uint8_t)(p->px[i * p->channels + (p->channels >= 3 ? c : 0)] >> 8);
	return px;
}

struct blob encode_webp(const struct pixels *p)
{
	struct blob out = { 0 };
	uint8_t *px = rgb8(p), *packed = 0;
	size_t n = WebPEncodeLosslessRGB(px, p->width, p->height, 3 * p->width, &packed);
	put(&out, packed, n);
	WebPFree(packed);
	free(px);
	return out;
}

static struct heif_error keep(struct heif_context *context, const void *data, size_t size, void *out)
{
	(void)context;
	put(out, data, size);
	return (struct heif_error){ .message = "" };
}

/* x265 loses some memory of its own at each picture; the sanitised test is not about that. */
extern void __lsan_disable(void) __attribute__((weak));
extern void __lsan_enable(void) __attribute__((weak));

struct blob encode_heif(const struct pixels *p, int bits, bool avif, struct blob icc, int primaries)
{
	struct blob out = { 0 };
	struct heif_context *context = heif_context_alloc();
	struct heif_encoder *encoder = 0;
	if (heif_context_get_encoder_for_format(context, avif ? heif_compression_AV1 : heif_compression_HEVC, &encoder).code) {
		heif_context_free(context);
		return out;
	}
	heif_encoder_set_lossy_quality(encoder, 100);
	// 4:2:0 stays: with 4:4:4 x265 writes beyond its own memory, and aom stops at an assertion.
	struct heif_image *image = 0;
	heif_image_create(p->width, p->height, heif_colorspace_RGB, bits > 8 ? heif_chroma_interleaved_RRGGBB_LE : heif_chroma_interleaved_RGB, &image);
	heif_image_add_plane(image, heif_channel_interleaved, p->width, p->height, bits);
	int stride;
	uint8_t *plane = heif_image_get_plane(image, heif_channel_interleaved, &stride);
	for (int y = 0; y < p->height; y++)
		for (int i = 0; i < 3 * p->width; i++) {
			unsigned v = p->px[((long)y * p->width + i / 3) * p->channels + i % 3] >> (16 - bits);
			uint8_t *to = plane + (long)y * stride;
			if (bits == 8) {
				to[i] = (uint8_t)v;
			} else {
				to[2 * i] = (uint8_t)v;
				to[2 * i + 1] = (uint8_t)(v >> 8);
			}
		}
	if (icc.size)
		heif_image_set_raw_color_profile(image, "prof", icc.data, icc.size);
	struct heif_encoding_options *options = heif_encoding_options_alloc();
	struct heif_color_profile_nclx *nclx = 0;
	if (primaries) {
		nclx = heif_nclx_color_profile_alloc();
		heif_nclx_color_profile_set_color_primaries(nclx, (uint16_t)primaries);
		heif_nclx_color_profile_set_transfer_characteristics(nclx, 13);
		nclx->full_range_flag = 1;
		heif_nclx_color_profile_set_matrix_coefficients(nclx, 6);
		heif_image_set_nclx_color_profile(image, nclx);
		options->output_nclx_profile = nclx;
		options->macOS_compatibility_workaround_no_nclx_profile = 0;
	}
	struct heif_image_handle *handle = 0;
	if (__lsan_disable)
		__lsan_disable();
	struct heif_error e = heif_context_encode_image(context, image, encoder, options, &handle);
	if (__lsan_enable)
		__lsan_enable();
	if (!e.code)
		heif_context_write(context, &(struct heif_writer){ .writer_api_version = 1, .write = keep }, &out);
	if (handle)
		heif_image_handle_release(handle);
	heif_encoding_options_free(options);
	if (nclx)
		heif_nclx_color_profile_free(nclx);
	heif_image_release(image);
	heif_encoder_release(encoder);
	heif_context_free(context);
	free(icc.data);
	return out;
}

struct blob encode_dng(int width, int height, const uint16_t level[4], int orientation)
{
	struct blob out = { 0 };
	struct err err = { 0 };
	char path[] = "/tmp/eyewright-dng-XXXXXX";
	int fd = mkstemp(path);
	TIFF *tif = TIFFFdOpen(fd, path, "w");
	// XYZ to camera, D65: the camera's channels are linear sRGB's, so that the grey of equal levels is neutral.
	const float matrix[9] = { 3.2404542f, -1.5371385f, -0.4985314f, -0.9692660f, 1.8760108f, 0.0415560f, 0.0556434f, -0.2040259f, 1.0572252f };
	const float neutral[3] = { 1, 1, 1 };
	const uint16_t repeat[2] = { 2, 2 };
	TIFFSetField(tif, TIFFTAG_SUBFILETYPE, 0);
	TIFFSetField(tif, TIFFTAG_IMAGEWIDTH, width);
	TIFFSetField(tif, TIFFTAG_IMAGELENGTH, height);
	TIFFSetField(tif, TIFFTAG_BITSPERSAMPLE, 16);
	TIFFSetField(tif, TIFFTAG_SAMPLESPERPIXEL, 1);
	TIFFSetField(tif, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_CFA);
	TIFFSetField(tif, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
	TIFFSetField(tif, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	TIFFSetField(tif, TIFFTAG_ORIENTATION, orientation);
	TIFFSetField(tif, TIFFTAG_ROWSPERSTRIP, height);
	TIFFSetField(tif, TIFFTAG_MAKE, "Eyewright");
	TIFFSetField(tif, TIFFTAG_MODEL, "Bayer");
	TIFFSetField(tif, TIFFTAG_UNIQUECAMERAMODEL, "Eyewright Bayer");
	TIFFSetField(tif, TIFFTAG_CFAREPEATPATTERNDIM, repeat);
	TIFFSetField(tif, TIFFTAG_CFAPATTERN, 4, "\0\1\1\2");
	TIFFSetField(tif, TIFFTAG_DNGVERSION, "\1\4\0\0");
	TIFFSetField(tif, TIFFTAG_DNGBACKWARDVERSION, "\1\0\0\0");
	TIFFSetField(tif, TIFFTAG_COLORMATRIX1, 9, matrix);
	TIFFSetField(tif, TIFFTAG_CALIBRATIONILLUMINANT1, 21);
	TIFFSetField(tif, TIFFTAG_ASSHOTNEUTRAL, 3, neutral);
	uint16_t *line = mem_array((size_t)width, 2);
	for (int y = 0; y < height; y++) {
		for (int x = 0; x < width; x++)
			line[x] = level[2 * (y & 1) + (x & 1)];
		TIFFWriteScanline(tif, line, (uint32_t)y, 0);
	}
	free(line);
	TIFFClose(tif);
	char *data;
	if (file_read(&data, &out.size, path, (size_t)1 << 28, &err))
		out.data = (uint8_t *)data;
	unlink(path);
	return out;
}
