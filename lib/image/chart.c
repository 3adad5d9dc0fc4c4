#include "image/chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

enum { LEFT = 58, RIGHT = 14, TOP = 30, BOTTOM = 42, TICKS = 6 };

/* Where a panel's data lies on the sheet. */
struct frame {
	double x0, y0, width, height;  // px of the plot area
	double low[2], high[2];        // data
};

static double place_x(const struct frame *f, double x)
{
	return f->x0 + f->width * (x - f->low[0]) / (f->high[0] - f->low[0]);
}

static double place_y(const struct frame *f, double y)
{
	return f->y0 + f->height * (f->high[1] - y) / (f->high[1] - f->low[1]);
}

static void text(FILE *out, const char *s)
{
	for (; s && *s; s++)
		switch (*s) {
		case '<': fputs("&lt;", out); break;
		case '>': fputs("&gt;", out); break;
		case '&': fputs("&amp;", out); break;
		case '"': fputs("&quot;", out); break;
		default: fputc((unsigned char)*s < ' ' ? ' ' : *s, out);
		}
}

/* 1, 2 or 5 times a power of ten, so that at most TICKS fit. */
static double tick_step(double range)
{
	double step = pow(10, floor(log10(range / TICKS)));
	static const double of[] = { 1, 2, 5, 10 };
	for (int i = 0; i < 4; i++)
		if (range / (step * of[i]) <= TICKS)
			return step * of[i];
	return step * 10;
}

static void limits(struct frame *f, const struct chart_panel *p)
{
	for (int a = 0; a < 2; a++) {
		f->low[a] = INFINITY;
		f->high[a] = -INFINITY;
	}
	for (int s = 0; s < p->n; s++)
		for (int i = 0; i < p->series[s].n; i++) {
			double x = p->series[s].x[i], y = p->series[s].y[i];
			if (!isfinite(x) || !isfinite(y))
				continue;
			f->low[0] = fmin(f->low[0], x);
			f->high[0] = fmax(f->high[0], x);
			f->low[1] = fmin(f->low[1], y);
			f->high[1] = fmax(f->high[1], y);
		}
	for (int a = 0; a < 2; a++) {
		if (!(f->high[a] >= f->low[a]))
			f->low[a] = 0, f->high[a] = 1;
		double range = f->high[a] - f->low[a], pad = range > 0 ? 0.04 * range * a : 0.5 * (fabs(f->low[a]) + 1);
		f->low[a] -= pad;
		f->high[a] += pad;
	}
	f->low[1] = isnan(p->y_low) ? f->low[1] : p->y_low;
	f->high[1] = isnan(p->y_high) ? f->high[1] : p->y_high;
}

static void axes(FILE *out, const struct frame *f, const struct chart_panel *p)
{
	fprintf(out, "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" fill=\"#fff\" stroke=\"#999\"/>\n", f->x0, f->y0,
	        f->width, f->height);
	double step = tick_step(f->high[0] - f->low[0]);
	for (double v = ceil(f->low[0] / step) * step; v <= f->high[0] + 1e-9 * step; v += step) {
		double x = place_x(f, v);
		fprintf(out, "<path d=\"M%.1f %.1fv%.1f\" stroke=\"#e4e4e4\"/>", x, f->y0, f->height);
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.6g</text>\n", x, f->y0 + f->height + 15,
		        fabs(v) < 1e-9 * step ? 0 : v);
	}
	step = tick_step(f->high[1] - f->low[1]);
	for (double v = ceil(f->low[1] / step) * step; v <= f->high[1] + 1e-9 * step; v += step) {
		double y = place_y(f, v);
		fprintf(out, "<path d=\"M%.1f %.1fh%.1f\" stroke=\"#e4e4e4\"/>", f->x0, y, f->width);
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%.6g</text>\n", f->x0 - 5, y + 4,
		        fabs(v) < 1e-9 * step ? 0 : v);
	}
	fprintf(out, "<text x=\"%g\" y=\"%g\" text-anchor=\"middle\" font-size=\"13\" font-weight=\"bold\">", f->x0 + f->width / 2,
	        f->y0 - 10);
	text(out, p->title);
	fprintf(out, "</text>\n<text x=\"%g\" y=\"%g\" text-anchor=\"middle\">", f->x0 + f->width / 2, f->y0 + f->height + 33);
	text(out, p->x_label);
	fprintf(out, "</text>\n<text transform=\"translate(%g %g) rotate(-90)\" text-anchor=\"middle\">", f->x0 - 44,
	        f->y0 + f->height / 2);
	text(out, p->y_label);
	fputs("</text>\n", out);
}

