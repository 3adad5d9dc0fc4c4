/* variant: encodes a photograph in the formats, orientations and damaged forms that cameras, editors and attackers produce. */
#ifndef TESTS_VARIANT_H
#define TESTS_VARIANT_H
#include <stddef.h>
#include <stdint.h>

/* 16-bit pixels, [height][width][channels]; channels 1 (grey), 3 (RGB), 4 (RGBA). */
struct pixels {
	int width, height, channels;
	uint16_t *px;  // owned
};

/* A picture with an exact value in every place: channel c of (x, y). */
uint16_t pattern_value(int x, int y, int c);
struct pixels pattern(int width, int height, int channels);
void pixels_free(struct pixels *p);

/* Encoded bytes; free(). bits: 8 or 16; 8-bit values are the upper bytes. */
struct blob {
	uint8_t *data;
	size_t size;
};
struct blob encode_png(const struct pixels *p, int bits);

enum { AS_PLAIN = 0, AS_PLANAR = 1, AS_TILED = 2, AS_LZW = 4, AS_CMYK = 8, AS_FLOAT = 16, AS_BIG_ENDIAN = 32 };
struct blob encode_tiff(const struct pixels *p, int bits, int how, int orientation);

/* quality 95, no chroma subsampling; cmyk: four inks. */
struct blob encode_jpeg(const struct pixels *p, int cmyk);

/* The JPEG with an EXIF block behind its first two bytes. Numbers below zero are left out. */
struct exif_block {
	int orientation;
	double focal_mm, focal_35mm, plane_res;  // plane_res: pixels a centimetre
	int full_width, full_height;
};
struct blob with_exif(struct blob jpeg, const struct exif_block *exif);
struct blob with_exif_of(struct blob jpeg, const struct exif_block *exif, const char *model);  // model: of the camera, 0..100 bytes

/* The JPEG or PNG claiming another size; pixels stay. */
void claim_size(struct blob file, int width, int height);

#endif
