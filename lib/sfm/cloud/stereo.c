#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"
#include "sfm/cloud/cloud.h"

/* A rectified pair: two pictures of one size whose rows are corresponding epipolar lines. */
struct rectified {
	double R[3][3];           // rect_from_world: x along the baseline, z between the two views
	double focal;             // px
	double center[2][3];      // of the cameras, world
	double middle[2][2];      // principal points, px
	int width, height;
	int min_disparity, range; // of x_left - x_right
	int left;                 // which of the two is on the left
};

static void frame(struct rectified *r, const struct colmap_image *im[2])
{
	double z[3] = { 0 }, R[3][3], x[3];
	for (int i = 0; i < 2; i++) {
		colmap_center(r->center[i], im[i]);
		colmap_rotation(R, im[i]->q);
		vec_add(z, z, 1, R[2]);
	}
	vec_add(x, r->center[1], -1, r->center[0]);
	vec_unit(x, x);
	// The pictures stay as upright as the first one: the baseline then points left or right.
	colmap_rotation(R, im[0]->q);
	double y[3];
	vec_cross(y, z, x);
	bool flip = vec_dot(y, R[1]) < 0;
	for (int i = 0; i < 3; i++)
		x[i] = flip ? -x[i] : x[i];
	vec_cross(y, z, x);
	vec_unit(r->R[1], y);
	memcpy(r->R[0], x, sizeof x);
	vec_cross(r->R[2], r->R[0], r->R[1]);
	r->left = flip ? 1 : 0;
}

/* Range of the values without the outermost ones, with a margin of a share of its width. */
static void span(double *low, double *high, int n, double *x, double margin)
{
	const double outermost = 0.01;
	*low = stats_quantile(n, x, outermost);
	*high = stats_quantile(n, x, 1 - outermost);
	double more = margin * (*high - *low);
	*low -= more;
	*high += more;
}

/* Points of the model in the ball that one of the two images sees, projected to the rectified cameras' plane at focal length 1: x, y of
 * the left one and x of the other; n of them. */
static int outline(double *xyo[3], const struct rectified *r, const struct colmap_model *m,
                   const struct colmap_image *im[2], const struct sfm_subject *s)
{
	int n = 0;
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < im[i]->n_seen; k++) {
			if (im[i]->seen[k].point < 0)
				continue;
			const double *xyz = m->points[im[i]->seen[k].point].xyz;
			double from[3], d[3], left[3], other[3];
			vec_add(from, xyz, -1, s->center);
			vec_add(d, xyz, -1, r->center[r->left]);
			mat_vec(left, r->R, d);
			vec_add(d, xyz, -1, r->center[1 - r->left]);
			mat_vec(other, r->R, d);
			if (vec_norm(from) > s->radius || !(left[2] > 0.02 * s->radius))
				continue;
			xyo[0][n] = left[0] / left[2];
			xyo[1][n] = left[1] / left[2];
			xyo[2][n++] = other[0] / other[2];
		}
	return n;
}

/* Chooses focal length, size and range of disparities so that what both see of the subject fills the pictures. False when that is next
 * to nothing. */
static bool fit(struct rectified *r, const struct colmap_model *m, const struct colmap_image *im[2],
                const struct sfm_subject *s, const struct cloud_conf *conf, double focal_limit)
{
	enum { FEWEST = 20, LARGEST = 8000 };
	const double margin = 0.12;
	double c[3], d[3], low[3], high[3], *xyo[3], room = (double)im[0]->n_seen + im[1]->n_seen + 1;
	vec_add(d, s->center, -1, r->center[r->left]);
	mat_vec(c, r->R, d);
	r->focal = fmin(focal_limit, conf->size_px * fmax(c[2], s->radius) / (2 * s->radius));
	for (int i = 0; i < 3; i++)
		xyo[i] = mem_array((size_t)room, sizeof(double));
	int n = outline(xyo, r, m, im, s);
	for (int i = 0; i < n; i++)
		xyo[2][i] = r->focal * (xyo[0][i] - xyo[2][i]);  // disparity
	if (n >= FEWEST)
		for (int i = 0; i < 3; i++)
			span(&low[i], &high[i], n, xyo[i], i < 2 ? margin : 2 * margin);
	for (int i = 0; i < 3; i++)
		free(xyo[i]);
	if (n < FEWEST)
		return false;
	r->width = (int)ceil(r->focal * (high[0] - low[0])) + 16;
	r->height = (int)ceil(r->focal * (high[1] - low[1])) + 16;
	// The other picture is shifted so that disparities begin at 0.
	r->middle[r->left][0] = 8 - r->focal * low[0];
	r->middle[1 - r->left][0] = r->middle[r->left][0] + floor(low[2]) - 2;
	r->middle[0][1] = r->middle[1][1] = 8 - r->focal * low[1];
	r->min_disparity = 0;
	r->range = (int)ceil(high[2] - floor(low[2])) + 4;
	return r->width < LARGEST && r->height < LARGEST && r->range < r->width;
}

