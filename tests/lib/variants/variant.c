#include "tests/lib/variants/variant.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>
#include <turbojpeg.h>
#include <unistd.h>

#include "base/err.h"
#include "base/file.h"
#include "base/mem.h"

uint16_t pattern_value(int x, int y, int c)
{
	return (uint16_t)(((x * 5 + c * 60) & 255) * 257 ^ (y * 3 & 255));
}

struct pixels pattern(int width, int height, int channels)
{
	struct pixels p = { width, height, channels, mem_array((size_t)width * (size_t)height * (size_t)channels, 2) };
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int c = 0; c < channels; c++)
				p.px[((long)y * width + x) * channels + c] = pattern_value(x, y, c);
	return p;
}

void pixels_free(struct pixels *p)
{
	free(p->px);
	*p = (struct pixels){ 0 };
}

/* Samples of one line, 8 or 16 bits, `every` apart. */
static void line_of(const struct pixels *p, int y, int bits, int first, int every, uint8_t *out)
{
	long n = (long)p->width * p->channels;
	const uint16_t *px = p->px + y * n;
	for (long i = first, k = 0; i < n; i += every, k++)
		if (bits == 8)
			out[k] = (uint8_t)(px[i] >> 8);
		else
			memcpy(out + 2 * k, px + i, 2);
}

static void append(png_structp png, png_bytep data, size_t n)
{
	struct blob *b = png_get_io_ptr(png);
	b->data = mem_grow(b->data, b->size + n, 1);
	memcpy(b->data + b->size, data, n);
	b->size += n;
}

struct blob encode_png(const struct pixels *p, int bits)
{
	static const int type[] = { 0, PNG_COLOR_TYPE_GRAY, 0, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGBA };
	struct blob out = { 0 };
	uint8_t *line = mem_array((size_t)p->width * (size_t)p->channels, 2);
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, 0, 0, 0);
	png_infop info = png_create_info_struct(png);
	png_set_write_fn(png, &out, append, 0);
	png_set_IHDR(png, info, (png_uint_32)p->width, (png_uint_32)p->height, bits, type[p->channels],
	             PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_compression_level(png, 1);
	png_write_info(png, info);
	if (bits == 16)
		png_set_swap(png);
	for (int y = 0; y < p->height; y++) {
		line_of(p, y, bits, 0, 1, line);
		png_write_row(png, line);
	}
	png_write_end(png, info);
	png_destroy_write_struct(&png, &info);
	free(line);
	return out;
}

