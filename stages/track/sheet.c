#include "stages/track/sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_draw.h"
#include "image/picture.h"

enum { COLUMNS = 3, CELLS = 12, LINE = 22, GAP = 6 };

/* The kept frame nearest to f, marked. */
static void mark(bool *chosen, int *n, const struct film *film, double f)
{
	int best = 0;
	for (int i = 1; i < film->n; i++)
		best = fabs((double)film->frame[i] - f) < fabs((double)film->frame[best] - f) ? i : best;
	if (*n < CELLS && film->n && !chosen[best]) {
		chosen[best] = true;
		(*n)++;
	}
}

static void choose(bool *chosen, const struct film *film, const struct track_result *r, const struct track_clip *clip, const struct track_conf *conf)
{
	int n = 0, blinks = 0, width = 10 + r->n_au;
	mark(chosen, &n, film, (double)clip->reference);
	for (int i = 0; i < r->eyes.events && blinks < 2; i++)
		if (r->eyes.event[i].kind == EVENT_BLINK && r->eyes.event[i].side == (r->eyes.globe[0].seen ? SIDE_LEFT : SIDE_RIGHT)) {
			mark(chosen, &n, film, r->eyes.event[i].peak);
			mark(chosen, &n, film, 0.5 * (r->eyes.event[i].first + r->eyes.event[i].peak));
			blinks++;
		}
	for (int i = 0; i < conf->expression.n && i < 3; i++)
		mark(chosen, &n, film, conf->expression.items[i].value[1]);
	for (int k = 0; k < 4; k++) {
		double best = -INFINITY;
		long at = 0;
		for (long f = 0; f < r->n; f++) {
			const double *g = r->g + f * width;
			double a = (k < 2 ? -1 : 1) * (isfinite(g[0]) ? g[k % 2] : g[5 + k % 2]);
			if (a > best) {
				best = a;
				at = f;
			}
		}
		mark(chosen, &n, film, (double)at);
	}
	for (int i = 1; i < 3 * CELLS; i++)
		mark(chosen, &n, film, (double)(r->n - 1) * ((double)(7 * i % (3 * CELLS)) / (3 * CELLS)));
}

struct cell {
	struct cv_picture picture;
	double x, y, step;     // of the picture's pixel (0, 0) on the sheet, px; pixels of the video a px of the sheet
};

static void line(const struct cell *c, int n, const double (*px)[2], bool closed, int thickness, const uint8_t colour[3])
{
	float xy[256][2];
	for (int i = 0; i < n && i < 256; i++)
		for (int k = 0; k < 2; k++)
			xy[i][k] = (float)(px[i][k] / c->step + (k ? c->y : c->x));
	cv_draw_line(&c->picture, n < 256 ? n : 256, (const float(*)[2])xy, closed, thickness, colour);
}

static void draw_points(const struct cell *c, const struct track_result *r, long f)
{
	static const uint8_t seen[3] = { 255, 214, 10 }, lost[3] = { 150, 40, 40 };
	for (int i = 0; i < r->n_points; i++) {
		const float *p = r->skin[f * r->n_points + i];
		const double dot[2][2] = { { p[0] - 0.5 * c->step, p[1] }, { p[0] + 0.5 * c->step, p[1] } };
		line(c, 2, dot, false, 2, r->confidence[f * r->n_points + i] > 0 ? seen : lost);
	}
}

static void draw_eye(const struct cell *c, const struct eye_state *s)
{
	static const uint8_t lids[LIDS][3] = { { 70, 230, 90 }, { 60, 200, 255 } }, rim[3] = { 255, 110, 60 };
	enum { AROUND = 64 };
	double round[AROUND][2];
	for (int i = 0; i < AROUND && isfinite(s->limbus[0]); i++) {
		double t = 2 * M_PI * i / AROUND, u = s->limbus[2] * cos(t), v = s->limbus[3] * sin(t);
		round[i][0] = s->limbus[0] + u * cos(s->limbus[4]) - v * sin(s->limbus[4]);
		round[i][1] = s->limbus[1] + u * sin(s->limbus[4]) + v * cos(s->limbus[4]);
	}
	if (isfinite(s->limbus[0]))
		line(c, AROUND, (const double(*)[2])round, true, 1, rim);
	for (int k = 0; k < LIDS; k++)
		if (s->lid_points > 0 && isfinite(s->lid[k][0][0]))
			line(c, s->lid_points, (const double(*)[2])s->lid[k], false, 1, lids[k]);
}

/* Too narrow for one line of text. */
static bool is_narrow(const struct film *film)
{
	return film->width < 460;
}

static int text_height(const struct film *film)
{
	return is_narrow(film) ? 3 * LINE - 8 : LINE;
}

static void draw_cell(const struct cv_picture *sheet, const struct film *film, int k, int x0, int y0, const struct track_result *r)
{
	static const uint8_t white[3] = { 235, 235, 235 };
	long f = film->frame[k];
	for (int y = 0; y < film->height; y++)
		for (int x = 0; x < film->width; x++)
			memset(sheet->px + 3 * ((long)(y0 + y) * sheet->width + x0 + x), film->px[k][y * film->width + x], 3);
	struct cell c = { *sheet, x0 - (double)film->x0 / film->step, y0 - (double)film->y0 / film->step, film->step };
	draw_points(&c, r, f);
	const int x = x0 + 4, y = y0 + film->height + LINE - 7;
	char text[80];
	snprintf(text, sizeof text, "%ld  %.2f s", f, r->time[f]);
	int at = cv_draw_text(sheet, x, y, 11, text, white), line = 0;
	for (int e = SIDES - 1; e >= 0 && r->has_eyes; e--) {
		const struct eye_state *s = &r->eyes.state[f][e];
		draw_eye(&c, s);
		if (isfinite(s->gaze[0]))
			snprintf(text, sizeof text, "%s %+.1f %+.1f", e ? "right" : "left", s->gaze[0] * 180 / M_PI, s->gaze[1] * 180 / M_PI);
		else if (r->eyes.globe[e].seen)
			snprintf(text, sizeof text, "%s -", e ? "right" : "left");
		else
			continue;
		if (is_narrow(film))
			cv_draw_text(sheet, x, y + ++line * (LINE - 4), 11, text, white);
		else
			at += 24 + cv_draw_text(sheet, x + at + 24, y, 11, text, white);
	}
}

bool track_sheet(const struct film *film, const char *path, const struct track_result *r, const struct track_clip *clip,
                const struct track_conf *conf, struct err *err)
{
	bool chosen[FILM_MOST] = { 0 };
	int n = 0;
	choose(chosen, film, r, clip, conf);
	for (int i = 0; i < film->n; i++)
		n += chosen[i];
	int rows = (n + COLUMNS - 1) / COLUMNS, w = COLUMNS * (film->width + GAP) + GAP, below = film->height + text_height(film) + GAP, h = rows * below + GAP;
	struct cv_picture sheet = { mem_new(3 * (size_t)w * (size_t)h + 1, 1), w, h, 3 };
	memset(sheet.px, 24, 3 * (size_t)w * (size_t)h);
	for (int i = 0, k = 0; i < film->n; i++)
		if (chosen[i]) {
			draw_cell(&sheet, film, i, GAP + k % COLUMNS * (film->width + GAP), GAP + k / COLUMNS * below, r);
			k++;
		}
	bool ok = picture_png_write(path, sheet.px, w, h, 3, err);
	free(sheet.px);
	return ok;
}
