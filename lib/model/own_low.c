#include "model/own_low.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/model.h"

/* Pixel of a point of the head. False behind the camera. */
static bool project(double px[2], const struct skin_camera *c, const double x[3])
{
	double cam[3];
	for (int i = 0; i < 3; i++)
		cam[i] = c->cam_from_head[i][0] * x[0] + c->cam_from_head[i][1] * x[1] + c->cam_from_head[i][2] * x[2] + c->cam_from_head[i][3];
	if (!(cam[2] > 0 && c->focal_px > 0))
		return false;
	// A lens bends both alike: an iris and the margin before it.
	for (int k = 0; k < 2; k++)
		px[k] = c->center_px[k] + c->focal_px * cam[k] / cam[2];
	return true;
}

/* Height of a margin's curve at x; NAN beside it. */
static double height_at(const double *lid, int n, double x)
{
	for (int i = 0; i + 1 < n; i++) {
		const double a = lid[2 * i], b = lid[2 * i + 2];
		if ((a <= x && x < b) || (b < x && x <= a))
			return lid[2 * i + 1] + (x - a) / (b - a) * (lid[2 * i + 3] - lid[2 * i + 1]);
	}
	return NAN;
}

/* Controls of both eyes that look so, lids as they mostly are then. g: of the model's inputs, out. */
static void look(double *g, const struct skin_model *model, double h, double v)
{
	memset(g, 0, (size_t)model->n_inputs * sizeof *g);
	for (int eye = 0; eye < 2; eye++) {
		double lid[2] = { 0 }, gaze[3] = { h, v, 0 };
		known_hold(gaze, &model->known, eye);
		skin_model_baseline(lid, model, eye, 1, h, v);
		g[5 * eye] = gaze[0];
		g[5 * eye + 1] = gaze[1];
		for (int l = 0; l < 2; l++)
			g[5 * eye + 3 + l] = isfinite(lid[l]) ? lid[l] : 0;
	}
	skin_model_inputs(g, model, g);
}

/* Share of the limbus' disc, of an eye that looks so, below the margin. NAN: not known. */
static double share_of(const struct skin_model *model, const double *lower, int side, double h, double v)
{
	enum { RINGS = 12, TURNS = 60 };
	static const double degree = M_PI / 180;
	const struct skin_eyes *e = &model->eyes;
	const double radius = e->limbus[side], plane = sqrt(fmax(e->radius[side] * e->radius[side] - radius * radius, 0));
	// Columns of Ry(h) Rx(-v): x, y and out of the eye.
	const double axes[3][3] = { { cos(h * degree), 0, -sin(h * degree) },
		                        { -sin(h * degree) * sin(v * degree), cos(v * degree), -cos(h * degree) * sin(v * degree) },
		                        { sin(h * degree) * cos(v * degree), sin(v * degree), cos(h * degree) * cos(v * degree) } };
	double under = 0, all = 0;
	for (int ring = 0; ring < RINGS; ring++)
		for (int k = 0; k < TURNS; k++) {
			const double r = radius * (ring + 0.5) / RINGS, x = r * cos(2 * M_PI * (k + 0.5) / TURNS), y = r * sin(2 * M_PI * (k + 0.5) / TURNS);
			double at[3], px[2];
			for (int j = 0; j < 3; j++)
				at[j] = e->center[side][j] + x * axes[0][j] + y * axes[1][j] + plane * axes[2][j];
			if (!project(px, &model->camera, at))
				return NAN;
			const double margin = height_at(lower, model->n_points, px[0]);
			under += px[1] > margin ? r : 0;
			all += r;
		}
	return under / all;
}

struct own_low own_low_of(const struct skin_model *model)
{
	struct own_low out;
	double *g = mem_new((size_t)model->n_inputs + 1, sizeof *g), *lids = mem_new((size_t)model->n_lid + 1, sizeof *lids);
	for (int i = 0; i < OWN_LOW_V; i++)
		for (int k = 0; k < OWN_LOW_H; k++) {
			const double h = OWN_LOW_STEP_H * (k - OWN_LOW_H / 2), v = -OWN_LOW_STEP_V * i;
			look(g, model, h, v);
			skin_model_lids(lids, model, g);
			for (int side = 0; side < 2; side++) {
				const double *lower = lids + (size_t)(2 * side + 1) * (size_t)model->n_points * 2, share = isfinite(model->eyes.limbus[side] + lower[0]) ? share_of(model, lower, side, h, v) : NAN;
				out.share[side][i][k] = isfinite(share) ? (float)share : 1;
			}
		}
	free(g);
	free(lids);
	return out;
}

double own_low_at(const struct own_low *low, int side, double h, double v)
{
	const double x = fmin(fmax(h / OWN_LOW_STEP_H + OWN_LOW_H / 2, 0), OWN_LOW_H - 1.0001), y = fmin(fmax(-v / OWN_LOW_STEP_V, 0), OWN_LOW_V - 1.0001);
	const int i = (int)y, k = (int)x;
	double out = 0;
	for (int j = 0; j < 4; j++) {
		const double w = (j % 2 ? x - k : 1 - x + k) * (j / 2 ? y - i : 1 - y + i);
		if (w > 0)
			out += w * (double)low->share[side][i + j / 2][k + j % 2];
	}
	return out;
}
