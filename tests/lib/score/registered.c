#include "tests/lib/score/registered.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/levels.h"
#include "draw/eye/make.h"
#include "draw/eye/render.h"
#include "image/exr.h"
#include "image/patch/patch.h"
#include "image/picture.h"

static const double extent_mm = 6.4, iris_edge_mm = 0.25;

/* The photograph's camera, at every pixel or, every = 2, at the middles of pixels 0, 2, 4 ...; x and y of the truth's eye, which the
 * texture has. */
static struct scene_view view_of(const struct truth *t, int width, int height, int every)
{
	struct scene_view view = { .camera = { .focal_px = t->focal_px, .center_px = { t->center_px[0], t->center_px[1] }, .source = CAMERA_CONF },
		                       .x0 = 0.5 - 0.5 * every, .y0 = 0.5 - 0.5 * every, .scale = every, .width = width, .height = height, .samples = 1, .textured = true };
	double c = cos(t->turn), d = sin(t->turn);
	for (int i = 0; i < 4; i++) {
		const double *m = t->cam_from_eye[i];
		view.cam_from_eye[i][0] = c * m[0] + d * m[1];
		view.cam_from_eye[i][1] = c * m[1] - d * m[0];
		view.cam_from_eye[i][2] = m[2];
		view.cam_from_eye[i][3] = m[3];
	}
	return view;
}

/* The capture's eye with an iris of the colours that a texture [n][n][3] has, as the photograph's view shows it in even light.
 * image_free. */
static struct image picture_of(const struct truth *t, int shading, int n, const float *rgb, int width, int height, int every)
{
	struct scene_conf conf = { .map_size = 512, .search = 8, .steps = 2, .shading = shading, .bands = 3, .detail = 1, .own_width = 0.2, .ratio_most = 2.5, .ratio_chroma = 1.5, .limbus_width = 0.05,
		                       .sclera_radius = 11.8, .sclera_rgb = { 0.7, 0.7, 0.7 }, .veins_px = 128, .seed = 1 };
	struct scene s;
	scene_plain(&s, &t->eye, &conf, (double[]){ 0.2, 0.2, 0.2 }, 1, 0);
	struct scene_level *l = &s.level[0];
	free(l->colour);
	free(l->relief);
	l->n = n;
	l->per_mm = (float)(n / (2 * extent_mm));
	l->colour = mem_array((size_t)n * (size_t)n * 4, sizeof *l->colour);
	l->relief = mem_new((size_t)n * (size_t)n * 2, sizeof *l->relief);
	for (long i = 0; i < (long)n * n; i++) {
		memcpy(l->colour + 4 * i, rgb + 3 * i, 3 * sizeof *rgb);
		l->colour[4 * i + 3] = 1;
		l->relief[2 * i + 1] = (float)scene_plain_stroma;
	}
	s.extent = extent_mm;
	s.pupil[2] = 0.01;  // textures have it painted in
	scene_levels_make(&s);
	struct envmap room = envmap_room(32, (double[]){ 1, 1, 1 }, (double[]){ 1, 1, 1 }, 1, 0, 0);
	struct scene_lighting light = scene_lighting(&room, 0, 4);
	struct scene_view view = view_of(t, width, height, every);
	struct scene_count count = { 0 };
	scene_fit_colour(&s, &view, &light);
	struct image out = scene_render(&s, &view, &light, &count);
	envmap_free(&room);
	scene_free(&s);
	return out;
}

/* Where every second pixel's ray meets the iris, [height][width][2] mm: a picture of coordinates over one of a constant. image_free. */
static struct image points_of(const struct truth *t, int width, int height)
{
	enum { N = 1024 };
	static const float half = 0.1f;
	float *rgb = mem_array(3 * N * N, sizeof *rgb);
	struct image seen[2], out = image_new(width, height, 2);
	for (int k = 0; k < 2; k++) {
		for (int i = 0; i < N * N; i++)
			for (int c = 0; c < 3; c++)
				rgb[3 * i + c] = k || c == 2 ? half : half * (0.5f + ((float)(c ? i / N : i % N) + 0.5f) / N);
		seen[k] = picture_of(t, SCENE_RAYS, N, rgb, width, height, 2);
	}
	for (long i = 0; i < (long)width * height; i++)
		for (int c = 0; c < 2; c++) {
			float share = seen[0].px[4 * i + c] / seen[1].px[4 * i + c];
			out.px[2 * i + c] = (share - 0.5f) * 2 * (float)extent_mm - (float)extent_mm;
		}
	image_free(&seen[0]);
	image_free(&seen[1]);
	free(rgb);
	return out;
}