/* For each rectified pixel its position in picture k. */
static bool warp(uint8_t *out, uint8_t *mask, const struct rectified *r, int k, const struct colmap_model *m,
                 const struct colmap_image *im, const struct cloud_picture *picture, struct err *err)
{
	struct camera camera;
	double focal[2], R[3][3], T[3][3], Q[3][3];
	const struct colmap_camera *c = &m->cameras[im->camera];
	if (!colmap_to_camera(&camera, focal, c, err))
		return false;
	colmap_rotation(R, im->q);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			T[i][j] = r->R[j][i];
	mat_mul(Q, R, T);
	double sx = (double)picture->width / c->width, sy = (double)picture->height / c->height;
	size_t n = (size_t)r->width * (size_t)r->height;
	float *x = mem_array(n, sizeof *x), *y = mem_array(n, sizeof *y);
	for (int v = 0; v < r->height; v++)
		for (int u = 0; u < r->width; u++) {
			double d[3] = { (u + 0.5 - r->middle[k][0]) / r->focal, (v + 0.5 - r->middle[k][1]) / r->focal, 1 }, p[3], px[2];
			mat_vec(p, Q, d);
			// A lens with two focal lengths is off by at most a few hundredths of a pixel of depth here.
			bool seen = camera_project(px, &camera, p);
			x[(long)v * r->width + u] = seen ? (float)(sx * px[0]) : -100;
			y[(long)v * r->width + u] = seen ? (float)(sy * px[1]) : -100;
		}
	bool ok = cv_warp8(out, mask, r->width, r->height, x, y, picture->grey, picture->width, picture->height, err);
	free(x);
	free(y);
	return ok;
}

/* Point in the left rectified camera's axes; false where there is no disparity. */
static bool point_at(double p[3], const struct rectified *r, double fb, const float *disparity, int x, int y)
{
	const double *left = r->middle[r->left], *right = r->middle[1 - r->left];
	double d = (double)disparity[(long)y * r->width + x] - left[0] + right[0];
	if (!(d > 0))
		return false;
	p[2] = fb / d;
	p[0] = (x + 0.5 - left[0]) / r->focal * p[2];
	p[1] = (y + 0.5 - left[1]) / r->focal * p[2];
	return true;
}

static void append(struct cloud_points *c, const double xyz[3], const double normal[3], double weight)
{
	if (c->n == c->room) {
		c->room = c->room ? 2 * c->room : 1 << 14;
		c->xyz = mem_grow(c->xyz, (size_t)c->room, sizeof *c->xyz);
		c->normal = mem_grow(c->normal, (size_t)c->room, sizeof *c->normal);
		c->weight = mem_grow(c->weight, (size_t)c->room, sizeof *c->weight);
	}
	for (int i = 0; i < 3; i++) {
		c->xyz[c->n][i] = (float)xyz[i];
		c->normal[c->n][i] = (float)normal[i];
	}
	c->weight[c->n++] = (float)weight;
}

