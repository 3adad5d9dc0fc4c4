/* evidence_sheet: what the evidence network sees in a photograph, to look at.
 *
 *     evidence_sheet NETWORK PHOTO OUT.png
 *
 * Left to right, each above its classes: the whole photograph, the windows round the two best candidates. Prints the candidates:
 * centre, radius, score, and the milliseconds that it took.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "image/picture.h"
#include "limbus/evidence.h"

enum { PARTS = 3, WIDE = 320, HIGH = 320 };

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The photograph's part that the planes cover, and the mean of the classes' colours. */
static void part(uint8_t *sheet, int at, const struct evidence *e, const struct photo *photo)
{
	static const float colour[EVIDENCE_CLASSES][3] = { { 60, 40, 30 }, { 150, 90, 0 }, { 230, 230, 230 }, { 60, 130, 230 }, { 0, 0, 0 }, { 255, 60, 200 } };
	const double step = fmax(e->width * e->scale / WIDE, e->height * e->scale / HIGH);
	for (int j = 0; j < HIGH; j++)
		for (int i = 0; i < WIDE; i++) {
			const double x = e->x0 + (i + 0.5) * step, y = e->y0 + (j + 0.5) * step;
			uint8_t *up = sheet + 3 * ((long)j * PARTS * WIDE + at * WIDE + i), *down = up + 3L * HIGH * PARTS * WIDE;
			if (x >= 0 && y >= 0 && x < photo->width && y < photo->height)
				for (int c = 0; c < 3; c++)
					up[c] = (uint8_t)(photo->rgb[3 * ((long)y * photo->width + (long)x) + c] / 257);
			if (x > e->x0 + e->width * e->scale || y > e->y0 + e->height * e->scale)
				continue;
			for (int c = 0; c < 3; c++) {
				float sum = 0;
				for (int k = 0; k < EVIDENCE_CLASSES; k++)
					sum += colour[k][c] * evidence_at(e, (enum evidence_class)k, x, y);
				down[c] = (uint8_t)sum;
			}
		}
}

int main(int argc, char **argv)
{
	struct err err = { 0 };
	struct evidence_net *net = 0;
	struct photo photo = { 0 };
	struct evidence e;
	struct evidence_region region[EVIDENCE_REGIONS];
	int n = 0;
	if (argc != 4) {
		fprintf(stderr, "usage: evidence_sheet NETWORK PHOTO OUT.png\n");
		return 2;
	}
	uint8_t *sheet = calloc(2L * HIGH * PARTS * WIDE, 3);
	bool ok = evidence_open(&net, argv[1], &err) && photo_load(&photo, argv[2], 100, &err) && evidence_find(region, &n, net, &photo, &err);
	const double begun = now();
	ok = ok && evidence_find(region, &n, net, &photo, &err);
	const double found = now();
	if (ok && evidence_whole(&e, net, &photo, 256, &err)) {
		part(sheet, 0, &e, &photo);
		evidence_free(&e);
	}
	for (int i = 0; i < n; i++) {
		printf("candidate %d: (%.0f, %.0f) radius %.0f px, score %.3f\n", i, region[i].x, region[i].y, region[i].radius, region[i].score);
		if (i + 1 < PARTS && evidence_window(&e, net, &photo, region[i].x, region[i].y, region[i].radius, &err)) {
			part(sheet, 1 + i, &e, &photo);
			evidence_free(&e);
		}
	}
	ok = ok && picture_png_write(argv[3], sheet, PARTS * WIDE, 2 * HIGH, 3, &err);
	if (ok)
		printf("%.1f ms to find %d candidates in %d x %d px\n", 1000 * (found - begun), n, photo.width, photo.height);
	else
		fprintf(stderr, "evidence_sheet: %s\n", err.msg);
	photo_free(&photo);
	evidence_close(net);
	free(sheet);
	return !ok;
}
