/* The light of a photograph: lamps from their reflections in the cornea; where there are none, a studio. */
#include <math.h>

#include "math/vec.h"
#include "draw/photo/glint.h"

static const double mirror_at_normal = 0.0207;  // ((n - 1) / (n + 1))^2 of the tear film, n = 1.336

/* Direction, in the camera's frame, from which light is mirrored into a point of the view. */
static bool mirrored(double dir[3], const struct shot *shot, const struct cornea *cornea, double x, double y)
{
	double px[2] = { shot->window[0] + x * shot->scale, shot->window[1] + y * shot->scale }, o[3], d[3], K[3], N[3], r[3];
	fit_ray(o, d, &shot->fit, px);
	if (!cornea_hit(K, cornea, o, d))
		return false;
	cornea_normal(N, cornea, K);
	vec_add(r, d, -2 * vec_dot(d, N), N);
	for (int i = 0; i < 3; i++)
		dir[i] = shot->fit.cam_from_eye[i][0] * r[0] + shot->fit.cam_from_eye[i][1] * r[1]
		         + shot->fit.cam_from_eye[i][2] * r[2];
	return true;
}

static double angle(const double a[3], const double b[3])
{
	return acos(fmin(fmax(vec_dot(a, b), -1), 1));
}

static bool lamp(struct envmap_box *box, const struct glint *g, const struct shot *shot, const struct cornea *cornea)
{
	double l[3], r[3], t[3], b[3];
	// A region's area, not its bounding box: a window seen askew fills only part of that.
	double fill = sqrt(g->n / (double)((g->hi[0] - g->lo[0] + 1) * (g->hi[1] - g->lo[1] + 1)));
	double w = fill * (g->hi[0] - g->lo[0] + 1) / 2, h = fill * (g->hi[1] - g->lo[1] + 1) / 2;
	if (!mirrored(box->dir, shot, cornea, g->x, g->y) || !mirrored(l, shot, cornea, g->x - w, g->y)
	    || !mirrored(r, shot, cornea, g->x + w, g->y) || !mirrored(t, shot, cornea, g->x, g->y - h)
	    || !mirrored(b, shot, cornea, g->x, g->y + h))
		return false;
	box->half[0] = fmin(fmax(angle(l, r) / 2, 0.01), 0.7);
	box->half[1] = fmin(fmax(angle(t, b) / 2, 0.01), 0.7);
	for (int c = 0; c < 3; c++)
		box->rgb[c] = g->rgb[c] / mirror_at_normal;
	box->hot = 0;  // a glint that clips tells nothing of it
	return true;
}

struct envmap light_studio(int height)
{
	static const double ceiling[3] = { 0.74, 0.76, 0.80 }, floor[3] = { 0.34, 0.33, 0.32 }, deg = M_PI / 180;
	// Key, fill, and a strip from above: where they stand seen from the camera, degrees to the right and upwards.
	static const double at[3][2] = { { -36, 34 }, { 46, 8 }, { 14, 74 } };
	static const double half[3][2] = { { 8, 10.5 }, { 4.5, 9 }, { 22, 5 } };
	static const double rgb[3][3] = { { 27, 26.6, 26 }, { 9, 9, 9.3 }, { 2, 2, 2 } };
	struct envmap_box boxes[3];
	for (int i = 0; i < 3; i++) {
		double x = sin(at[i][0] * deg) * cos(at[i][1] * deg), y = -sin(at[i][1] * deg);
		boxes[i] = (struct envmap_box){ { x, y, -sqrt(1 - x * x - y * y) }, { half[i][0] * deg, half[i][1] * deg },
		                                { rgb[i][0], rgb[i][1], rgb[i][2] }, 0.75 };
	}
	struct envmap env = envmap_room(height, ceiling, floor, 0.15, 3, boxes);
	envmap_normalise(&env);
	return env;
}

struct envmap light_window(int height)
{
	static const double ceiling[3] = { 0.36, 0.33, 0.29 }, floor[3] = { 0.20, 0.17, 0.14 }, deg = M_PI / 180;
	// Four panes in a wall to the left, and the glow of the wall opposite.
	static const double at[5][2] = { { -52, 27 }, { -33, 27 }, { -52, 2 }, { -33, 2 }, { 70, 5 } };
	struct envmap_box boxes[5];
	for (int i = 0; i < 5; i++) {
		const double x = sin(at[i][0] * deg) * cos(at[i][1] * deg), y = -sin(at[i][1] * deg), day = i < 4 ? 14 : 0.9;
		boxes[i] = (struct envmap_box){ { x, y, -sqrt(1 - x * x - y * y) }, { (i < 4 ? 8 : 25) * deg, (i < 4 ? 11.5 : 30) * deg },
		                                { day * (i < 4 ? 0.90 : 1.1), day, day * (i < 4 ? 1.16 : 0.86) }, i < 4 ? 0 : 1 };
	}
	struct envmap env = envmap_room(height, ceiling, floor, 0.4, 5, boxes);
	envmap_normalise(&env);
	return env;
}

struct envmap light_sky(int height)
{
	static const double zenith[3] = { 2.5, 2.7, 3.0 }, ground[3] = { 0.20, 0.19, 0.16 };
	struct envmap env = envmap_room(height, zenith, ground, 1, 0, 0);
	envmap_normalise(&env);
	return env;
}

/* Takes off the lamps what colour they have together; their differences stay. */
static void even_hue(int n, struct envmap_box boxes[])
{
	double sum[3] = { 0 };
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			sum[c] += boxes[i].rgb[c] * boxes[i].half[0] * boxes[i].half[1];
	const double mean = 0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2];
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			boxes[i].rgb[c] *= sum[c] > 0 ? mean / sum[c] : 1;
}

struct envmap light_of_photo(const struct shot *shot, const struct eye *eye, int height, const double white[3], bool balanced, struct envmap *lamps, int *n)
{
	static const double dark[3] = { 0 };
	struct glint glints[GLINTS_MAX];
	struct envmap_box boxes[GLINTS_MAX];
	struct cornea cornea = eye_cornea(eye);
	int got = glints_find(glints, shot);
	*n = 0;
	for (int i = 0; i < got; i++)
		*n += lamp(&boxes[*n], &glints[i], shot, &cornea);
	*lamps = envmap_room(height, dark, dark, 1, *n, boxes);
	if (!*n)
		return light_studio(height);
	if (balanced)
		even_hue(*n, boxes);
	// The room gives the rest of the light, at least a fifth.
	const double exposure = 0.2126 * white[0] + 0.7152 * white[1] + 0.0722 * white[2];
	for (int i = 0; i < *n; i++)
		for (int c = 0; c < 3; c++)
			boxes[i].rgb[c] /= exposure;
	double level = envmap_level(lamps) / exposure, room = fmax(1 - level, 0.2 * fmax(level, 1));
	struct envmap env = envmap_room(height, (double[3]){ 1.3 * room, 1.3 * room, 1.3 * room },
	                                (double[3]){ 0.7 * room, 0.7 * room, 0.7 * room }, 1, *n, boxes);
	envmap_normalise(&env);
	return env;
}
