#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "iris/unrefract/mask.h"
#include "iris/unrefract/sample.h"

enum { MARGIN_POINTS = 72 };

/* Least-squares circle through points (Kasa): x² + y² = 2 cx x + 2 cy y + k, solved about the mean. */
static struct circle circle_fit(int n, const double p[][2])
{
	double mx = 0, my = 0, xx = 0, xy = 0, yy = 0, xr = 0, yr = 0, rr = 0;
	for (int i = 0; i < n; i++) {
		mx += p[i][0] / n;
		my += p[i][1] / n;
	}
	for (int i = 0; i < n; i++) {
		double x = p[i][0] - mx, y = p[i][1] - my, r2 = x * x + y * y;
		xx += x * x, xy += x * y, yy += y * y;
		xr += x * r2, yr += y * r2, rr += r2;
	}
	double det = 2 * (xx * yy - xy * xy);
	double cx = (xr * yy - yr * xy) / det, cy = (yr * xx - xr * xy) / det;
	return (struct circle){ mx + cx, my + cy, sqrt(rr / n + cx * cx + cy * cy) };
}

/* The pupil's ellipse in the photograph, projected through the cornea to the iris plane, as a circle. */
static struct circle pupil_in_plane(const struct unrefract_view *view)
{
	const struct ellipse *e = &view->fit->pupil;
	double p[MARGIN_POINTS][2];
	int n = 0;
	for (int i = 0; i < MARGIN_POINTS && view->fit->has_pupil; i++) {
		double s = 2 * M_PI * i / MARGIN_POINTS, a = e->a * cos(s), b = e->b * sin(s);
		double px[2] = { e->cx + a * cos(e->angle) - b * sin(e->angle), e->cy + a * sin(e->angle) + b * cos(e->angle) };
		n += iris_see(p[n], 0, &view->iris, px);
	}
	return n < MARGIN_POINTS / 2 ? (struct circle){ 0 } : circle_fit(n, p);
}

/* The pupil where the fit has none: the radius at which the brightness of the rings rises most. */
static struct circle pupil_from_rings(const float *lum, const float *iris, int size, double extent, double limbus)
{
	struct sheet disc = { size, extent, { 0, 0, 0 }, limbus, 0 };
	struct rings rings = rings_of(lum, iris, &disc, true, 0.1f);
	int best = 0;
	float rise = 0;
	for (int i = SHEET_RINGS / 8; i + 3 < SHEET_RINGS * 3 / 4; i++)
		if (rings.median[i + 2] - rings.median[i] > rise) {
			rise = rings.median[i + 2] - rings.median[i];
			best = i + 1;
		}
	return (struct circle){ 0, 0, best ? limbus * (best + 0.5) / SHEET_RINGS : 0.3 * limbus };
}

enum { MUCH_HIDDEN = 2 * FIT_SECTORS / 5 };

/* Where the limbus is visible no lid covers the iris beside it: fills the visible share for each angle. False where most of
 * the limbus is visible, or nothing is known of it: then the left and right of the ring are favoured. */
static bool open_angles(double open[SHEET_ANGLES], const struct fit *fit, const struct sheet *sheet, const struct eye *eye)
{
	int hidden = 0;
	for (int i = 0; i < FIT_SECTORS; i++)
		hidden += fit->seen[i] < 0.5;
	if (hidden < MUCH_HIDDEN || hidden == FIT_SECTORS)
		return false;
	for (int a = 0; a < SHEET_ANGLES; a++) {
		double p[3], px[2];
		sheet_point(p, sheet, 1, 2 * M_PI * (a + 0.5) / SHEET_ANGLES);
		p[2] = eye_limbus_depth(eye);
		open[a] = 0;
		if (!fit_project(px, fit, p))
			continue;
		double turn = atan2(px[1] - fit->limbus.cy, px[0] - fit->limbus.cx) / (2 * M_PI);
		open[a] = fit->seen[(int)((turn < 0 ? turn + 1 : turn) * FIT_SECTORS) % FIT_SECTORS];
	}
	return true;
}

static void look(struct unrefract_view *view, const struct iris_map *map, const struct evidence *evidence, const struct eye *eye,
                 const struct unrefract_conf *conf)
{
	struct unrefract_survey *s = &view->survey;
	double limbus = eye->limbus_radius;
	size_t n = (size_t)s->size * (size_t)s->size;
	float *seen = mem_array(n, sizeof *seen);
	float *lum = mem_array(n, sizeof *lum);
	for (size_t i = 0; i < n; i++) {
		const float *rgb = s->rgb + 3 * i;
		seen[i] = map->rim[i] < (float)limbus && rgb[0] + rgb[1] + rgb[2] > 0;
		lum[i] = logf(rgb[0] + rgb[1] + rgb[2] + 1e-3f);
	}
	struct told told = told_new(evidence, map, seen, limbus);
	float *iris = told_iris(&told, seen, n);
	if (!(view->pupil.r > 0))
		view->pupil = told_pupil(&told, s->size, s->extent);
	if (!(view->pupil.r > 0))
		view->pupil = pupil_from_rings(lum, iris, s->size, s->extent, limbus);
	double open[SHEET_ANGLES];
	struct sheet sheet = { s->size, s->extent, view->pupil, limbus, 0 };
	if (open_angles(open, view->fit, &sheet, eye))
		sheet.open = open;
	unrefract_mask(s, seen, &told, view->white.rgb, &sheet, conf);
	told_free(&told);
	free(lum);
	free(iris);
	free(seen);
}

bool unrefract_survey(struct unrefract_view *view, const struct photo *photo, const struct fit *fit,
                      const struct evidence *evidence, const struct eye *eye, const struct unrefract_conf *conf, struct err *err)
{
	view->fit = fit;
	view->grey = photo->grey;
	if (!(view->white.rgb[1] > 0))
		view->white = balance_none();
	view->iris = iris_view_new(fit, eye);
	view->pupil = pupil_in_plane(view);
	view->gain[0] = view->gain[1] = view->gain[2] = 1;
	struct unrefract_survey *s = &view->survey;
	s->size = conf->survey_size;
	s->extent = conf->extent * eye->limbus_radius;
	size_t n = (size_t)s->size * (size_t)s->size;
	s->rgb = mem_array(n * 3, sizeof(float));
	s->weight = mem_array(n, sizeof(float));
	struct iris_map_conf coarse = { .method = IRIS_LATTICE, .node = 8 };
	struct iris_map map = iris_map_new(&view->iris, s->size, s->extent, eye->limbus_radius, &coarse);
	struct crop crop = crop_new(photo, &map);
	long sampled = crop_sample(s->rgb, &crop, &map, 0);
	if (sampled)
		look(view, &map, evidence, eye, conf);
	crop_free(&crop);
	iris_map_free(&map);
	view->used = sampled > 0;
	return sampled || err_set(err, "the iris lies outside the photograph: move the eye into the frame");
}

void unrefract_view_free(struct unrefract_view *view)
{
	free(view->survey.rgb);
	free(view->survey.weight);
	free(view->survey.detail);
	free(view->survey.sharp);
	view->survey = (struct unrefract_survey){ 0 };
}
