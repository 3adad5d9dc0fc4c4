#include "iris/unrefract/haze.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"

static const double usual = 4;     // the sclera's light over the iris'
static const double beside = 0.7;  // of the way from pupil to limbus: iris that no limbus of a usable photograph reaches
static const double most = 0.25;   // of the limbus' radius: more is no blur but another edge
static const double strays = 6;    // sigmas of the step: light strays no farther
static const double soft = 0.1;    // mm, sigma of the step: people's are 0.1 to 0.3; beside sharper ones what grows brighter is the iris
static const double rises = 3;     // limbus_haze that many times over: a rise towards the limbus that counts

/* The iris' typical light over its radius, by channel; NAN where none was seen. */
static void profile(struct rings out[3], const struct unrefract_view *view, const struct sheet *sheet)
{
	const struct unrefract_survey *s = &view->survey;
	size_t n = (size_t)s->size * (size_t)s->size;
	float *plane = mem_array(n, sizeof *plane);
	for (size_t c = 0; c < 3; c++) {
		for (size_t i = 0; i < n; i++)
			plane[i] = s->rgb[3 * i + c];
		out[c] = rings_of(plane, s->weight, sheet, false, 0);
	}
	free(plane);
}

/* Sigma of the step and its place, mm. */
static double sigma_of(const struct unrefract_view *view)
{
	return hypot(view->fit->edge_sigma_px, fmax(view->fit->ellipse_sigma[2], 0)) / iris_view_px_per_mm(&view->iris);
}

/* How far the blurred step reaches. */
static double by_step(const struct rings rings[3], const struct unrefract_view *view, const struct unrefract_conf *conf)
{
	double ratio = view->white.found ? 0 : usual;
	for (int c = 0; c < 3 && view->white.found; c++) {
		const double own = rings_median(&rings[c], beside);
		ratio = own > 0 ? fmax(ratio, view->white.sclera[c] / own) : ratio;
	}
	return -sigma_of(view) * stats_normal_score(fmin(conf->haze / fmax(ratio, 1e-6), 0.5));
}

static double from_limbus(int ring, const struct sheet *sheet)
{
	return (1 - (ring + 0.5) / SHEET_RINGS) * (sheet->limbus - sheet->pupil.r);
}

/* Whether every channel is brighter than `share` over its darkest ring. */
static bool brighter(const struct rings rings[3], const double darkest[3], int ring, double share)
{
	for (int c = 0; c < 3; c++)
		if (!(rings[c].median[ring] > (1 + share) * darkest[c]))
			return false;
	return true;
}

/* Light that strays farther than a normal distribution's, in the limbus' tissue and the lens: irises grow darker towards their root, so that what
 * grows brighter in every colour, up to where the step's reach begins, is the sclera's. 0: none does. */
static double by_rise(const struct rings rings[3], const struct sheet *sheet, double step, double farthest, const struct unrefract_conf *conf)
{
	double darkest[3] = { INFINITY, INFINITY, INFINITY };
	int outer = SHEET_RINGS - 1, inner = outer;
	while (outer > 0 && from_limbus(outer, sheet) < step)
		outer--;
	for (int i = outer; i >= 0 && from_limbus(i, sheet) < farthest; i--) {
		inner = i;
		for (int c = 0; c < 3; c++)
			darkest[c] = fmin(darkest[c], rings[c].median[i]);
	}
	if (!brighter(rings, darkest, outer, rises * conf->haze))
		return 0;
	int i = outer;
	while (i > inner && brighter(rings, darkest, i, conf->haze))
		i--;
	return from_limbus(i, sheet);
}

double unrefract_haze(const struct unrefract_view *view, const struct sheet *sheet, const struct unrefract_conf *conf)
{
	struct rings rings[3];
	profile(rings, view, sheet);
	const double step = by_step(rings, view, conf), farthest = fmin(most * sheet->limbus, strays * sigma_of(view));
	const bool is_soft = view->fit->edge_sigma_px / iris_view_px_per_mm(&view->iris) > soft;
	return fmin(fmax(step, is_soft ? by_rise(rings, sheet, step, farthest, conf) : 0), most * sheet->limbus);
}
