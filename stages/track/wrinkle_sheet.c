#include "stages/track/wrinkle_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_draw.h"
#include "bridge/cv_photo.h"

enum { CELL = 620, GAP = 6, LINE = 24 };

static void put_grey(const struct cv_picture *sheet, const uint8_t *grey, const struct wrinkle_ground *g, int x0, int y0, int height)
{
	uint8_t *small = cv_resize8(grey, g->width, g->height, 1, CELL, height);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < CELL; x++)
			memset(sheet->px + 3 * ((long)(y0 + y) * sheet->width + x0 + x), small[(long)y * CELL + x], 3);
	free(small);
}

/* Where the peak shows a place of the chart: moved as the nearest point that is seen. */
static void in_frame(double out[2], const double px[2], const struct wrinkle_ground *g, const struct wrinkle_frame *f)
{
	double best = INFINITY;
	memcpy(out, px, 2 * sizeof *out);
	for (int i = 0; i < g->n; i++) {
		double d = hypot(g->at[i][0] - px[0], g->at[i][1] - px[1]);
		if (d < best && f->confidence[i] > 0.3f) {
			best = d;
			for (int k = 0; k < 2; k++)
				out[k] = px[k] + (double)f->at[i][k] - g->at[i][k];
		}
	}
}

/* Yellow where it is shallow, red from a fifth of a millimetre on. */
static void draw_lines(const struct cv_picture *sheet, const struct wrinkle_pose *p, const struct wrinkle_ground *g, const struct wrinkle_frame *peak,
                       int x0, int y0)
{
	double scale = (double)CELL / g->width;
	for (int i = 0; i < p->n; i++) {
		float last[2] = { 0, 0 };
		for (int k = 0; k < p->line[i].n; k++) {
			const struct wrinkle_point *q = &p->line[i].point[k];
			double at[2];
			in_frame(at, q->px, g, peak);
			float xy[2][2] = { { last[0], last[1] }, { (float)(x0 + (at[0] - g->x0) * scale), (float)(y0 + (at[1] - g->y0) * scale) } };
			const uint8_t colour[3] = { 255, (uint8_t)(225 * (1 - fmin(1, q->depth / 0.2))), 30 };
			if (k)
				cv_draw_line(sheet, 2, (const float(*)[2])xy, false, 1, colour);
			memcpy(last, xy[1], sizeof last);
		}
	}
}

static void put_bump(const struct cv_picture *sheet, const struct wrinkles *w, const struct wrinkle_pose *p, const struct wrinkle_ground *g, int x0,
                     int y0, int height)
{
	struct image bump = wrinkle_bump(w, p);
	uint8_t *grey = mem_array((size_t)w->width * (size_t)w->height, 1);
	for (int y = 0; y < w->height; y++)
		for (int x = 0; x < w->width; x++) {
			int u = x > 0 ? x - 1 : x, v = y > 0 ? y - 1 : y, right = x + 1 < w->width ? x + 1 : x, down = y + 1 < w->height ? y + 1 : y;
			double dx = (double)(image_at(&bump, right, y)[0] - image_at(&bump, u, y)[0]) * w->px_per_mm / 2;
			double dy = (double)(image_at(&bump, x, down)[0] - image_at(&bump, x, v)[0]) * w->px_per_mm / 2;
			double light = (0.5 * dx + 0.5 * dy + 0.7) / sqrt(1 + dx * dx + dy * dy) * 0.5 + 0.35 * (double)image_at(&bump, x, y)[1];
			grey[(long)y * w->width + x] = (uint8_t)fmax(0, fmin(255, 235 * light));
		}
	put_grey(sheet, grey, g, x0, y0, height);
	free(grey);
	image_free(&bump);
}

bool wrinkle_sheet(const char *path, const struct wrinkles *w, const struct wrinkle_ground *g, int n, const struct wrinkle_frame neutral[],
                   const struct wrinkle_frame peak[], struct err *err)
{
	static const uint8_t white[3] = { 235, 235, 235 };
	int height = (int)lround((double)CELL * g->height / g->width), row = height + LINE + GAP;
	struct cv_picture sheet = { 0, 3 * CELL + 4 * GAP, n * row + GAP, 3 };
	size_t bytes = 3 * (size_t)sheet.width * (size_t)sheet.height;
	sheet.px = mem_array(bytes, 1);
	memset(sheet.px, 24, bytes);
	for (int i = 0; i < n; i++) {
		const struct wrinkle_pose *p = &w->pose[i];
		int y = GAP + i * row, x[3] = { GAP, CELL + 2 * GAP, 2 * CELL + 3 * GAP };
		char *text[3] = { mem_printf("%s: frame %ld", p->name, neutral[i].index), mem_printf("frame %ld: %d lines", peak[i].index, p->n), mem_str("bump map") };
		if (neutral[i].grey)
			put_grey(&sheet, neutral[i].grey, g, x[0], y, height);
		if (peak[i].grey) {
			put_grey(&sheet, peak[i].grey, g, x[1], y, height);
			draw_lines(&sheet, p, g, &peak[i], x[1], y);
		}
		put_bump(&sheet, w, p, g, x[2], y, height);
		for (int k = 0; k < 3; k++) {
			cv_draw_text(&sheet, x[k] + 4, y + height + LINE - 8, 11, text[k], white);
			free(text[k]);
		}
	}
	bool ok = picture_png_write(path, sheet.px, sheet.width, sheet.height, 3, err);
	free(sheet.px);
	return ok;
}