static void band(FILE *out, const struct frame *f, const struct chart_series *s)
{
	for (int i = 0; i + 1 < s->n; i++) {
		double x0 = place_x(f, s->x[i]), x1 = place_x(f, s->x[i + 1]);
		double y[4] = { place_y(f, s->y[i] - s->sigma[i]), place_y(f, s->y[i + 1] - s->sigma[i + 1]),
			            place_y(f, s->y[i + 1] + s->sigma[i + 1]), place_y(f, s->y[i] + s->sigma[i]) };
		if (isfinite(x0 + x1 + y[0] + y[1] + y[2] + y[3]))
			fprintf(out, "<path d=\"M%.1f %.1fL%.1f %.1fL%.1f %.1fL%.1f %.1fz\" fill=\"%s\" fill-opacity=\"0.15\"/>\n", x0,
			        y[0], x1, y[1], x1, y[2], x0, y[3], s->colour);
	}
}

static void line(FILE *out, const struct frame *f, const struct chart_series *s)
{
	bool pen = false;
	for (int i = 0; i < s->n && s->dots; i++)
		if (isfinite(s->x[i] + s->y[i]))
			fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.4\" fill=\"%s\"/>\n", place_x(f, s->x[i]), place_y(f, s->y[i]),
			        s->colour);
	if (s->no_line)
		return;
	fputs("<path d=\"", out);
	for (int i = 0; i < s->n; i++) {
		if (!isfinite(s->x[i]) || !isfinite(s->y[i])) {
			pen = false;
			continue;
		}
		fprintf(out, "%c%.1f %.1f", pen ? 'L' : 'M', place_x(f, s->x[i]), place_y(f, s->y[i]));
		pen = true;
	}
	fprintf(out, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" stroke-linejoin=\"round\"", s->colour);
	if (s->dash)
		fprintf(out, " stroke-dasharray=\"%s\"", s->dash);
	fputs("/>\n", out);
}

/* In the upper right corner, one line a series. */
static void legend(FILE *out, const struct frame *f, const struct chart_panel *p)
{
	int row = 0, rows = 0, longest = 0;
	for (int i = 0; i < p->n; i++) {
		int length = p->series[i].name ? (int)strlen(p->series[i].name) : 0;
		rows += length > 0;
		longest = length > longest ? length : longest;
	}
	fprintf(out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"#fff\" fill-opacity=\"0.75\"/>",
	        f->x0 + f->width - 42 - 6.0 * longest, f->y0 + 3, 40 + 6.0 * longest, 15 * rows + 3);
	for (int i = 0; i < p->n; i++) {
		const struct chart_series *s = &p->series[i];
		if (!s->name)
			continue;
		double x = f->x0 + f->width - 8, y = f->y0 + 16 + 15 * row++;
		fprintf(out, "<path d=\"M%.1f %.1fh22\" stroke=\"%s\" stroke-width=\"2\"%s%s%s/>", x - 22, y - 4, s->colour,
		        s->dash ? " stroke-dasharray=\"" : "", s->dash ? s->dash : "", s->dash ? "\"" : "");
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", x - 28, y);
		text(out, s->name);
		fputs("</text>\n", out);
	}
}

static void panel(FILE *out, int index, double x, double y, int width, int height, const struct chart_panel *p)
{
	struct frame f = { .x0 = x + LEFT, .y0 = y + TOP, .width = width - LEFT - RIGHT, .height = height - TOP - BOTTOM };
	limits(&f, p);
	axes(out, &f, p);
	fprintf(out, "<clipPath id=\"panel%d\"><rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"/></clipPath>\n", index, f.x0, f.y0,
	        f.width, f.height);
	fprintf(out, "<g clip-path=\"url(#panel%d)\">\n", index);
	for (int s = 0; s < p->n; s++)
		if (p->series[s].sigma)
			band(out, &f, &p->series[s]);
	for (int s = 0; s < p->n; s++)
		line(out, &f, &p->series[s]);
	fputs("</g>\n", out);
	legend(out, &f, p);
}

bool chart_save(const char *path, int columns, int width, int height, int n, const struct chart_panel panels[],
                const char *made_by, struct err *err)
{
	char *svg = 0;
	size_t size = 0;
	FILE *out = open_memstream(&svg, &size);
	int rows = (n + columns - 1) / columns, w = columns * width, h = rows * height;
	fprintf(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
	        "font-size=\"11\">\n", w, h, w, h);
	if (made_by) {
		fputs("<metadata>", out);
		text(out, made_by);
		fputs("</metadata>\n", out);
	}
	fprintf(out, "<rect width=\"%d\" height=\"%d\" fill=\"#fafafa\"/>\n", w, h);
	for (int i = 0; i < n; i++)
		panel(out, i, i % columns * width, i / columns * height, width, height, &panels[i]);
	fputs("</svg>\n", out);
	bool ok = !fclose(out) && file_write(path, svg, size, err);
	free(svg);
	return ok;
}
