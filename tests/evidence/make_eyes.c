/* make_eyes: writes drawn eyes with the class of every pixel to stdout, for training.
 *
 *     make_eyes FIRST COUNT WIDTH HEIGHT [test] [TRUTH.jsonl] | train.py
 *     make_eyes sheet FIRST COLUMNS ROWS WIDTH HEIGHT OUT.png [test]
 *
 * One picture after the other: WIDTH x HEIGHT x 3 bytes RGB, then as many labels. TRUTH.jsonl: ellipses, openness, light, one
 * line a picture. sheet: a contact sheet with the labels below each row, to look at.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image/picture.h"
#include "scene.h"

static void note(FILE *file, uint64_t number, const struct drawn *d)
{
	fprintf(file, "{\"number\": %llu, \"light\": %d, \"iris\": %d, \"other\": %d, \"eyes\": [", (unsigned long long)number, d->light, d->iris, d->other);
	for (int e = 0; e < d->n_eyes; e++) {
		const float *l = d->eye[e].limbus, *p = d->eye[e].pupil;
		fprintf(file, "%s{\"limbus\": [%.3f, %.3f, %.3f, %.3f, %.5f], \"pupil\": [%.3f, %.3f, %.3f, %.3f, %.5f], \"openness\": %.3f, \"shown\": %.3f}",
		        e ? ", " : "", l[0], l[1], l[2], l[3], l[4], p[0], p[1], p[2], p[3], p[4], d->eye[e].openness, d->eye[e].shown);
	}
	fprintf(file, "]}\n");
}

static int stream(uint64_t first, int count, int width, int height, bool test, const char *truth)
{
	FILE *file = truth ? fopen(truth, "w") : 0;
	for (int i = 0; i < count; i++) {
		struct drawn d = drawn_make(first + (uint64_t)i, test, width, height);
		const size_t n = (size_t)width * (size_t)height;
		const bool written = fwrite(d.rgb, 3, n, stdout) == n && fwrite(d.label, 1, n, stdout) == n;
		if (file)
			note(file, first + (uint64_t)i, &d);
		drawn_free(&d);
		if (!written)
			break;
	}
	if (file)
		fclose(file);
	return 0;
}

static int sheet(uint64_t first, int columns, int rows, int width, int height, const char *path, bool test)
{
	static const uint8_t colour[EVIDENCE_CLASSES][3] = { { 60, 40, 30 }, { 150, 90, 0 }, { 230, 230, 230 }, { 60, 130, 230 }, { 0, 0, 0 }, { 255, 60, 200 } };
	const int w = columns * width, h = 2 * rows * height;
	uint8_t *px = calloc((size_t)w * (size_t)h, 3);
	for (int r = 0; r < rows; r++)
		for (int c = 0; c < columns; c++) {
			struct drawn d = drawn_make(first + (uint64_t)(r * columns + c), test, width, height);
			for (int y = 0; y < height; y++)
				for (int x = 0; x < width; x++) {
					memcpy(px + 3 * ((long)(2 * r * height + y) * w + c * width + x), d.rgb + 3 * (y * width + x), 3);
					memcpy(px + 3 * ((long)((2 * r + 1) * height + y) * w + c * width + x), colour[d.label[y * width + x]], 3);
				}
			drawn_free(&d);
		}
	struct err err = { 0 };
	const bool ok = picture_png_write(path, px, w, h, 3, &err);
	free(px);
	return !ok;
}

int main(int argc, char **argv)
{
	if (argc >= 8 && strcmp(argv[1], "sheet") == 0)
		return sheet(strtoull(argv[2], 0, 10), atoi(argv[3]), atoi(argv[4]), atoi(argv[5]), atoi(argv[6]), argv[7], argc > 8);
	if (argc < 5) {
		fprintf(stderr, "usage: make_eyes FIRST COUNT WIDTH HEIGHT [test] [TRUTH.jsonl]\n       make_eyes sheet FIRST COLUMNS ROWS WIDTH HEIGHT OUT.png [test]\n");
		return 2;
	}
	const bool test = argc > 5 && strcmp(argv[5], "test") == 0;
	return stream(strtoull(argv[1], 0, 10), atoi(argv[2]), atoi(argv[3]), atoi(argv[4]), test, argc > 5 + test ? argv[5 + test] : 0);
}
