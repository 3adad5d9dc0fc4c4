/* layers FILE.exr [WHOLE.exr] [LOOK.png]: whether a picture's layers are what other programs take them for: normals of unit length
 * towards the camera where there is depth, and diffuse and specular light together the whole picture, as far as half floats go.
 * Says what is wrong; LOOK.png: normal, diffuse and specular light beside each other. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "image/exr.h"
#include "image/picture.h"

enum { NX, NY, NZ, Z, DIFFUSE, SPECULAR = DIFFUSE + 3, CHANNELS = SPECULAR + 3 };

static int look(const struct image *layers, const char *path)
{
	struct err err = { 0 };
	int w = layers->width;
	struct image out = image_new(3 * w, layers->height, 3);
	for (int y = 0; y < layers->height; y++)
		for (int x = 0; x < w; x++)
			for (int c = 0; c < 3; c++) {
				const float *px = image_at(layers, x, y);
				image_at(&out, x, y)[c] = 0.5f + 0.5f * px[NX + c] * (c ? -1 : 1);
				image_at(&out, x + w, y)[c] = px[DIFFUSE + c];
				image_at(&out, x + 2 * w, y)[c] = 4 * px[SPECULAR + c];
			}
	return picture_png_write_linear(path, &out, &err) ? 0 : 1;
}

int main(int argc, char **argv)
{
	static const char *const names[] = { "N.X", "N.Y", "N.Z", "Z", "diffuse.R", "diffuse.G", "diffuse.B", "specular.R", "specular.G", "specular.B" };
	static const char *const rgb[] = { "R", "G", "B" };
	struct image layers, whole = { 0 };
	struct exr_info info = { 0 };
	struct err err = { 0 };
	long seen = 0, shine = 0, bent = 0, apart = 0;
	if (argc < 2 || !exr_read(&layers, argv[1], CHANNELS, names, 1L << 26, &info, &err)
	    || (argc > 2 && strcmp(argv[2], "-") && !exr_read(&whole, argv[2], 3, rgb, 1L << 26, &info, &err))) {
		fprintf(stderr, "layers: %s\n", err.msg);
		return 2;
	}
	for (long i = 0; i < (long)layers.width * layers.height; i++) {
		const float *px = layers.px + CHANNELS * i;
		float length = sqrtf(px[NX] * px[NX] + px[NY] * px[NY] + px[NZ] * px[NZ]);
		seen += px[Z] > 0 && isfinite(px[Z]) && length > 0;
		bent += length > 0 && !(fabsf(length - 1) < 2e-3f && px[NZ] < 0.02f);
		shine += px[SPECULAR] > 0.02f;
		for (int c = 0; c < 3 && whole.px; c++)
			apart += !(fabsf(px[DIFFUSE + c] + px[SPECULAR + c] - whole.px[3 * i + c]) <= 2e-3f * (1 + whole.px[3 * i + c]));
	}
	printf("%ld pixels seen, %ld shine, %ld normals are none, %ld values do not add up\n", seen, shine, bent, apart);
	if (argc > 3 && look(&layers, argv[3]))
		return 2;
	return seen > 100 && shine > 10 && 100 * bent < seen && apart == 0 ? 0 : 1;
}
