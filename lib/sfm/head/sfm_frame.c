#include "sfm/head/sfm_frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"

/* x of A x = b for symmetric positive A by Cramer's rule; false where A is close to singular. */
static bool solve3(double x[3], const double A[3][3], const double b[3])
{
	double c[3][3];
	for (int i = 0; i < 3; i++)
		vec_cross(c[i], A[(i + 1) % 3], A[(i + 2) % 3]);
	double det = vec_dot(A[0], c[0]), trace = A[0][0] + A[1][1] + A[2][2];
	if (!(fabs(det) > 1e-9 * trace * trace * trace / 27))
		return false;
	for (int i = 0; i < 3; i++)
		x[i] = (c[0][i] * b[0] + c[1][i] * b[1] + c[2][i] * b[2]) / det;
	return true;
}

static bool focus(double out[3], const struct colmap_model *m)
{
	double A[3][3] = { 0 }, b[3] = { 0 };
	for (int i = 0; i < m->n_images; i++) {
		double R[3][3], c[3];
		colmap_rotation(R, m->images[i].q);
		colmap_center(c, &m->images[i]);
		for (int r = 0; r < 3; r++)
			for (int k = 0; k < 3; k++) {
				double p = (r == k) - R[2][r] * R[2][k];
				A[r][k] += p;
				b[r] += p * c[k];
			}
	}
	return solve3(out, A, b);
}

static double distance(const double a[3], const double b[3])
{
	double d[3];
	vec_add(d, a, -1, b);
	return vec_norm(d);
}

bool sfm_subject(struct sfm_subject *out, const struct colmap_model *m, struct err *err)
{
	// Points farther than this share of the cameras' distance are background.
	const double background = 0.6;
	if (!focus(out->center, m))
		return err_set(err, "the photographs all look the same way: walk round the head");
	double *r = mem_array((size_t)(m->n_images > m->n_points ? m->n_images : m->n_points) + 1, sizeof *r);
	for (int i = 0; i < m->n_images; i++) {
		double c[3];
		colmap_center(c, &m->images[i]);
		r[i] = distance(c, out->center);
	}
	double far = background * stats_median(m->n_images, r);
	int n = 0;
	for (int i = 0; i < m->n_points; i++) {
		double d = distance(m->points[i].xyz, out->center);
		if (d < far)
			r[n++] = d;
	}
	out->radius = n ? fmin(far, SFM_SUBJECT_REACH * stats_median(n, r)) : 0;
	free(r);
	if (n < 10)
		return err_set(err, "the photographs do not look at one thing: keep the head in the middle of each");
	return true;
}

/* Reprojection residuals of a sight, px, and their Jacobian by the point. */
static bool sight_jacobian(double r[2], double J[2][3], const struct colmap_model *m, const struct sfm_sight *s,
                           const double xyz[3], struct err *err)
{
	const struct colmap_image *im = &m->images[s->image];
	struct camera camera;
	double focal[2], R[3][3], p[3], px[2], q[2];
	if (!colmap_to_camera(&camera, focal, &m->cameras[im->camera], err))
		return false;
	colmap_rotation(R, im->q);
	mat_vec(p, R, xyz);
	for (int i = 0; i < 3; i++)
		p[i] += im->t[i];
	if (!camera_project(px, &camera, p))
		return err_set(err, "a point lies behind a camera that sees it");
	for (int i = 0; i < 2; i++)
		r[i] = px[i] - s->px[i];
	const double h = 1e-6 * p[2];
	for (int k = 0; k < 3; k++) {
		double moved[3] = { p[0] + h * R[0][k], p[1] + h * R[1][k], p[2] + h * R[2][k] };
		if (!camera_project(q, &camera, moved))
			return err_set(err, "a point lies in a camera's own plane");
		for (int i = 0; i < 2; i++)
			J[i][k] = (q[i] - px[i]) / h;
	}
	return true;
}

/* The point nearest to all rays, from which Gauss-Newton starts. */
static bool midpoint(double xyz[3], const struct colmap_model *m, int n, const struct sfm_sight sights[], struct err *err)
{
	double A[3][3] = { 0 }, b[3] = { 0 };
	for (int i = 0; i < n; i++) {
		const struct colmap_image *im = &m->images[sights[i].image];
		struct camera camera;
		double focal[2], R[3][3], c[3], ray[3], d[3];
		if (!colmap_to_camera(&camera, focal, &m->cameras[im->camera], err))
			return false;
		camera_ray(ray, &camera, sights[i].px);
		colmap_rotation(R, im->q);
		mat_tvec(d, R, ray);
		colmap_center(c, im);
		for (int r = 0; r < 3; r++)
			for (int k = 0; k < 3; k++) {
				double p = (r == k) - d[r] * d[k];
				A[r][k] += p;
				b[r] += p * c[k];
			}
	}
	return solve3(xyz, A, b) || err_set(err, "its views lie too close together to tell how far it is");
}