static void add(struct registered *r, double x, double y)
{
	r->px = mem_grow(r->px, (size_t)r->n + 1, sizeof *r->px);
	r->px[r->n++] = hypot(x, y);
	r->mean[0] += x;
	r->mean[1] += y;
}

static void close_sums(struct registered *r)
{
	for (int c = 0; c < 2; c++)
		r->mean[c] /= r->n ? r->n : 1;
}

/* Of a texel of the map that is iris, with its right and lower neighbour: the offset in px, by how the iris moves from one to the
 * next (two px apart). */
static bool map_offset(double off[2], const struct image *map, const struct image *ours, int x, int y)
{
	const float *a = image_at(map, x, y), *b = image_at(map, x + 1, y), *c = image_at(map, x, y + 1), *p = image_at(ours, x, y);
	if (!(a[3] == 1 && b[3] == 1 && c[3] == 1))
		return false;
	double J[2][2] = { { (double)(b[0] - a[0]) / 2, (double)(c[0] - a[0]) / 2 }, { (double)(b[1] - a[1]) / 2, (double)(c[1] - a[1]) / 2 } };
	double det = J[0][0] * J[1][1] - J[0][1] * J[1][0], e[2] = { (double)(p[0] - a[0]), (double)(p[1] - a[1]) };
	off[0] = (J[1][1] * e[0] - J[0][1] * e[1]) / det;
	off[1] = (J[0][0] * e[1] - J[1][0] * e[0]) / det;
	return true;
}

bool registered_map(struct registered *out, const struct truth *t, const char *dir, struct err *err)
{
	static const char *const names[] = { "R", "G", "B", "A" };
	char *path = mem_printf("%s/map.exr", dir);
	struct image map;
	struct exr_info info = { 0 };
	*out = (struct registered){ 0 };
	bool ok = exr_read(&map, path, 4, names, 1L << 24, &info, err);
	free(path);
	if (!ok)
		return false;
	struct image ours = points_of(t, map.width, map.height);
	for (int y = 0; y + 1 < map.height; y++)
		for (int x = 0; x + 1 < map.width; x++) {
			const float *a = image_at(&map, x, y);
			double off[2];
			// The limbus' own ramp is no iris.
			if (hypot((double)a[0], (double)a[1]) < t->eye.limbus_radius - iris_edge_mm && map_offset(off, &map, &ours, x, y))
				add(out, off[0], off[1]);
		}
	close_sums(out);
	image_free(&map);
	image_free(&ours);
	return true;
}

static float *texture_of(const char *dir, int *n, struct err *err)
{
	char *path = mem_printf("%s/iris_texture.png", dir);
	uint8_t *px;
	int height;
	float *rgb = 0;
	if (picture_read(&px, n, &height, path, 100, err)) {
		rgb = mem_array((size_t)*n * (size_t)*n * 3, sizeof *rgb);
		for (long i = 0; i < 3L * *n * *n; i++)
			rgb[i] = 0.3f * fmaxf(linear_from_srgb((float)px[i] / 255), 1e-3f);
		free(px);
	}
	free(path);
	return rgb;
}

/* Brightness as the eye has it, 0..255. */
static uint8_t luma_of(float r, float g, float b)
{
	return (uint8_t)lrintf(255 * srgb_from_linear(fminf(fmaxf(0.2126f * r + 0.7152f * g + 0.0722f * b, 0), 1)));
}

/* One brightness of each pixel of both; on: where the photograph shows the iris alone, 1. */
struct pair {
	int width, height;
	uint8_t *photo, *ours;
	float *on;
};

static void pair_free(struct pair *p)
{
	free(p->photo);
	free(p->ours);
	free(p->on);
}

