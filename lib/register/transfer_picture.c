#include "register/transfer_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_draw.h"
#include "image/image.h"
#include "image/picture.h"
#include "register/transfer_quality.h"

enum { PANELS = 3, HIGH = 620, FINE = 2, HEAD = 34, FOOT = 46, GAP = 12 };

/* The foremost face in a pixel of the fine grid; -1: none. */
struct seen {
	float z;
	int32_t face;
	float b, c;  // weights of its second and third corner
};

struct view {
	double left, top, step;  // mm; of a fine pixel
	int width, height;       // fine pixels
};

/* A view that the subject fills, with a border. */
static struct view view_of(const struct mesh *subject)
{
	double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
	for (int i = 0; i < subject->n_vertices; i++)
		for (int k = 0; k < 2; k++) {
			lo[k] = fmin(lo[k], (double)subject->vertices[i][k]);
			hi[k] = fmax(hi[k], (double)subject->vertices[i][k]);
		}
	double wide = fmax(hi[0] - lo[0], 1e-6), high = fmax(hi[1] - lo[1], fmax(wide / 2, 1e-6)), border = 0.06 * fmax(wide, high);
	struct view v = { .step = (high + 2 * border) / (FINE * HIGH), .height = FINE * HIGH };
	v.width = FINE * (int)ceil((wide + 2 * border) / v.step / FINE);
	v.left = lo[0] - border;
	v.top = (lo[1] + hi[1] + high) / 2 + border;
	return v;
}

/* Rasterises a triangle with a depth buffer. */
static void fill(struct seen *seen, const struct view *view, const float *p[3], int32_t face)
{
	double x[3], y[3];
	for (int k = 0; k < 3; k++) {
		x[k] = ((double)p[k][0] - view->left) / view->step - 0.5;
		y[k] = (view->top - (double)p[k][1]) / view->step - 0.5;
	}
	double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
	int x0 = (int)fmax(ceil(fmin(x[0], fmin(x[1], x[2]))), 0), x1 = (int)fmin(floor(fmax(x[0], fmax(x[1], x[2]))), view->width - 1);
	int y0 = (int)fmax(ceil(fmin(y[0], fmin(y[1], y[2]))), 0), y1 = (int)fmin(floor(fmax(y[0], fmax(y[1], y[2]))), view->height - 1);
	if (!(fabs(area) > 1e-9))
		return;
	for (int j = y0; j <= y1; j++)
		for (int i = x0; i <= x1; i++) {
			double b = ((i - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (j - y[0])) / area;
			double c = ((x[1] - x[0]) * (j - y[0]) - (i - x[0]) * (y[1] - y[0])) / area;
			double z = (1 - b - c) * (double)p[0][2] + b * (double)p[1][2] + c * (double)p[2][2];
			struct seen *s = &seen[(size_t)j * (size_t)view->width + (size_t)i];
			if (b >= 0 && c >= 0 && b + c <= 1 && (s->face < 0 || z > (double)s->z))
				*s = (struct seen){ (float)z, face, (float)b, (float)c };
		}
}

static struct seen *look(const struct view *view, const float (*vertices)[3], const struct mesh *faces)
{
	size_t n = (size_t)view->width * (size_t)view->height;
	struct seen *seen = mem_array(n, sizeof *seen);
	for (size_t i = 0; i < n; i++)
		seen[i] = (struct seen){ .face = -1 };
	for (int32_t f = 0; f < faces->n_faces; f++) {
		const int32_t *v = faces->faces[f];
		fill(seen, view, (const float *[]){ vertices[v[0]], vertices[v[1]], vertices[v[2]] }, f);
	}
	return seen;
}

/* Interpolates between a face's corners. */
static double mixed(const struct seen *s, double a, double b, double c)
{
	return (1 - (double)s->b - (double)s->c) * a + (double)s->b * b + (double)s->c * c;
}

/* Shading: light from the camera, and a little ambient light. */
static double light_on(const struct seen *s, const int32_t v[3], const float (*normal)[3])
{
	double n[3], len2 = 0;
	for (int k = 0; k < 3; k++) {
		n[k] = mixed(s, (double)normal[v[0]][k], (double)normal[v[1]][k], (double)normal[v[2]][k]);
		len2 += n[k] * n[k];
	}
	return 0.2 + 0.8 * (len2 > 0 ? fabs(n[2]) / sqrt(len2) : 1);
}

/* Colour scale: blue, green, yellow, red for x from 0 to 1. Linear values. */
static void spectrum(float out[3], double x)
{
	static const float stops[5][3] = { { 0.03f, 0.08f, 0.4f }, { 0.02f, 0.4f, 0.55f }, { 0.15f, 0.6f, 0.12f }, { 0.85f, 0.65f, 0.05f }, { 0.7f, 0.04f, 0.03f } };
	double at = fmin(fmax(x, 0), 1) * 4;
	int i = (int)fmin(at, 3);
	for (int k = 0; k < 3; k++)
		out[k] = stops[i][k] + (float)(at - i) * (stops[i + 1][k] - stops[i][k]);
}

struct scene {
	const struct transfer *transfer;
	const struct mesh *target, *subject;
	struct view view;
	struct seen *seen[2];         // of the subject, of the character
	float (*normal[2])[3];
	double most;                  // mm at the end of the colour scale
};

static const float skin[3] = { 0.55f, 0.5f, 0.46f }, blue[3] = { 0.1f, 0.3f, 0.7f }, orange[3] = { 0.85f, 0.35f, 0.06f };

/* Adds a fine pixel's share of colour, none where no surface is seen. */
static void add_pixel(float sum[3], const struct scene *s, int panel, size_t at)
{
	const struct seen *of[2] = { &s->seen[0][at], &s->seen[1][at] };
	int which = panel < 2 ? panel : of[1]->face >= 0 && (of[0]->face < 0 || of[1]->z > of[0]->z);
	const struct seen *p = of[which];
	if (p->face < 0)
		return;
	const int32_t *v = (which ? s->target : s->subject)->faces[p->face];
	const struct transfer *t = s->transfer;
	float colour[3];
	memcpy(colour, panel == 0 ? skin : panel == 1 ? skin : which ? orange : blue, sizeof colour);
	if (panel == 1 && mixed(p, (double)t->confidence[v[0]], (double)t->confidence[v[1]], (double)t->confidence[v[2]]) > 0.2)
		spectrum(colour, mixed(p, (double)t->distance[v[0]], (double)t->distance[v[1]], (double)t->distance[v[2]]) / s->most);
	double light = light_on(p, v, (const float(*)[3])s->normal[which]);
	for (int k = 0; k < 3; k++)
		sum[k] += (float)light * colour[k] / (FINE * FINE);
}

static void draw_panel(struct image *out, const struct scene *s, int panel, int x0)
{
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < s->view.width / FINE; x++)
			for (int i = 0; i < FINE * FINE; i++)
				add_pixel(image_at(out, x0 + x, HEAD + y), s, panel,
				          (size_t)(FINE * y + i / FINE) * (size_t)s->view.width + (size_t)(FINE * x + i % FINE));
}

