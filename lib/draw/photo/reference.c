#include "draw/photo/reference.h"

#include <math.h>

void shot_window(struct shot *shot, int most_px)
{
	const struct ellipse *e = &shot->fit.limbus;
	double reach = 2.2 * e->a, at[2] = { e->cx, e->cy }, size[2] = { shot->fit.width, shot->fit.height };
	for (int i = 0; i < 2; i++) {
		shot->window[i] = floor(fmax(at[i] - reach, 0));
		shot->window[2 + i] = ceil(fmin(at[i] + reach, size[i]));
	}
	double longest = fmax(shot->window[2] - shot->window[0], shot->window[3] - shot->window[1]);
	shot->scale = fmax(longest / most_px, 1);
}

double shot_merit(const struct fit *fit)
{
	return fit->limbus.a * fit->coverage * cos(fit->theta) * cos(fit->theta);
}

/* Share of the limbus that is seen in the direction of a point of the sclera. */
static double seen_towards(const struct fit *fit, const double point[3])
{
	double px[2];
	if (!fit_project(px, fit, point))
		return 0;
	double turn = atan2(px[1] - fit->limbus.cy, px[0] - fit->limbus.cx) / (2 * M_PI);
	if (!isfinite(turn))
		return 0;
	return fit->seen[(int)floor((turn - floor(turn)) * FIT_SECTORS) % FIT_SECTORS];
}

void shot_unlight(double rgb[3], const struct shot *shot, const struct eye *eye, double sclera_radius)
{
	enum { TURNS = 72 };
	double mean[3] = { 0 }, weight = 0, polar = asin(1.35 * eye->limbus_radius / sclera_radius);
	const double middle = eye_limbus_depth(eye) + sqrt(sclera_radius * sclera_radius - eye->limbus_radius * eye->limbus_radius);
	for (int k = 0; k < TURNS; k++) {
		double turn = 2 * M_PI * k / TURNS, n[3] = { sin(polar) * cos(turn), sin(polar) * sin(turn), -cos(polar) };
		double point[3] = { sclera_radius * n[0], sclera_radius * n[1], middle + sclera_radius * n[2] }, seen = 0.01 + seen_towards(&shot->fit, point);
		float cam[3], light[3];
		for (int i = 0; i < 3; i++)
			cam[i] = (float)(shot->fit.cam_from_eye[i][0] * n[0] + shot->fit.cam_from_eye[i][1] * n[1]
			                 + shot->fit.cam_from_eye[i][2] * n[2]);
		envmap_wet(light, &shot->env, cam);
		for (int c = 0; c < 3; c++)
			mean[c] += seen * (double)light[c];
		weight += seen;
	}
	double most = 0.95;  // of any channel; its hue is kept
	for (int c = 0; c < 3; c++) {
		rgb[c] /= fmax(mean[c] / weight, 0.3);
		most = fmax(most, rgb[c]);
	}
	for (int c = 0; c < 3; c++)
		rgb[c] *= 0.95 / most;
}

double shot_limbus_width(const struct shot *reference)
{
	// A smooth step of width w has the spread 0.22 w of its slope.
	double mm = reference->fit.cam_from_eye[2][3] / reference->fit.camera.focal_px;
	double width = mm * reference->fit.edge_sigma_px / 0.2236;
	return isfinite(width) ? fmin(fmax(width, 0.2), 1.2) : 0.4;
}