static bool pair_of(struct pair *p, const struct truth *t, const char *dir, int shading, struct err *err)
{
	int n, w, h;
	uint8_t *photo = 0, *labels = 0;
	char *path = mem_printf("%s/labels.png", dir);
	float *rgb = texture_of(dir, &n, err);
	bool ok = rgb && picture_read(&photo, &p->width, &p->height, t->photo, 100, err) && picture_read(&labels, &w, &h, path, 100, err);
	free(path);
	if (ok && (w != p->width || h != p->height))
		ok = err_set(err, "%s: labels of another size", dir);
	if (ok) {
		struct image ours = picture_of(t, shading, n, rgb, w, h, 1);
		long size = (long)w * h;
		p->photo = mem_array((size_t)size, 1);
		p->ours = mem_array((size_t)size, 1);
		p->on = mem_array((size_t)size, sizeof *p->on);
		for (long i = 0; i < size; i++) {
			const uint8_t *q = photo + 3 * i;
			const float *o = ours.px + 4 * i;
			p->photo[i] = luma_of(linear_from_srgb((float)q[0] / 255), linear_from_srgb((float)q[1] / 255), linear_from_srgb((float)q[2] / 255));
			p->ours[i] = luma_of(o[0], o[1], o[2]);
			p->on[i] = labels[3 * i] == 4;
		}
		image_free(&ours);
	}
	free(rgb);
	free(photo);
	free(labels);
	return ok;
}

/* Middles of patches that the iris fills. free(). */
static double (*places(int *n, const struct pair *p, int radius))[2]
{
	double (*at)[2] = 0;
	*n = 0;
	for (int y = 2 * radius; y + 2 * radius < p->height; y += 2 * radius)
		for (int x = 2 * radius; x + 2 * radius < p->width; x += 2 * radius) {
			bool on = true;
			for (int v = -radius; v <= radius; v += radius / 4)
				for (int u = -radius; u <= radius; u += radius / 4)
					on = on && p->on[(long)(y + v) * p->width + x + u] > 0;
			if (!on)
				continue;
			at = mem_grow(at, (size_t)*n + 1, sizeof *at);
			at[*n][0] = x + 0.5;
			at[(*n)++][1] = y + 0.5;
		}
	return at;
}

bool registered_photo(struct registered *out, const struct truth *t, const char *dir, int shading, struct err *err)
{
	enum { RADIUS = 40 };
	const struct patch_conf conf = { .radius = RADIUS, .every = 1, .iterations = 30, .stop = 1e-3, .noise = 3, .misfit = 1 };
	static const double sharp = 0.1;  // px: more than one edge, and not all in one direction
	struct pair p = { 0 };
	struct scales ours = { 0 }, photo = { 0 };
	*out = (struct registered){ 0 };
	bool ok = pair_of(&p, t, dir, shading, err);
	if (ok) {
		int n;
		double (*at)[2] = places(&n, &p, RADIUS);
		scales_fill(&ours, p.ours, p.width, p.width, p.height, 0, 0, p.width, p.height, 2);
		scales_fill(&photo, p.photo, p.width, p.width, p.height, 0, 0, p.width, p.height, 2);
		struct patch_set *set = patch_set_new(&ours, n, (const double(*)[2])at, 0, &conf);
		for (int i = 0; i < n; i++) {
			struct patch_warp warp = { { at[i][0], at[i][1] }, { { 1, 0 }, { 0, 1 } } };
			const struct patch_prior prior = { warp, INFINITY, 0.005 };
			struct patch_fit fit;
			bool found = patch_align(&warp, &fit, set, i, 1, &photo, &prior) && patch_align(&warp, &fit, set, i, 0, &photo, &prior);
			if (found && fit.ncc > 0.9 && fit.sigma < sharp)
				add(out, warp.at[0] - at[i][0], warp.at[1] - at[i][1]);
		}
		patch_set_free(set);
		free(at);
	}
	close_sums(out);
	scales_free(&ours);
	scales_free(&photo);
	pair_free(&p);
	return ok;
}

void registered_free(struct registered *r)
{
	free(r->px);
	*r = (struct registered){ 0 };
}