static void draw_words(struct cv_picture *pic, const struct scene *s, int wide)
{
	static const char *const titles[PANELS] = { "the subject", "the character laid onto it", "subject blue, character orange" };
	static const uint8_t white[3] = { 230, 230, 230 };
	char text[64];
	for (int i = 0; i < PANELS; i++)
		cv_draw_text(pic, i * (wide + GAP) + 8, HEAD - 12, 12, titles[i], white);
	double x = wide + GAP + 8, y = HEAD + HIGH + FOOT - 10;
	double after = x + cv_draw_text(pic, x, y, 10, "0 mm", white) + 8;
	for (int i = 0; i < 160; i++) {
		float colour[3];
		uint8_t px[3];
		spectrum(colour, i / 159.0);
		for (int k = 0; k < 3; k++)
			px[k] = (uint8_t)lroundf(255 * srgb_from_linear(colour[k]));
		cv_draw_line(pic, 2, (const float[][2]){ { (float)after + (float)i, (float)y - 10 }, { (float)after + (float)i, (float)y } }, false, 1, px);
	}
	snprintf(text, sizeof text, "%g mm from it", s->most);
	double end = after + 168 + cv_draw_text(pic, after + 168, y, 10, text, white);
	if (end + 150 < 2 * wide + GAP)
		cv_draw_text(pic, end + 16, y, 10, "plain: not matched", white);
}

/* End of the colour scale, mm: the first round number above the distance of 95 % of the trusted vertices. */
static double scale_of(const struct transfer *t)
{
	static const double usual[] = { 0.2, 0.5, 1, 2, 5, 10, 20, 50 };
	double most = transfer_trusted(t) ? transfer_distance(t, 0.95) : 0;
	int i = 0;
	while (i < COUNT(usual) - 1 && usual[i] < most)
		i++;
	return usual[i];
}

bool transfer_save_picture(const struct transfer *t, const struct mesh *target, const struct mesh *subject, const char *path, struct err *err)
{
	struct mesh registered = { target->n_vertices, target->n_faces, t->registered, target->faces, 0 };
	struct scene s = { .transfer = t, .target = target, .subject = subject, .view = view_of(subject), .most = scale_of(t) };
	s.seen[0] = look(&s.view, (const float(*)[3])subject->vertices, subject);
	s.seen[1] = look(&s.view, (const float(*)[3])t->registered, target);
	s.normal[0] = mesh_normals(subject);
	s.normal[1] = mesh_normals(&registered);
	int wide = s.view.width / FINE;
	struct image picture = image_new(PANELS * wide + (PANELS - 1) * GAP, HEAD + HIGH + FOOT, 3);
	for (size_t i = 0; i < 3 * (size_t)picture.width * (size_t)picture.height; i++)
		picture.px[i] = 0.012f;
	for (int i = 0; i < PANELS; i++)
		draw_panel(&picture, &s, i, i * (wide + GAP));
	uint8_t *px = image_to_srgb8(&picture);
	struct cv_picture pic = { px, picture.width, picture.height, 3 };
	draw_words(&pic, &s, wide);
	bool ok = picture_png_write(path, px, picture.width, picture.height, 3, err);
	for (int i = 0; i < 2; i++) {
		free(s.seen[i]);
		free(s.normal[i]);
	}
	free(px);
	image_free(&picture);
	return ok;
}
