#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "iris/unrefract/register.h"
#include "iris/unrefract/sample.h"
#include "iris/unrefract/shade.h"
#include "image/plane.h"

int unrefract_size(int n, const struct unrefract_view views[], const struct eye *eye,
                   const struct unrefract_conf *conf)
{
	double finest = 0;
	for (int i = 0; i < n; i++)
		if (views[i].used)
			finest = fmax(finest, iris_view_px_per_mm(&views[i].iris));
	double size = 2 * conf->extent * eye->limbus_radius * finest * conf->scale;
	// a multiple of 8 suits every later halving
	return 8 * (int)fmax(8, fmin(conf->max_size, size) / 8);
}

struct unrefract_texture unrefract_begin(int size, const struct eye *eye, const struct unrefract_view *best,
                                         const struct unrefract_conf *conf)
{
	return (struct unrefract_texture){ .rgbw = image_new(size, size, 4),
		                               .extent = conf->extent * eye->limbus_radius,
		                               .pupil = best->pupil,
		                               .pupil_sigma = best->pupil_sigma };
}

/* Marks with 1 the texels that need no sampling: deep in the pupil, beyond the limbus, or hidden in this photograph. */
static uint8_t *texels_to_skip(const struct unrefract_texture *texture, const struct iris_map *map,
                               const struct unrefract_view *view, const struct eye *eye,
                               const struct unrefract_conf *conf)
{
	int size = map->size;
	const struct circle *pupil = &texture->pupil;
	double mm = 2 * map->extent / size, hole = pupil->r - conf->pupil_margin;
	double to = view->survey.size / (2 * view->survey.extent);
	uint8_t *skip = mem_array((size_t)size * (size_t)size, 1);
#pragma omp parallel for schedule(static)
	for (int row = 0; row < size; row++)
		for (int col = 0; col < size; col++) {
			long i = (long)row * size + col;
			double x = (col + 0.5) * mm - map->extent, y = (row + 0.5) * mm - map->extent;
			double dx = x - pupil->cx, dy = y - pupil->cy;
			const double(*a)[3] = view->iris.a;
			double sx = a[0][0] * x + a[0][1] * y + a[0][2], sy = a[1][0] * x + a[1][1] * y + a[1][2];
			skip[i] = (hole > 0 && dx * dx + dy * dy < hole * hole) || !(map->rim[i] < (float)eye->limbus_radius)
			          || plane_sample(view->survey.weight, view->survey.size, view->survey.size,
			                          (sx + view->survey.extent) * to, (sy + view->survey.extent) * to) <= 0;
		}
	return skip;
}

static float smooth_step(double x)
{
	x = fmin(fmax(x, 0), 1);
	return (float)(x * x * (3 - 2 * x));
}

/* Weight of a texel: the survey's mask, times a power of the share of a photo pixel that it spans in its most foreshortened
 * direction, times ramps at the pupil's margin and at the limbus, whose blur reaches inwards. */
static float texel_weight(const struct unrefract_texture *texture, const struct iris_map *map,
                          const struct unrefract_view *view, const struct eye *eye, int col, int row, const double ramp[2],
                          const struct unrefract_conf *conf)
{
	double mm = 2 * map->extent / map->size;
	double x = (col + 0.5) * mm - map->extent, y = (row + 0.5) * mm - map->extent;
	const double(*a)[3] = view->iris.a;
	double sx = a[0][0] * x + a[0][1] * y + a[0][2], sy = a[1][0] * x + a[1][1] * y + a[1][2];
	const struct unrefract_survey *s = &view->survey;
	double to = s->size / (2 * s->extent);
	float w = plane_sample(s->weight, s->size, s->size, (sx + s->extent) * to, (sy + s->extent) * to);
	double detail = map_resolution(map, col, row) * conf->scale;
	w *= (float)pow(fmin(1, detail), conf->foreshortening);
	w *= smooth_step((eye->limbus_radius - map->rim[(long)row * map->size + col] - ramp[0]) / ramp[1]);
	double from_pupil = hypot(x - texture->pupil.cx, y - texture->pupil.cy) - texture->pupil.r;
	return w * smooth_step(from_pupil / fmax(mm, conf->pupil_margin) + 0.5);
}

static void unshade(float rgb[3], const struct unrefract_texture *texture, const struct unrefract_view *view, int col, int row)
{
	const double mm = 2 * texture->extent / texture->rgbw.width, x = (col + 0.5) * mm - texture->extent, y = (row + 0.5) * mm - texture->extent;
	double p[2];
	affine_apply(p, view->iris.a, x, y);
	unrefract_unshade(rgb, &view->survey, p);
}

// A texel that spans less of a photo pixel than this, at the grazing limit, shows its neighbours' colours.
static const double grazing = 0.2;

void unrefract_add(struct unrefract_texture *texture, const struct unrefract_view *view, const struct photo *photo,
                   const struct eye *eye, const struct unrefract_conf *conf)
{
	int size = texture->rgbw.width;
	struct iris_map map = iris_map_new(&view->iris, size, texture->extent, eye->limbus_radius, &conf->map);
	uint8_t *skip = texels_to_skip(texture, &map, view, eye, conf);
	float *rgb = mem_array((size_t)size * (size_t)size * 3, sizeof *rgb);
	struct crop crop = crop_new(photo, &map);
	texture->texels += crop_sample(rgb, &crop, &map, skip);
	// from the limbus inwards, mm: where it begins, and its length
	double length = conf->limbus_ramp + 2 * view->fit->edge_sigma_px / iris_view_px_per_mm(&view->iris), ramp[2] = { fmax(view->haze - length / 2, 0), length };
#pragma omp parallel for schedule(dynamic, 8)
	for (int row = 0; row < size; row++)
		for (int col = 0; col < size; col++) {
			long i = (long)row * size + col;
			float *out = texture->rgbw.px + 4 * i;
			if (skip[i] || rgb[3 * i] + rgb[3 * i + 1] + rgb[3 * i + 2] <= 0
			    || map_resolution(&map, col, row) * conf->scale < grazing)
				continue;
			// a trace of weight, so that a texel of weight 0 has a colour too
			float w = texel_weight(texture, &map, view, eye, col, row, ramp, conf) + 1e-6f;
			if (view->survey.shade)
				unshade(rgb + 3 * i, texture, view, col, row);
			for (int c = 0; c < 3; c++)
				out[c] += w * view->gain[c] * rgb[3 * i + c];
			out[3] += w;
		}
	crop_free(&crop);
	free(rgb);
	free(skip);
	iris_map_free(&map);
}

void unrefract_finish(struct unrefract_texture *texture, const struct eye *eye)
{
	int size = texture->rgbw.width;
	double mm = 2 * texture->extent / size;
	long seen = 0, all = 0;
#pragma omp parallel for schedule(static) reduction(+ : seen, all)
	for (int row = 0; row < size; row++)
		for (int col = 0; col < size; col++) {
			float *px = image_at(&texture->rgbw, col, row), w = px[3];
			for (int c = 0; c < 3 && w > 0; c++)
				px[c] /= w;
			px[3] = w > 1e-3f ? fminf(w, 1) : 0;
			double x = (col + 0.5) * mm - texture->extent, y = (row + 0.5) * mm - texture->extent;
			bool iris = hypot(x, y) < eye->limbus_radius
			            && hypot(x - texture->pupil.cx, y - texture->pupil.cy) > texture->pupil.r;
			all += iris;
			seen += iris && px[3] > 0;
		}
	texture->seen = all ? (double)seen / (double)all : 0;
}
