#include "draw/eye/march/paths.h"

#include <math.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "iris/refraction_file.h"
#include "image/exr.h"

static const long limit_px = 1L << 27;

/* The stroma's thickness where no relief says: the mean of the three places of the iris paper, section 4, weighted by
 * their share of the area. A layer without melanin to speak of, as in a blue eye. */
const double scene_plain_stroma = 0.48;
static const struct tissue plain_tissue = { .layer = { { 0.01, 0.9 }, { 0.002, 0.9 } }, .abl_thickness = 0.03,
	                                        .thickness_scale = 1, .exposure = 1, .illuminant = ILLUMINANT_D65 };

/* Channels of an EXR map; *extent its half-width. What is not finite becomes 0, and is counted. image_free. */
static bool read_map(struct image *out, struct scene *s, const char *path, int channels, const char *const names[], double *extent,
                     struct err *err)
{
	struct exr_info info = { 0 };
	if (!exr_read(out, path, channels, names, limit_px, &info, err))
		return false;
	*extent = info.extent_mm;
	if (out->width != out->height || !(info.extent_mm > 0)) {
		image_free(out);
		return err_set(err, "%s: an iris map is square and says its extentMm", path);
	}
	for (long i = 0; i < (long)out->width * out->height * channels; i++)
		if (!isfinite(out->px[i])) {
			out->px[i] = 0;
			s->not_finite++;
		}
	return true;
}

static bool resample(struct image *map, int n, struct err *err)
{
	if (map->width == n)
		return true;
	struct image out = image_new(n, n, map->channels);
	bool ok = cv_resize(out.px, n, n, map->px, map->width, map->height, map->channels, err);
	image_free(map);
	*map = out;
	return ok;
}

static bool load_colour(struct scene *s, const char *path, int most, struct err *err)
{
	static const char *const names[] = { "R", "G", "B", "W" };
	struct image map;
	if (!read_map(&map, s, path, 4, names, &s->extent, err))
		return false;
	int n = map.width < most ? map.width : most;
	bool ok = resample(&map, n, err);
	s->level[0] = (struct scene_level){ .n = n, .per_mm = (float)(n / (2 * s->extent)), .colour = map.px };
	return ok;
}

static bool load_relief(struct scene *s, const char *path, struct err *err)
{
	struct scene_level *l = &s->level[0];
	static const char *const names[] = { "Y", "T" };
	double extent = s->extent;
	struct image map = { 0 };
	if (path && file_exists(path)) {
		if (!read_map(&map, s, path, 2, names, &extent, err))
			return false;
		if (fabs(extent - s->extent) > 1e-3 * s->extent) {
			image_free(&map);
			return err_set(err, "%s: extentMm = %g, but the texture's is %g", path, extent, s->extent);
		}
		if (!resample(&map, l->n, err)) {
			image_free(&map);
			return false;
		}
	} else {
		map = image_new(l->n, l->n, 2);
		for (long i = 0; i < (long)l->n * l->n; i++)
			map.px[2 * i + 1] = (float)scene_plain_stroma;
	}
	for (long i = 0; i < (long)l->n * l->n; i++) {  // a relief beyond that is none, and the march counts on it
		map.px[2 * i] = fmaxf(-0.6f, fminf(0.6f, map.px[2 * i]));
		map.px[2 * i + 1] = fmaxf(0.02f, fminf(1, map.px[2 * i + 1]));
	}
	l->relief = map.px;
	return true;
}

static void load_pupil(struct scene *s, const char *path)
{
	struct err err = { 0 };
	json_t *root = path && file_exists(path) ? json_read(path, 1 << 22, &err) : 0, *p = json_object_get(root, "pupil");
	double v[3];
	s->pupil[2] = 1.8;  // mm: where it was not found
	if (p && json_get(&v[0], p, "cx", path, &err) && json_get(&v[1], p, "cy", path, &err) && json_get(&v[2], p, "r", path, &err)) {
		if (v[2] > 0.3 && v[2] < s->limbus[1] && hypot(v[0], v[1]) < 2)
			for (int i = 0; i < 3; i++)
				s->pupil[i] = v[i];
		else
			s->odd_pupil = v[2];
	}
	json_decref(root);
}

static void take_tissue(struct scene *s, const struct tissue *tissue)
{
	struct tissue_bands bands;
	s->tissue = *tissue;
	tissue_bands_make(&bands, s->conf.bands, tissue->illuminant);
	tissue_optics_make(&s->optics, tissue, &bands);
	double flat[3];
	tissue_reflectance(flat, &s->optics, scene_plain_stroma, 1, 1);
	for (int c = 0; c < 3; c++)
		s->flat[c] = (float)(flat[c] * s->optics.exposure);
}

static bool load_tissue(struct scene *s, const char *path, struct err *err)
{
	struct tissue tissue = plain_tissue;
	if (path && file_exists(path) && !tissue_load(&tissue, path, err))
		return false;
	take_tissue(s, &tissue);
	return true;
}

void scene_plain_tissue(struct scene *s)
{
	take_tissue(s, &plain_tissue);
}