bool sfm_triangulate(double xyz[3], double *sigma, const struct colmap_model *m, int n, const struct sfm_sight sights[],
                     double floor_px, struct err *err)
{
	double A[3][3], cost = 0;
	if (n < 2)
		return err_set(err, "seen in %d view, must be seen in at least 2", n);
	if (!midpoint(xyz, m, n, sights, err))
		return false;
	for (int step = 0; step < 10; step++) {
		double b[3] = { 0 }, d[3];
		memset(A, 0, sizeof A);
		cost = 0;
		for (int i = 0; i < n; i++) {
			double r[2] = { 0 }, J[2][3] = { 0 };
			if (!sight_jacobian(r, J, m, &sights[i], xyz, err))
				return false;
			for (int a = 0; a < 2; a++)
				for (int k = 0; k < 3; k++) {
					b[k] -= J[a][k] * r[a];
					for (int l = 0; l < 3; l++)
						A[k][l] += J[a][k] * J[a][l];
				}
			cost += r[0] * r[0] + r[1] * r[1];
		}
		if (!solve3(d, A, b))
			return err_set(err, "its views lie too close together to tell how far it is");
		vec_add(xyz, xyz, 1, d);
	}
	double variance = fmax(floor_px * floor_px, cost / (2 * n - 3)), sum = 0;
	for (int k = 0; k < 3; k++) {
		double e[3] = { k == 0, k == 1, k == 2 }, column[3];
		if (!solve3(column, A, e))
			return err_set(err, "its views lie too close together to tell how far it is");
		sum += column[k];
	}
	*sigma = sqrt(variance * sum);
	return true;
}

double sfm_scale(double *sigma, int n, const struct sfm_length lengths[])
{
	double weight = 0, sum = 0, scatter = 0;
	for (int i = 0; i < n; i++) {
		double w = 1 / (lengths[i].sigma * lengths[i].sigma);
		weight += w;
		sum += w * log(lengths[i].mm / lengths[i].world);
	}
	double mean = sum / weight;
	for (int i = 0; i < n; i++) {
		double d = (log(lengths[i].mm / lengths[i].world) - mean) / lengths[i].sigma;
		scatter += d * d;
	}
	*sigma = sqrt(fmax(1, n > 1 ? scatter / (n - 1) : 1) / weight);
	return exp(mean);
}

/* The head's axes as rows: y up, z the part of `front` perpendicular to it, x = y x z. */
static void axes(double R[3][3], const double up[3], const double front[3])
{
	vec_unit(R[1], up);
	vec_add(R[2], front, -vec_dot(front, R[1]), R[1]);
	if (vec_norm(R[2]) < 1e-9) {
		double any[3] = { fabs(R[1][0]) < 0.7, fabs(R[1][0]) >= 0.7, 0 };
		vec_add(R[2], any, -vec_dot(any, R[1]), R[1]);
	}
	vec_unit(R[2], R[2]);
	vec_cross(R[0], R[1], R[2]);
}

static void place_origin(struct sfm_frame *f, const double origin[3])
{
	mat_vec(f->t, f->R, origin);
	for (int i = 0; i < 3; i++)
		f->t[i] *= -f->scale;
}

/* Sums of the pictures' up directions, and of the directions from the middle to the cameras. */
static void mean_directions(double up[3], double front[3], const struct colmap_model *m, const double middle[3])
{
	for (int i = 0; i < 3; i++)
		up[i] = front[i] = 0;
	for (int i = 0; i < m->n_images; i++) {
		double R[3][3], c[3], d[3];
		colmap_rotation(R, m->images[i].q);
		colmap_center(c, &m->images[i]);
		vec_add(d, c, -1, middle);
		vec_add(up, up, -1, R[1]);
		vec_add(front, front, 1 / vec_norm(d), d);
	}
}

void sfm_frame_cameras(struct sfm_frame *f, const struct colmap_model *m, const struct sfm_subject *subject, double scale)
{
	double up[3], front[3];
	f->scale = scale;
	mean_directions(up, front, m, subject->center);
	axes(f->R, up, front);
	place_origin(f, subject->center);
}

void sfm_frame_eyes(struct sfm_frame *f, const struct colmap_model *m, const double left[3], const double right[3],
                    const double *mouth, double scale)
{
	double x[3], up[3], front[3], middle[3];
	f->scale = scale;
	vec_add(x, left, -1, right);
	vec_add(middle, right, 0.5, x);
	mean_directions(up, front, m, middle);
	if (mouth)
		vec_add(up, middle, -1, mouth);
	// Up is made perpendicular to the line of the eyes; x and up then give the direction of the face.
	vec_unit(x, x);
	vec_add(up, up, -vec_dot(up, x), x);
	vec_cross(front, x, up);
	axes(f->R, up, front);
	place_origin(f, middle);
}

void sfm_to_head(double head[3], const struct sfm_frame *f, const double world[3])
{
	double p[3];
	mat_vec(p, f->R, world);
	for (int i = 0; i < 3; i++)
		head[i] = f->scale * p[i] + f->t[i];
}

void sfm_cam_from_head(double m[4][4], const struct sfm_frame *f, const struct colmap_image *image)
{
	double R[3][3], T[3][3], Q[3][3], moved[3];
	colmap_rotation(R, image->q);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			T[i][j] = f->R[j][i];
	mat_mul(Q, R, T);
	mat_vec(moved, Q, f->t);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			m[i][j] = Q[i][j];
		m[i][3] = f->scale * image->t[i] - moved[i];
		m[3][i] = 0;
	}
	m[3][3] = 1;
}
