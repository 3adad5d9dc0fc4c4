/* The photograph beside the rendering of its own view, and their difference. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/photo/photo.h"
#include "image/colour.h"
#include "math/vec.h"

static const double shown = 1.3;  // semi-axes round the limbus

/* The part of the view that the panels show. */
struct frame {
	int x0, y0, width, height;
};

static struct frame frame_of(const struct shot *shot, const struct image *view)
{
	const struct ellipse *e = &shot->fit.limbus;
	double reach = shown * e->a / shot->scale, cx = (e->cx - shot->window[0]) / shot->scale, cy = (e->cy - shot->window[1]) / shot->scale;
	int x0 = (int)fmax(cx - reach, 0), y0 = (int)fmax(cy - reach, 0);
	int x1 = (int)fmin(cx + reach + 1, view->width), y1 = (int)fmin(cy + reach + 1, view->height);
	return (struct frame){ x0, y0, x1 - x0, y1 - y0 };
}

/* Weight of the texture where each pixel looks: 0 off the iris, where no photograph saw it, in the pupil, on a glint. */
static void weights_row(float *weight, const struct scene *s, const struct shot *shot, int y)
{
	const struct scene_level *level = &s->level[0];
	for (int x = 0; x < shot->image.width; x++) {
		double px[2] = { shot->window[0] + (x + 0.5) * shot->scale, shot->window[1] + (y + 0.5) * shot->scale };
		double o[3], d[3], K[3], from[3], in[3], P[3];
		weight[x] = 0;
		if (ellipse_radius(&shot->fit.limbus, px[0], px[1]) > 0.95)
			continue;
		fit_ray(o, d, &shot->fit, px);
		if (!cornea_sight(K, from, in, &s->cornea, o, d) || in[2] < 0.1)
			continue;
		vec_add(P, from, (s->eye.iris_depth - from[2]) / in[2], in);
		double u0 = P[0], v0 = P[1];
		P[0] += shot->slip[0][0] * u0 + shot->slip[0][1] * v0 + shot->slip[0][2];
		P[1] += shot->slip[1][0] * u0 + shot->slip[1][1] * v0 + shot->slip[1][2];
		if (hypot(P[0] - s->pupil[0], P[1] - s->pupil[1]) < s->pupil[2] + 0.12)
			continue;
		double u = (P[0] + s->extent) * level->per_mm, v = (P[1] + s->extent) * level->per_mm;
		if (u >= 0 && v >= 0 && u < level->n && v < level->n)
			weight[x] = level->colour[4 * ((long)(int)v * level->n + (int)u) + 3];
	}
}

static void put(struct image *out, int at, const struct frame *f, const struct image *from)
{
	for (int y = 0; y < f->height; y++)
		for (int x = 0; x < f->width; x++)
			for (int c = 0; c < 3; c++)
				image_at(out, at + x, y)[c] = image_at(from, f->x0 + x, f->y0 + y)[c];
}

/* The difference of the sRGB values, four times, about middle grey; dim where it does not count. */
static void put_difference(struct image *out, int at, const struct frame *f, const struct shot *shot,
                           const struct image *view, const float *weight)
{
#pragma omp parallel for schedule(static)
	for (int y = 0; y < f->height; y++)
		for (int x = 0; x < f->width; x++) {
			const float *a = image_at(&shot->image, f->x0 + x, f->y0 + y), *b = image_at(view, f->x0 + x, f->y0 + y);
			float w = weight[(long)(f->y0 + y) * view->width + f->x0 + x], k = 0.25f + 0.75f * (w > 0);
			for (int c = 0; c < 3; c++) {
				float d = srgb_from_linear(fminf(b[c], 1)) - srgb_from_linear(fminf(a[c], 1));
				float shade = w > 0 ? 0.5f + 4 * d : 0.42f + 0.5f * d;
				image_at(out, at + x, y)[c] = linear_from_srgb(fminf(fmaxf(k * shade + (1 - k) * 0.35f, 0), 1));
			}
		}
}

static int compare_floats(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static struct shot_difference measure(const struct shot *shot, const struct image *view, const float *weight)
{
	struct shot_difference out = { 0 };
	long n = 0, all = (long)view->width * view->height;
	float *error = mem_array((size_t)all, sizeof *error);
	double sum = 0;
	for (long i = 0; i < all; i++)
		if (weight[i] > 0.3f) {
			error[n] = (float)colour_difference(shot->image.px + 3 * i, view->px + 3 * i);
			sum += error[n++];
		}
	qsort(error, (size_t)n, sizeof *error, compare_floats);
	if (n)
		out = (struct shot_difference){ n, sum / (double)n, error[n * 95 / 100] };
	free(error);
	return out;
}

/* Of each pixel of the view; free(). */
static float *weights_of(const struct scene *scene, const struct shot *shot, const struct image *view)
{
	float *weight = mem_array((size_t)view->width * (size_t)view->height, sizeof *weight);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < view->height; y++)
		weights_row(weight + (long)y * view->width, scene, shot, y);
	return weight;
}

struct shot_difference compare_numbers(const struct scene *scene, const struct shot *shot, const struct image *view)
{
	float *weight = weights_of(scene, shot, view);
	const struct shot_difference out = measure(shot, view, weight);
	free(weight);
	return out;
}

struct image compare_shot(struct shot_difference *difference, const struct scene *scene, const struct shot *shot, const struct image *view)
{
	struct frame f = frame_of(shot, view);
	struct image out = image_new(3 * f.width + 2 * COMPARE_GAP, f.height, 3);
	float *weight = weights_of(scene, shot, view);
	put(&out, 0, &f, &shot->image);
	put(&out, f.width + COMPARE_GAP, &f, view);
	put_difference(&out, 2 * (f.width + COMPARE_GAP), &f, shot, view, weight);
	*difference = measure(shot, view, weight);
	free(weight);
	return out;
}