/* Made for this very cornea, or not used: the folder may have been changed since. */
static bool load_refraction(struct scene *s, const char *path, struct err *err)
{
	if (!path || !file_exists(path))
		return true;
	if (!refraction_load(&s->refraction, path, err))
		return false;
	const struct cornea *a = &s->refraction.cornea, *b = &s->cornea;
	bool same = fabs(a->R - b->R) + fabs(a->p - b->p) + fabs(a->n - b->n) < 1e-6;
	if (!same || s->refraction.method > REFRACTION_POLYNOMIAL) {  // a table is for the iris plane alone
		refraction_free(&s->refraction);
		s->refraction = (struct refraction){ 0 };
	}
	return true;
}

void scene_geometry(struct scene *s)
{
	double aspect = isfinite(s->eye.limbus_aspect) ? s->eye.limbus_aspect : 1;
	s->cornea = eye_cornea(&s->eye);
	s->limbus[0] = s->eye.limbus_radius;
	s->limbus[1] = s->eye.limbus_radius * aspect;
	s->limbus_depth = eye_limbus_depth(&s->eye);
	s->cornea.rim = 1.06 * s->limbus[0];
	double R = s->conf.sclera_radius, r = s->limbus[0];
	s->sclera_z = s->limbus_depth + sqrt(fmax(R * R - r * r, 0));
}

bool scene_load(struct scene *s, const struct scene_files *files, const struct eye *eye, const struct scene_conf *conf,
                struct err *err)
{
	*s = (struct scene){ .eye = *eye, .conf = *conf, .gain = 1 };
	scene_geometry(s);
	load_pupil(s, files->texture_json);
	if (!load_colour(s, files->texture, conf->map_size, err) || !load_relief(s, files->relief, err)
	    || !load_tissue(s, files->pigment, err) || !load_refraction(s, files->refraction, err)) {
		scene_free(s);
		return false;
	}
	scene_fill(s->level[0].colour, s->level[0].n, s->extent, s->pupil);
	scene_levels_make(s);
	scene_nodes_make(s);
	scene_veins_make(s);
	s->paths = scene_paths_make(s);
	return true;
}

void scene_free(struct scene *s)
{
	for (int i = 0; i < SCENE_LEVELS; i++) {
		free(s->level[i].relief);
		free(s->level[i].colour);
		free(s->level[i].model);
		free(s->level[i].per_model);
		free(s->level[i].horizon);
		free(s->level[i].pairs);
		free(s->level[i].bottom);
		free(s->level[i].shown.px);
		free(s->level[i].bare.px);
	}
	image_free(&s->veins);
	free(s->white.px);
	image_free(&s->film);
	free(s->paths);
	refraction_free(&s->refraction);
	*s = (struct scene){ 0 };
}

static float *halve(const float *map, int n, int channels)
{
	int m = n / 2;
	float *out = mem_array((size_t)m * (size_t)m * (size_t)channels, sizeof *out);
	for (int y = 0; y < m; y++)
		for (int x = 0; x < m; x++)
			for (int c = 0; c < channels; c++) {
				const float *p = map + ((long)2 * y * n + 2 * x) * channels + c;
				out[((long)y * m + x) * channels + c] = (p[0] + p[channels] + p[(long)n * channels] + p[(long)(n + 1) * channels]) / 4;
			}
	return out;
}

void scene_levels_make(struct scene *s)
{
	struct scene_level *l = s->level;
	s->height_min = s->height_max = 0;
	s->thickness_max = 0;
	for (long i = 0; i < (long)l->n * l->n; i++) {
		s->thickness_max = fmaxf(s->thickness_max, l->relief[2 * i + 1]);
		s->height_min = fminf(s->height_min, l->relief[2 * i]);
		s->height_max = fmaxf(s->height_max, l->relief[2 * i]);
	}
	s->n_levels = 1;
	for (int k = 1; k < SCENE_LEVELS && l[k - 1].n >= 64; k++, s->n_levels++) {
		free(l[k].relief);
		free(l[k].colour);
		free(l[k].model);
		free(l[k].per_model);
		free(l[k].horizon);
		free(l[k].pairs);
		free(l[k].bottom);
		free(l[k].shown.px);
		free(l[k].bare.px);
		l[k] = (struct scene_level){ .n = l[k - 1].n / 2, .per_mm = (float)(l[k - 1].n / 2 / (2 * s->extent)) };
		l[k].relief = halve(l[k - 1].relief, l[k - 1].n, 2);
		l[k].colour = halve(l[k - 1].colour, l[k - 1].n, 4);
		l[k].model = l[k - 1].model ? halve(l[k - 1].model, l[k - 1].n, 4) : 0;
	}
	for (int k = 0; k < s->n_levels && s->conf.shading == SCENE_TEXELS; k++) {
		free(l[k].horizon);
		l[k].horizon = s->conf.shadow > 0 && k >= scene_marched(s) ? scene_horizons(s, &l[k]) : 0;
		scene_pairs_make(&l[k], k >= scene_marched(s));
		scene_shown_make(&l[k], s);
	}
}

const struct scene_level *scene_level_for(const struct scene *s, double mm)
{
	int k = 0;
	while (k + 1 < s->n_levels && s->level[k + 1].per_mm * mm > 0.8)
		k++;
	return &s->level[k];
}