static void tiff_tags(TIFF *tif, const struct pixels *p, int bits, int how, int orientation)
{
	int photometric = how & AS_CMYK ? PHOTOMETRIC_SEPARATED : p->channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
	TIFFSetField(tif, TIFFTAG_IMAGEWIDTH, p->width);
	TIFFSetField(tif, TIFFTAG_IMAGELENGTH, p->height);
	TIFFSetField(tif, TIFFTAG_BITSPERSAMPLE, bits);
	TIFFSetField(tif, TIFFTAG_SAMPLESPERPIXEL, p->channels);
	TIFFSetField(tif, TIFFTAG_PHOTOMETRIC, photometric);
	TIFFSetField(tif, TIFFTAG_ORIENTATION, orientation);
	TIFFSetField(tif, TIFFTAG_COMPRESSION, how & AS_LZW ? COMPRESSION_LZW : COMPRESSION_NONE);
	TIFFSetField(tif, TIFFTAG_PLANARCONFIG, how & AS_PLANAR ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
	if (how & AS_FLOAT)
		TIFFSetField(tif, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
	if (p->channels == 4 && !(how & AS_CMYK)) {
		uint16_t extra = EXTRASAMPLE_UNSPECIFIED;
		TIFFSetField(tif, TIFFTAG_EXTRASAMPLES, 1, &extra);
	}
	if (how & AS_TILED) {
		TIFFSetField(tif, TIFFTAG_TILEWIDTH, 32);
		TIFFSetField(tif, TIFFTAG_TILELENGTH, 16);
	} else
		TIFFSetField(tif, TIFFTAG_ROWSPERSTRIP, 7);
}

static void write_tiles(TIFF *tif, const struct pixels *p, int bits, int how)
{
	enum { W = 32, H = 16 };
	int every = how & AS_PLANAR ? p->channels : 1, size = bits / 8;
	int samples = how & AS_PLANAR ? 1 : p->channels;
	uint8_t *line = mem_array((size_t)(p->width + W) * (size_t)p->channels, 2);
	uint8_t *tile = mem_new((size_t)W * H * (size_t)samples, (size_t)size);
	for (int plane = 0; plane < every; plane++)
		for (int y0 = 0; y0 < p->height; y0 += H)
			for (int x0 = 0; x0 < p->width; x0 += W) {
				for (int y = 0; y < H && y0 + y < p->height; y++) {
					line_of(p, y0 + y, bits, plane, every, line);
					int n = p->width - x0 < W ? p->width - x0 : W;
					memcpy(tile + (size_t)(y * W * samples * size), line + x0 * samples * size,
					       (size_t)(n * samples * size));
				}
				TIFFWriteTile(tif, tile, (uint32_t)x0, (uint32_t)y0, 0, (uint16_t)plane);
			}
	free(tile);
	free(line);
}

struct blob encode_tiff(const struct pixels *p, int bits, int how, int orientation)
{
	char path[] = "/tmp/eyewright-variant-XXXXXX", *data;
	struct blob out = { 0 };
	struct err err = { 0 };
	int every = how & AS_PLANAR ? p->channels : 1, fd = mkstemp(path);
	uint8_t *line = mem_new((size_t)p->width * (size_t)p->channels, 4);
	TIFF *tif = TIFFFdOpen(fd, path, how & AS_BIG_ENDIAN ? "wb" : "wl");
	tiff_tags(tif, p, how & AS_FLOAT ? 32 : bits, how, orientation);
	if (how & AS_TILED)
		write_tiles(tif, p, bits, how);
	else
		for (int plane = 0; plane < every; plane++)
			for (int y = 0; y < p->height; y++) {
				line_of(p, y, bits, plane, every, line);
				TIFFWriteScanline(tif, line, (uint32_t)y, (uint16_t)plane);
			}
	TIFFClose(tif);
	free(line);
	if (file_read(&data, &out.size, path, (size_t)1 << 30, &err))
		out.data = (uint8_t *)data;
	unlink(path);
	return out;
}

struct blob encode_jpeg(const struct pixels *p, int cmyk)
{
	long n = (long)p->width * p->height * p->channels;
	uint8_t *px = mem_array((size_t)n, 1);
	struct blob out = { 0 };
	unsigned char *data = 0;
	unsigned long size = 0;
	for (long i = 0; i < n; i++)
		px[i] = (uint8_t)(p->px[i] >> 8);
	tjhandle tj = tjInitCompress();
	int format = cmyk ? TJPF_CMYK : p->channels == 1 ? TJPF_GRAY : p->channels == 3 ? TJPF_RGB : TJPF_RGBX;
	tjCompress2(tj, px, p->width, 0, p->height, format, &data, &size, p->channels == 1 ? TJSAMP_GRAY : TJSAMP_444, 95,
	            TJFLAG_ACCURATEDCT);
	out = (struct blob){ mem_array(size, 1), size };
	memcpy(out.data, data, size);
	tjFree(data);
	tjDestroy(tj);
	free(px);
	return out;
}

struct ifd_writer {
	uint8_t block[512];
	int at, entries, values;  // next entry, count of them, next value behind the entries
};

static void put(uint8_t *at, uint32_t v, int n)
{
	for (int i = 0; i < n; i++)
		at[i] = (uint8_t)(v >> 8 * i);
}

static void entry(struct ifd_writer *w, int tag, int type, double value)
{
	uint8_t *e = w->block + w->at;
	put(e, (uint32_t)tag, 2);
	put(e + 2, (uint32_t)type, 2);
	put(e + 4, 1, 4);
	if (type == 5) {
		put(e + 8, (uint32_t)w->values, 4);
		put(w->block + w->values, (uint32_t)(value * 1000 + 0.5), 4);
		put(w->block + w->values + 4, 1000, 4);
		w->values += 8;
	} else
		put(e + 8, (uint32_t)value, type == 3 ? 2 : 4);
	w->at += 12;
	w->entries++;
}

static void text_entry(struct ifd_writer *w, int tag, const char *text)
{
	uint8_t *e = w->block + w->at;
	size_t n = strlen(text) + 1;
	put(e, (uint32_t)tag, 2);
	put(e + 2, 2, 2);
	put(e + 4, (uint32_t)n, 4);
	put(e + 8, (uint32_t)w->values, 4);
	memcpy(w->block + w->values, text, n);
	w->values += (int)(n + n % 2);
	w->at += 12;
	w->entries++;
}

struct blob with_exif(struct blob jpeg, const struct exif_block *exif)
{
	return with_exif_of(jpeg, exif, 0);
}

struct blob with_exif_of(struct blob jpeg, const struct exif_block *exif, const char *model)
{
	struct ifd_writer w = { .at = 10, .values = 300 };
	memcpy(w.block, "II*\0\10\0\0\0", 8);
	if (model)
		text_entry(&w, 0x0110, model);
	entry(&w, 0x0112, 3, exif->orientation);
	entry(&w, 0x8769, 4, 100);
	put(w.block + 8, (uint32_t)w.entries, 2);
	w.at = 102;
	w.entries = 0;
	if (exif->focal_mm >= 0)
		entry(&w, 0x920a, 5, exif->focal_mm);
	if (exif->full_width >= 0)
		entry(&w, 0xa002, 4, exif->full_width);
	if (exif->full_height >= 0)
		entry(&w, 0xa003, 4, exif->full_height);
	if (exif->plane_res >= 0) {
		entry(&w, 0xa20e, 5, exif->plane_res);
		entry(&w, 0xa210, 3, 3);  // centimetre
	}
	if (exif->focal_35mm >= 0)
		entry(&w, 0xa405, 3, exif->focal_35mm);
	put(w.block + 100, (uint32_t)w.entries, 2);
	enum { HEAD = 10 };
	size_t length = sizeof w.block + 8, size = jpeg.size + length + 2;
	struct blob out = { mem_array(size, 1), size };
	uint8_t head[HEAD] = { 0xff, 0xe1, (uint8_t)(length >> 8), (uint8_t)length, 'E', 'x', 'i', 'f' };
	memcpy(out.data, jpeg.data, 2);
	memcpy(out.data + 2, head, HEAD);
	memcpy(out.data + 2 + HEAD, w.block, sizeof w.block);
	memcpy(out.data + 2 + HEAD + sizeof w.block, jpeg.data + 2, jpeg.size - 2);
	return out;
}

void claim_size(struct blob file, int width, int height)
{
	for (size_t i = 0; i + 9 < file.size; i++) {
		uint8_t *p = file.data + i;
		if (file.data[0] == 0xff && p[0] == 0xff && p[1] == 0xc0) {
			uint8_t size[4] = { (uint8_t)(height >> 8), (uint8_t)height, (uint8_t)(width >> 8), (uint8_t)width };
			memcpy(p + 5, size, 4);
			return;
		}
		if (file.data[0] == 0x89 && !memcmp(p, "IHDR", 4)) {
			for (int k = 0; k < 4; k++) {
				p[4 + k] = (uint8_t)(width >> (24 - 8 * k));
				p[8 + k] = (uint8_t)(height >> (24 - 8 * k));
			}
			return;
		}
	}
}
