#include "iris/unrefract/haze.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static const double usual = 4;     // the sclera's light over the iris'
static const double beside = 0.7;  // of the way from pupil to limbus: iris that no limbus of a usable photograph reaches
static const double most = 0.25;   // of the limbus' radius: more is no blur but another edge

/* The iris' typical light in a channel; NAN where none was seen. */
static double light_of(const struct unrefract_view *view, const struct sheet *sheet, int channel)
{
	const struct unrefract_survey *s = &view->survey;
	size_t n = (size_t)s->size * (size_t)s->size;
	float *plane = mem_array(n, sizeof *plane);
	for (size_t i = 0; i < n; i++)
		plane[i] = s->rgb[3 * i + (size_t)channel];
	const struct rings rings = rings_of(plane, s->weight, sheet, false, 0);
	free(plane);
	return rings_median(&rings, beside);
}

/* z with Phi(-z) = p. */
static double upper_quantile(double p)
{
	double low = 0, high = 8;
	for (int i = 0; i < 40; i++) {
		const double at = (low + high) / 2;
		*(erfc(at / M_SQRT2) / 2 < p ? &high : &low) = at;
	}
	return high;
}

double unrefract_haze(const struct unrefract_view *view, const struct sheet *sheet, const struct unrefract_conf *conf)
{
	const struct fit *fit = view->fit;
	double ratio = view->white.found ? 0 : usual;
	for (int c = 0; c < 3 && view->white.found; c++) {
		const double own = light_of(view, sheet, c);
		ratio = own > 0 ? fmax(ratio, view->white.sclera[c] / own) : ratio;
	}
	const double place = fmax(fit->ellipse_sigma[2], 0), sigma = hypot(fit->edge_sigma_px, place) / iris_view_px_per_mm(&view->iris);
	return fmin(sigma * upper_quantile(fmin(conf->haze / fmax(ratio, 1e-6), 0.5)), most * sheet->limbus);
}
