#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "iris/unrefract/haze.h"
#include "iris/unrefract/mask.h"
#include "iris/unrefract/pupil.h"
#include "iris/unrefract/sample.h"

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

/* What a survey is made of before it is judged. */
struct sight {
	struct iris_map map;
	float *seen, *lum, *iris;  // [size][size]: 1 inside of limbus and photograph; log brightness; that it is neither lid nor mirrored
	struct told told;
};

/* Samples a photograph about the eye's axis. False: none of the iris lies in it; err is set. */
static bool sight_new(struct sight *sight, struct unrefract_view *view, const struct photo *photo, const struct evidence *evidence, const struct eye *eye,
                      const struct unrefract_conf *conf, struct err *err)
{
	struct unrefract_survey *s = &view->survey;
	const struct iris_map_conf coarse = { .method = IRIS_LATTICE, .node = 8 };
	s->size = conf->survey_size;
	s->extent = conf->extent * eye->limbus_radius;
	const size_t n = (size_t)s->size * (size_t)s->size;
	s->rgb = mem_array(n * 3, sizeof(float));
	s->weight = mem_array(n, sizeof(float));
	*sight = (struct sight){ .map = iris_map_new(&view->iris, s->size, s->extent, eye->limbus_radius, &coarse) };
	struct crop crop = crop_new(photo, &sight->map);
	const long sampled = crop_sample(s->rgb, &crop, &sight->map, 0);
	crop_free(&crop);
	if (!sampled)
		return err_set(err, "the iris lies outside the photograph: move the eye into the frame");
	sight->seen = mem_array(n, sizeof(float));
	sight->lum = mem_array(n, sizeof(float));
	for (size_t i = 0; i < n; i++) {
		const float *rgb = s->rgb + 3 * i;
		sight->seen[i] = sight->map.rim[i] < (float)eye->limbus_radius && rgb[0] + rgb[1] + rgb[2] > 0;
		sight->lum[i] = logf(rgb[0] + rgb[1] + rgb[2] + 1e-3f);
	}
	sight->told = told_new(evidence, view->occlusion, &sight->map, sight->seen, eye->limbus_radius);
	sight->iris = told_iris(&sight->told, sight->seen, n);
	return true;
}

static void sight_free(struct sight *sight)
{
	iris_map_free(&sight->map);
	told_free(&sight->told);
	free(sight->seen);
	free(sight->lum);
	free(sight->iris);
}

/* The pupil: measured, else the likeliest. */
static void find_pupil(struct unrefract_view *view, const struct sight *sight, const struct pupil_curve *fellow, double limbus, const struct unrefract_conf *conf)
{
	struct pupil_curve curve;
	view->pupil = pupil_measured(view);
	view->pupil_sigma = 0;
	if (view->pupil.r > 0)
		return;
	pupil_curve_of(&curve, sight->lum, sight->iris, &sight->told, &view->survey, limbus, conf);
	if (fellow && fellow->known)
		pupil_curve_join(&curve, fellow, conf);
	view->pupil = pupil_of_curve(&view->pupil_sigma, &curve, conf);
}

bool unrefract_pupil(struct pupil_curve *out, const struct photo *photo, const struct fit *fit, const struct evidence *evidence, const struct occlusion *occlusion, const struct eye *eye,
                     const struct unrefract_conf *conf, struct err *err)
{
	struct unrefract_view view = { .fit = fit, .occlusion = occlusion, .iris = iris_view_new(fit, eye) };
	struct sight sight = { 0 };
	const struct circle measured = pupil_measured(&view);
	bool ok = true;
	*out = (struct pupil_curve){ 0 };
	if (measured.r > 0)
		pupil_curve_at(out, measured.r);
	else if ((ok = sight_new(&sight, &view, photo, evidence, eye, conf, err)))
		pupil_curve_of(out, sight.lum, sight.iris, &sight.told, &view.survey, eye->limbus_radius, conf);
	sight_free(&sight);
	unrefract_view_free(&view);
	return ok;
}

bool unrefract_survey(struct unrefract_view *view, const struct photo *photo, const struct fit *fit, const struct evidence *evidence,
                      const struct pupil_curve *fellow, const struct eye *eye, const struct unrefract_conf *conf, struct err *err)
{
	struct sight sight;
	view->fit = fit;
	view->grey = photo->grey;
	if (!(view->white.rgb[1] > 0))
		view->white = balance_none();
	view->iris = iris_view_new(fit, eye);
	view->gain[0] = view->gain[1] = view->gain[2] = 1;
	view->used = sight_new(&sight, view, photo, evidence, eye, conf, err);
	if (view->used) {
		double open[SHEET_ANGLES];
		find_pupil(view, &sight, fellow, eye->limbus_radius, conf);
		struct sheet sheet = { view->survey.size, view->survey.extent, view->pupil, eye->limbus_radius, 0 };
		if (open_angles(open, fit, &sheet, eye))
			sheet.open = open;
		unrefract_mask(&view->survey, sight.seen, &sight.told, view->white.rgb, &sheet, conf);
		view->haze = unrefract_haze(view, &sheet, conf);
	}
	sight_free(&sight);
	return view->used;
}

void unrefract_view_free(struct unrefract_view *view)
{
	free(view->survey.rgb);
	free(view->survey.weight);
	free(view->survey.shade);
	free(view->survey.detail);
	free(view->survey.sharp);
	view->survey = (struct unrefract_survey){ 0 };
}