/* Normal from the differences over a few pixels; false at an edge of the depth. */
static bool normal_at(double n[3], const struct rectified *r, double fb, const float *disparity, int x, int y)
{
	enum { STEP = 3 };
	double a[3], b[3], c[3], d[3], u[3], v[3];
	if (!point_at(a, r, fb, disparity, x - STEP, y) || !point_at(b, r, fb, disparity, x + STEP, y)
	    || !point_at(c, r, fb, disparity, x, y - STEP) || !point_at(d, r, fb, disparity, x, y + STEP))
		return false;
	vec_add(u, b, -1, a);
	vec_add(v, d, -1, c);
	vec_cross(n, v, u);
	vec_unit(n, n);
	return true;
}

static void take_points(struct cloud_points *points, const struct rectified *r, const float *disparity,
                        const struct sfm_subject *s, const struct cloud_conf *conf)
{
	enum { BORDER = 4 };
	double base[3], steep = cos(conf->max_slant);
	vec_add(base, r->center[1 - r->left], -1, r->center[r->left]);
	double fb = r->focal * vec_norm(base);
	for (int y = BORDER; y < r->height - BORDER; y++)
		for (int x = BORDER; x < r->width - BORDER; x++) {
			double p[3], n[3], world[3], normal[3], from[3], ray[3];
			if (!point_at(p, r, fb, disparity, x, y) || !normal_at(n, r, fb, disparity, x, y))
				continue;
			vec_unit(ray, p);
			double facing = -vec_dot(n, ray);
			mat_tvec(world, r->R, p);
			vec_add(world, world, 1, r->center[r->left]);
			vec_add(from, world, -1, s->center);
			if (!(facing > steep) || vec_norm(from) > s->radius)
				continue;
			mat_tvec(normal, r->R, n);
			// A disparity is known to a share of a pixel, the depth to z² / (focal base) of that.
			double sigma = p[2] * p[2] / fb * 0.3;
			append(points, world, normal, facing / (sigma * sigma));
		}
}

bool cloud_stereo(struct cloud_points *points, const struct colmap_model *m, const struct cloud_pair *pair,
                  const struct cloud_picture *a, const struct cloud_picture *b, const struct sfm_subject *subject,
                  const struct cloud_conf *conf, struct err *err)
{
	const struct colmap_image *im[2] = { &m->images[pair->a], &m->images[pair->b] };
	const struct cloud_picture *pictures[2] = { a, b };
	struct rectified r;
	double limit = INFINITY;
	frame(&r, im);
	for (int i = 0; i < 2; i++) {
		const struct colmap_camera *c = &m->cameras[im[i]->camera];
		limit = fmin(limit, c->params[0] * pictures[i]->width / c->width);
	}
	bool fits = fit(&r, m, im, subject, conf, limit);
	// Close by, the same surface spreads over more disparities than needed: the pictures are then made smaller.
	if (fits && r.range > conf->max_range)
		fits = fit(&r, m, im, subject, conf, r.focal * conf->max_range / r.range);
	if (!fits)
		return true;
	size_t n = (size_t)r.width * (size_t)r.height;
	uint8_t *grey[2], *mask[2];
	bool ok = true;
	for (int i = 0; i < 2; i++) {
		grey[i] = mem_array(n, 1);
		mask[i] = mem_array(n, 1);
		ok = ok && warp(grey[i], mask[i], &r, i, m, im[i], pictures[i], err);
	}
	// Noise alone spreads over more grey levels. Where there is no texture (burnt-out walls, black cloth) the matcher carries disparities
	// over from the nearest edge, in all pairs alike, so that their agreement does not reject them.
	enum { PLAIN_REACH = 5, PLAIN_LEVELS = 3 };
	float *disparity = mem_array(n, sizeof *disparity);
	ok = ok && cv_mask_plain(mask[r.left], grey[r.left], r.width, r.height, PLAIN_REACH, PLAIN_LEVELS, err) && cv_stereo(disparity, grey[r.left], grey[1 - r.left], mask[r.left], r.width, r.height, r.min_disparity, r.range,
	                     &conf->stereo, err);
	if (ok)
		take_points(points, &r, disparity, subject, conf);
	for (int i = 0; i < 2; i++) {
		free(grey[i]);
		free(mask[i]);
	}
	free(disparity);
	return ok;
}

void cloud_points_free(struct cloud_points *points)
{
	free(points->xyz);
	free(points->normal);
	free(points->weight);
	*points = (struct cloud_points){ 0 };
}
