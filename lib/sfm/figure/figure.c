#include "sfm/figure/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_draw.h"
#include "bridge/om_mesh.h"
#include "image/picture.h"
#include "math/stats.h"
#include "math/vec.h"
#include "sfm/figure/figure_mesh.h"
#include "sfm/subject.h"

enum { PANEL = 560, TITLE = 36, BARS = 240, WORST = 4, MESH_LIMIT = 20000000 };
enum { MESH_TOP = TITLE + PANEL, BARS_TOP = MESH_TOP + TITLE + PANEL, WIDTH = 2 * PANEL, HEIGHT = BARS_TOP + BARS };
static const uint8_t ink[3] = { 40, 44, 52 }, faint[3] = { 205, 208, 214 };

/* Residual to colour: green at the least, red at three times the median. */
static void heat(uint8_t rgb[3], double residual, double typical)
{
	double t = fmin(1, fmax(0, residual / typical / 3));
	rgb[0] = (uint8_t)(40 + 190 * t);
	rgb[1] = (uint8_t)(150 - 90 * t);
	rgb[2] = (uint8_t)(90 - 30 * t);
}

/* An orthographic view along -axis: head frame, mm, to px of a panel. */
struct look {
	double right[3], up[3], scale;
	double x0, y0;
};

static void at(float out[2], const struct look *l, const double p[3])
{
	out[0] = (float)(l->x0 + l->scale * vec_dot(l->right, p));
	out[1] = (float)(l->y0 - l->scale * vec_dot(l->up, p));
}

static void draw_points(struct cv_picture *pic, const struct head *head, const struct look *l, int x_low, int x_high)
{
	for (int i = 0; i < head->model->n_points; i++) {
		double p[3];
		float xy[2];
		sfm_to_head(p, &head->frame, head->model->points[i].xyz);
		at(xy, l, p);
		int x = (int)xy[0], y = (int)xy[1];
		if (x < x_low || x >= x_high || y < TITLE || y >= MESH_TOP)
			continue;
		for (int c = 0; c < 3; c++)
			pic->px[3 * ((long)y * pic->width + x) + c] = (uint8_t)(head->model->points[i].rgb[c] * 0.7);
	}
}

static void centre_of(double centre[3], const struct rig_camera *c)
{
	double R[3][3], t[3];
	for (int i = 0; i < 3; i++) {
		memcpy(R[i], c->cam_from_head[i], sizeof R[i]);
		t[i] = -c->cam_from_head[i][3];
	}
	mat_tvec(centre, R, t);
}

/* The four rays of a picture's corners, as long as `reach` mm. */
static void draw_camera(struct cv_picture *pic, const struct rig_camera *c, const struct look *l, double reach,
                        const uint8_t colour[3])
{
	double centre[3], corner[4][3], R[3][3];
	float from[2], to[4][2];
	for (int i = 0; i < 3; i++)
		memcpy(R[i], c->cam_from_head[i], sizeof R[i]);
	centre_of(centre, c);
	at(from, l, centre);
	for (int k = 0; k < 4; k++) {
		double px[2] = { k == 1 || k == 2 ? c->width : 0, k >= 2 ? c->height : 0 };
		double ray[3] = { (px[0] - c->camera.center_px[0]) / c->focal[0], (px[1] - c->camera.center_px[1]) / c->focal[1], 1 };
		mat_tvec(corner[k], R, ray);
		vec_add(corner[k], centre, reach, corner[k]);
		at(to[k], l, corner[k]);
		float line[2][2] = { { from[0], from[1] }, { to[k][0], to[k][1] } };
		cv_draw_line(pic, 2, (const float (*)[2])line, false, 1, colour);
	}
	cv_draw_line(pic, 4, (const float (*)[2])to, true, 1, colour);
}

/* Half the side of the box round cameras and head, mm, and its middle. */
static double box(double middle[3], const struct camera_rig *rig)
{
	double half = 1;
	for (int k = 0; k < 3; k++) {
		double low = 0, high = 0, centre[3];
		for (int i = 0; i < rig->n; i++) {
			centre_of(centre, &rig->cameras[i]);
			low = fmin(low, centre[k]);
			high = fmax(high, centre[k]);
		}
		middle[k] = 0.5 * (low + high);
		half = fmax(half, 0.5 * (high - low));
	}
	return half;
}

