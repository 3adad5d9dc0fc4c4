#include "tests/lib/unseen/tiles.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "image/picture.h"
#include "tests/lib/bench/bench.h"

enum { SIDE = 200, COLUMNS = 10, MOST = 300 };

struct tiles { int n; uint8_t *px; };  // [n][SIDE][SIDE][3]

struct tiles *tiles_new(void)
{
	return mem_new(1, sizeof(struct tiles));
}

static void dot(uint8_t *tile, double x, double y, const uint8_t rgb[3])
{
	if (x >= 0 && y >= 0 && x < SIDE && y < SIDE)
		memcpy(tile + 3 * ((int)y * SIDE + (int)x), rgb, 3);
}

static void curve(uint8_t *tile, const struct ellipse *e, const double at[2], double scale, const uint8_t rgb[3])
{
	for (int k = 0; k < 720 && e; k++) {
		double p[2], normal[2];
		ellipse_point(p, normal, e, k * M_PI / 360);
		dot(tile, (p[0] - at[0]) / scale, (p[1] - at[1]) / scale, rgb);
	}
}

/* Digits of 3 x 5 px, three bits a row, twice as large. */
static void digits(uint8_t *tile, int number)
{
	static const int glyph[10] = { 075557, 026227, 071747, 071717, 055711, 074717, 074757, 071111, 075757, 075717 };
	char text[16];
	snprintf(text, sizeof text, "%d", number);
	for (int k = 0; text[k]; k++)
		for (int i = 0; i < 60; i++) {
			const int x = i % 6, y = i / 6, on = glyph[text[k] - '0'] >> (3 * (4 - y / 2) + 2 - x / 2) & 1;
			dot(tile, 4 + 8 * k + x, 4 + y, (const uint8_t[3]){ on ? 255 : 0, on ? 255 : 0, 0 });
		}
}

void tiles_add(struct tiles *t, const struct photo *photo, const struct ellipse *truth, const struct ellipse *answer, int number)
{
	static const uint8_t green[3] = { 0, 255, 0 }, red[3] = { 255, 0, 0 };
	if (t->n == MOST)
		return;
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	const struct ellipse whole = { photo->width / 2.0, photo->height / 2.0, photo->width / 3.0, photo->width / 3.0, 0 };
	for (int k = 0; k < 2; k++) {
		const struct ellipse *e = k ? answer : truth;
		e = e || truth || answer ? e : &whole;
		if (!e)
			continue;
		low[0] = fmin(low[0], e->cx - 1.6 * e->a);
		low[1] = fmin(low[1], e->cy - 1.6 * e->a);
		high[0] = fmax(high[0], e->cx + 1.6 * e->a);
		high[1] = fmax(high[1], e->cy + 1.6 * e->a);
	}
	const double size = fmax(high[0] - low[0], high[1] - low[1]), scale = size / SIDE;
	const double at[2] = { (low[0] + high[0] - size) / 2, (low[1] + high[1] - size) / 2 };
	t->px = mem_grow(t->px, (size_t)(t->n + 1) * SIDE * SIDE, 3);
	uint8_t *tile = t->px + 3L * SIDE * SIDE * t->n++;
	memset(tile, 0, 3 * SIDE * SIDE);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			const int u = (int)floor(at[0] + (x + 0.5) * scale), v = (int)floor(at[1] + (y + 0.5) * scale);
			for (int c = 0; c < 3 && u >= 0 && v >= 0 && u < photo->width && v < photo->height; c++)
				tile[3 * (y * SIDE + x) + c] = (uint8_t)(photo->rgb[3 * ((long)v * photo->width + u) + c] >> 8);
		}
	curve(tile, truth, at, scale, green);
	curve(tile, answer, at, scale, red);
	digits(tile, number);
}

void tiles_write(struct tiles *t, const char *name)
{
	char *path = mem_printf("%s/%s", bench_out(), name);
	const int rows = (t->n + COLUMNS - 1) / COLUMNS, width = COLUMNS * SIDE, height = rows * SIDE;
	struct err err = { 0 };
	unlink(path);
	if (t->n) {
		uint8_t *sheet = mem_new((size_t)width * (size_t)height, 3);
		for (int i = 0; i < t->n; i++)
			for (int y = 0; y < SIDE; y++)
				memcpy(sheet + 3L * ((i / COLUMNS * SIDE + y) * width + i % COLUMNS * SIDE), t->px + 3L * SIDE * (SIDE * i + y), 3 * SIDE);
		if (!picture_png_write(path, sheet, width, height, 3, &err))
			fprintf(stderr, "%s\n", err.msg);
		free(sheet);
	}
	free(path);
	free(t->px);
	free(t);
}
