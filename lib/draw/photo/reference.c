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

double shot_limbus_width(const struct shot *reference)
{
	// A smooth step of width w has the spread 0.22 w of its slope.
	double mm = reference->fit.cam_from_eye[2][3] / reference->fit.camera.focal_px;
	double width = mm * reference->fit.edge_sigma_px / 0.2236;
	return isfinite(width) ? fmin(fmax(width, 0.2), 1.2) : 0.4;
}