static void draw_rig(struct cv_picture *pic, const struct head *head, const struct camera_rig *rig, double typical)
{
	double middle[3], half = box(middle, rig), frustum = 0.14 * half, scale = 0.48 * PANEL / (half + frustum);
	const double y = TITLE + 0.5 * PANEL, x = 0.5 * PANEL - scale * middle[0];
	const struct look looks[2] = { { { 1, 0, 0 }, { 0, 1, 0 }, scale, x, y + scale * middle[1] },
		                           { { 1, 0, 0 }, { 0, 0, -1 }, scale, PANEL + x, y - scale * middle[2] } };
	static const char *const titles[] = { "cameras and points from the front", "from above" };
	for (int k = 0; k < 2; k++) {
		draw_points(pic, head, &looks[k], k * PANEL, (k + 1) * PANEL);
		for (int i = 0; i < rig->n; i++) {
			uint8_t colour[3];
			heat(colour, rig->cameras[i].residual_px, typical);
			draw_camera(pic, &rig->cameras[i], &looks[k], frustum, colour);
		}
		cv_draw_text(pic, k * PANEL + 12, 24, 11, titles[k], ink);
	}
}

/* Names and residuals of the pictures that fit worst. free(). */
static char *worst_of(const struct camera_rig *rig)
{
	char *text = mem_str("worst:");
	double below = INFINITY;
	for (int k = 0; k < WORST && k < rig->n; k++) {
		int at = -1;
		for (int i = 0; i < rig->n; i++)
			if (rig->cameras[i].residual_px < below && (at < 0 || rig->cameras[i].residual_px > rig->cameras[at].residual_px))
				at = i;
		if (at < 0)
			break;
		below = rig->cameras[at].residual_px;
		char *longer = mem_printf("%s%s %.60s %.2f", text, k ? "," : "", rig->cameras[at].name, below);
		free(text);
		text = longer;
	}
	return text;
}

static void draw_bars(struct cv_picture *pic, const struct camera_rig *rig, double typical)
{
	const int left = 60, top = BARS_TOP + 44, bottom = HEIGHT - 40;
	char text[80], *worst = worst_of(rig);
	double most = typical;
	for (int i = 0; i < rig->n; i++)
		most = fmax(most, rig->cameras[i].residual_px);
	snprintf(text, sizeof text, "residual of each picture, px (middle %.2f)", typical);
	cv_draw_text(pic, left, top - 16, 11, text, ink);
	for (int i = 0; i < rig->n; i++) {
		uint8_t colour[3];
		const double pitch = (double)(WIDTH - left - 20) / rig->n;
		int x0 = left + (int)(i * pitch), x1 = left + (int)fmax(i * pitch + 1, (i + 0.8) * pitch);
		int y0 = bottom - (int)((bottom - top) * fmin(1, rig->cameras[i].residual_px / most));
		heat(colour, rig->cameras[i].residual_px, typical);
		for (int y = y0; y < bottom; y++)
			for (int x = x0; x < x1; x++)
				memcpy(pic->px + 3 * ((long)y * pic->width + x), colour, 3);
	}
	float base[2][2] = { { (float)left, (float)bottom }, { (float)(WIDTH - 20), (float)bottom } };
	cv_draw_line(pic, 2, (const float (*)[2])base, false, 1, faint);
	snprintf(text, sizeof text, "%.2f", most);
	cv_draw_text(pic, 12, top + 10, 10, text, ink);
	cv_draw_text(pic, left, HEIGHT - 14, 10, worst, ink);
	free(worst);
}

bool figure_draw(const struct head *head, const struct camera_rig *rig, struct stage *stage, struct err *err)
{
	struct cv_picture pic = { mem_array((size_t)WIDTH * HEIGHT * 3, 1), WIDTH, HEIGHT, 3 };
	double *r = mem_array((size_t)rig->n + 1, sizeof *r);
	struct mesh mesh = { 0 };
	const char *subject = stage_path(stage, SUBJECT);
	memset(pic.px, 255, (size_t)WIDTH * HEIGHT * 3);
	for (int i = 0; i < rig->n; i++)
		r[i] = rig->cameras[i].residual_px;
	double typical = fmax(1e-3, stats_median(rig->n, r));
	draw_rig(&pic, head, rig, typical);
	draw_bars(&pic, rig, typical);
	bool ok = !file_exists(subject) || om_mesh_load(&mesh, subject, MESH_LIMIT, err);
	if (ok && mesh.n_faces) {
		figure_mesh(&pic, 0, MESH_TOP + TITLE, PANEL, &mesh, 0);
		figure_mesh(&pic, PANEL, MESH_TOP + TITLE, PANEL, &mesh, 0.9);
		cv_draw_text(&pic, 12, MESH_TOP + 24, 11, "subject.ply from the front, and turned", ink);
	}
	ok = ok && picture_png_write(stage_path(stage, FIGURE), pic.px, WIDTH, HEIGHT, 3, err);
	mesh_free(&mesh);
	free(pic.px);
	free(r);
	return ok;
}
