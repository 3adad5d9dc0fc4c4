#include "track/head/shade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "image/image.h"
#include "math/chol.h"
#include "math/stats.h"
#include "math/vec.h"
#include "mesh/ray.h"

enum { LIGHT = 9, POSE = 6, POINTS = 4000, AROUND = 128, ROBUST = 4, LEAST = 200 };
static const double facing = 0.25;     // cosine to the camera, below which skin is foreshortened
static const double scale = 1.5;       // of the robust weights, in the brightness' spread
static const double dark = 0.01;       // of white: below it a camera tells no ratios
static const float lift = 0.3F;        // mm: rays begin off the skin

struct head_shape {
	int n;
	double area;           // mm^2, of the skin that they are spread over
	double middle[3];      // of the points
	double (*at)[3], (*normal)[3], (*light)[LIGHT];  // light: brightness under each harmonic
	struct ray_scene *rays;
};

/* Evenly spread directions (a spiral). */
static void around(double d[3], int i)
{
	const double z = 1 - (2 * i + 1.0) / AROUND, r = sqrt(1 - z * z), turn = M_PI * (1 + sqrt(5)) * (i + 0.5);
	d[0] = r * cos(turn);
	d[1] = r * sin(turn);
	d[2] = z;
}

static void harmonics(double y[LIGHT], const double d[3])
{
	const double all[LIGHT] = { 1, d[0], d[1], d[2], d[0] * d[1], d[1] * d[2], 3 * d[2] * d[2] - 1, d[0] * d[2], d[0] * d[0] - d[1] * d[1] };
	memcpy(y, all, sizeof all);
}

static void see(double light[LIGHT], const struct ray_scene *rays, const double at[3], const double normal[3])
{
	float from[3], to[3];
	for (int k = 0; k < 3; k++)
		from[k] = (float)at[k] + lift * (float)normal[k];
	memset(light, 0, LIGHT * sizeof *light);
	for (int i = 0; i < AROUND; i++) {
		double d[3], y[LIGHT];
		around(d, i);
		const double c = vec_dot(d, normal);
		for (int k = 0; k < 3; k++)
			to[k] = (float)d[k];
		if (!(c > 0) || ray_blocked(rays, from, to, 0, INFINITY))
			continue;
		harmonics(y, d);
		for (int k = 0; k < LIGHT; k++)
			light[k] += c * y[k] / AROUND;
	}
}

static bool is_skin(const double at[3], const double eye[2][3], const struct head_shade_conf *conf)
{
	double near = INFINITY, middle[3] = { 0 }, d[3];
	int eyes = 0;
	for (int e = 0; e < 2; e++) {
		if (!isfinite(eye[e][0]))
			continue;
		vec_add(d, at, -1, eye[e]);
		near = fmin(near, vec_norm(d));
		vec_add(middle, middle, 1, eye[e]);
		eyes++;
	}
	for (int k = 0; k < 3 && eyes; k++)
		middle[k] /= eyes;
	vec_add(d, at, -1, middle);
	return eyes && near > conf->away && vec_norm(d) < conf->reach;
}

static double corners(double p[3][3], const struct mesh *mesh, int face)
{
	double a[3], b[3], n[3];
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3; c++)
			p[k][c] = (double)mesh->vertices[mesh->faces[face][k]][c];
	vec_add(a, p[1], -1, p[0]);
	vec_add(b, p[2], -1, p[0]);
	vec_cross(n, a, b);
	return vec_norm(n) / 2;
}

/* One point for each `pitch` of area, wherever in its triangle: at a place that goes round with the points. */
static void spread(struct head_shape *s, const struct mesh *mesh, const double eye[2][3], const float (*normals)[3], double pitch, const struct head_shade_conf *conf)
{
	double sum = 0.5 * pitch;
	for (int f = 0; f < mesh->n_faces; f++) {
		double p[3][3];
		const double area = corners(p, mesh, f);
		for (sum += area; sum >= pitch && s->n < POINTS; sum -= pitch) {
			double u = fmod(0.5 + 0.754877666 * s->n, 1), v = fmod(0.5 + 0.569840291 * s->n, 1), w[3], at[3] = { 0 }, n[3] = { 0 };
			if (u + v > 1) {
				u = 1 - u;
				v = 1 - v;
			}
			w[0] = 1 - u - v, w[1] = u, w[2] = v;
			for (int k = 0; k < 3; k++)
				for (int c = 0; c < 3; c++) {
					at[c] += w[k] * p[k][c];
					n[c] += w[k] * (double)normals[mesh->faces[f][k]][c];
				}
			if (!is_skin(at, eye, conf) || !(vec_norm(n) > 0))
				break;  // so large a face has no second point that is
			memcpy(s->at[s->n], at, sizeof at);
			vec_unit(s->normal[s->n++], n);
		}
		sum = fmod(sum, pitch);
	}
}

struct head_shape *head_shape_new(const struct mesh *mesh, const double eye[2][3], const struct head_shade_conf *conf)
{
	float (*normals)[3] = mesh_normals(mesh);
	struct head_shape *s = mem_new(1, sizeof *s);
	double area = 0;
	s->at = mem_array(POINTS, sizeof *s->at);
	s->normal = mem_array(POINTS, sizeof *s->normal);
	s->light = mem_array(POINTS, sizeof *s->light);
	for (int f = 0; f < mesh->n_faces; f++) {
		double p[3][3], middle[3];
		const double own = corners(p, mesh, f);
		for (int c = 0; c < 3; c++)
			middle[c] = (p[0][c] + p[1][c] + p[2][c]) / 3;
		area += is_skin(middle, eye, conf) ? own : 0;
	}
	s->area = area;
	if (area > 0)
		spread(s, mesh, eye, (const float(*)[3])normals, area / (POINTS - 1), conf);
	free(normals);
	if (s->n < LEAST) {
		head_shape_free(s);
		return 0;
	}
	s->rays = ray_scene_new(mesh->n_vertices, (const float(*)[3])mesh->vertices, mesh->n_faces, (const int32_t(*)[3])mesh->faces);
#pragma omp parallel for schedule(dynamic, 64)
	for (int i = 0; i < s->n; i++)
		see(s->light[i], s->rays, s->at[i], s->normal[i]);
	for (int i = 0; i < s->n; i++)
		vec_add(s->middle, s->middle, 1.0 / s->n, s->at[i]);
	return s;
}

void head_shape_free(struct head_shape *s)
{
	if (!s)
		return;
	ray_scene_free(s->rays);
	free(s->at);
	free(s->normal);
	free(s->light);
	free(s);
}

bool head_picture_make(struct head_picture *out, const uint8_t *rgb, int width, int height, double blur_px)
{
	const int smaller = (int)fmax(1, floor(blur_px / 2));
	struct err err = { 0 };
	const size_t area = (size_t)width * (size_t)height;
	float *red = mem_array(area, sizeof *red);
	*out = (struct head_picture){ (width + smaller - 1) / smaller, (height + smaller - 1) / smaller, 0, 0 };
	out->scale = (double)width / out->width;
	for (size_t i = 0; i < area; i++)
		red[i] = linear_from_srgb((float)rgb[3 * i] / 255);
	out->ln = mem_array((size_t)out->width * (size_t)out->height, sizeof *out->ln);
	bool ok = cv_resize(out->ln, out->width, out->height, red, width, height, 1, &err);
	for (long i = 0; ok && i < (long)out->width * out->height; i++)
		out->ln[i] = logf(out->ln[i] + (float)dark);
	ok = ok && cv_blur(out->ln, out->ln, out->width, out->height, 1, blur_px / out->scale, &err);
	free(red);
	if (!ok) {
		free(out->ln);
		out->ln = 0;
	}
	return ok;
}

/* Bilinear; x, y within the picture by a pixel and a half. */
static double sample(const struct head_picture *p, double x, double y)
{
	const int i = (int)x, j = (int)y;
	const double u = x - i, v = y - j;
	const float *a = p->ln + (size_t)j * (size_t)p->width + i, *b = a + p->width;
	return (1 - v) * ((1 - u) * (double)a[0] + u * (double)a[1]) + v * ((1 - u) * (double)b[0] + u * (double)b[1]);
}

/* A point in sight: its brightness, and how that changes with the pose. */
struct seen {
	const double *light;
	double ln, pose[POSE], area;   // area: that a point stands for in the picture, over that from in front
	double off, weight;
};

static bool look(struct seen *out, const struct head_shape *s, int i, const struct head_picture *picture, const struct camera *camera, const double m[4][4], const double pivot[3])
{
	double p[3], n[3], px[2], to[3], head[3];
	float from[3], dir[3];
	head_from(p, m, s->at[i]);
	for (int r = 0; r < 3; r++)
		n[r] = m[r][0] * s->normal[i][0] + m[r][1] * s->normal[i][1] + m[r][2] * s->normal[i][2];
	const double away = vec_norm(p);
	out->area = -vec_dot(n, p) / away;
	if (!(out->area > facing) || !camera_project(px, camera, p))
		return false;
	const double x = px[0] / picture->scale - 0.5, y = px[1] / picture->scale - 0.5;
	if (!(x > 2 && y > 2 && x < picture->width - 3 && y < picture->height - 3))
		return false;
	head_to(head, m, (const double[3]){ 0 });  // the camera
	vec_add(to, head, -1, s->at[i]);
	for (int k = 0; k < 3; k++) {
		from[k] = (float)s->at[i][k] + lift * (float)s->normal[i][k];
		dir[k] = (float)(to[k] / away);
	}
	if (ray_blocked(s->rays, from, dir, 0, INFINITY))
		return false;
	const double gx = (sample(picture, x + 1, y) - sample(picture, x - 1, y)) / (2 * picture->scale), gy = (sample(picture, x, y + 1) - sample(picture, x, y - 1)) / (2 * picture->scale);
	const double f = camera->focal_px / p[2], arm[3] = { p[0] - pivot[0], p[1] - pivot[1], p[2] - pivot[2] };
	const double g[3] = { gx * f, gy * f, -f * (gx * p[0] + gy * p[1]) / p[2] };
	out->ln = sample(picture, x, y);
	vec_cross(out->pose, arm, g);
	memcpy(out->pose + 3, g, sizeof g);
	out->light = s->light[i];
	return true;
}

/* Brightness of a point under a light, at least a thousandth of what is seen: its logarithm is taken. */
static double lit(const struct seen *s, const double c[LIGHT])
{
	double is = 0;
	for (int k = 0; k < LIGHT; k++)
		is += c[k] * s->light[k];
	return fmax(is, 1e-3 * exp(s->ln));
}

/* Normal equations of the light's numbers. ln: brightness is exp(ln); else as it is. Returns false where they do not tell them. */
static bool light_step(double c[LIGHT], int n, const struct seen *s, bool ln)
{
	double a[LIGHT][LIGHT] = { { 0 } }, b[LIGHT] = { 0 };
	for (int i = 0; i < n; i++) {
		const double is = lit(&s[i], c);
		double row[LIGHT], off;
		for (int k = 0; k < LIGHT; k++)
			row[k] = s[i].light[k] / (ln ? is : 1);
		off = ln ? s[i].ln - log(is) : exp(s[i].ln);
		for (int k = 0; k < LIGHT; k++) {
			b[k] += s[i].weight * row[k] * off;
			for (int j = 0; j <= k; j++)
				a[k][j] += s[i].weight * row[k] * row[j];
		}
	}
	double trace = 0;
	for (int k = 0; k < LIGHT; k++)
		trace += a[k][k] / LIGHT;
	for (int k = 0; k < LIGHT; k++)
		a[k][k] += 1e-6 * trace;  // what hardly any point tells stays small
	if (!chol_solve(LIGHT, LIGHT, &a[0][0], b))
		return false;
	for (int k = 0; k < LIGHT; k++)
		c[k] = (ln ? c[k] : 0) + b[k];
	return true;
}

/* Residuals and robust weights (Geman-McClure's). Returns the spread. */
static double weigh(int n, struct seen *s, const double c[LIGHT], double *work)
{
	for (int i = 0; i < n; i++) {
		s[i].off = s[i].ln - log(lit(&s[i], c));
		work[i] = s[i].off;
	}
	const double spread = fmax(stats_mad(n, work, 0), 0.01);
	for (int i = 0; i < n; i++) {
		const double x = s[i].off / (scale * spread), k = 1 / (1 + x * x);
		s[i].weight = s[i].area * k * k;
	}
	return spread;
}

/* The pose's normal equations, the light's numbers eliminated (Schur complement). sum: of the weights; square: mean residual, squared. */
static bool pose_step(double H[POSE][POSE], double g[POSE], double *sum, double *square, int n, const struct seen *s, const double c[LIGHT])
{
	enum { ALL = LIGHT + POSE };
	double a[ALL][ALL] = { { 0 } }, b[ALL] = { 0 };
	*sum = *square = 0;
	for (int i = 0; i < n; i++) {
		const double is = lit(&s[i], c);
		double row[ALL];
		for (int k = 0; k < LIGHT; k++)
			row[k] = -s[i].light[k] / is;
		memcpy(row + LIGHT, s[i].pose, sizeof s[i].pose);
		for (int k = 0; k < ALL; k++) {
			b[k] -= s[i].weight * row[k] * s[i].off;
			for (int j = 0; j <= k; j++)
				a[k][j] += s[i].weight * row[k] * row[j];
		}
		*sum += s[i].weight;
		*square += s[i].weight * s[i].off * s[i].off;
	}
	*square /= *sum;
	for (int j = 0; j < LIGHT; j++) {  // elimination of the first LIGHT unknowns, lower triangle
		const double pivot = a[j][j] + 1e-9 * *sum;
		if (!(pivot > 0))
			return false;
		for (int k = j + 1; k < ALL; k++) {
			const double by = a[k][j] / pivot;
			b[k] -= by * b[j];
			for (int l = j + 1; l <= k; l++)
				a[k][l] -= by * a[l][j];
		}
	}
	for (int k = 0; k < POSE; k++) {
		g[k] = b[LIGHT + k];
		for (int l = 0; l < POSE; l++)
			H[k][l] = a[LIGHT + (k > l ? k : l)][LIGHT + (k > l ? l : k)];
	}
	return true;
}

bool head_shade(struct head_form *out, const struct head_shape *s, const struct head_picture *picture, const struct camera *camera, const double cam_from_head[4][4],
                const struct head_shade_conf *conf)
{
	struct head_form form = { .n = 0 };
	struct seen *seen = mem_array(POINTS, sizeof *seen);
	double *work = mem_array(POINTS, sizeof *work), light[LIGHT] = { 0 }, sum, square;
	memcpy(form.cam_from_head, cam_from_head, sizeof form.cam_from_head);
	head_from(form.pivot, cam_from_head, s->middle);
	for (int i = 0; i < s->n; i++)
		if (look(&seen[form.n], s, i, picture, camera, cam_from_head, form.pivot)) {
			seen[form.n].weight = seen[form.n].area;
			form.n++;
		}
	bool ok = form.n >= LEAST && light_step(light, form.n, seen, false);
	for (int k = 0; ok && k < ROBUST; k++) {
		form.off = weigh(form.n, seen, light, work);
		ok = light_step(light, form.n, seen, true);
	}
	if (ok) {
		form.off = weigh(form.n, seen, light, work);
		ok = pose_step(form.info, form.best, &sum, &square, form.n, seen, light);
	}
	if (ok) {
		// mm^2 that a weight of 1 stands for, over those that err together
		const double independent = s->area * sum / (s->n * conf->patch * conf->patch);
		double a[POSE][POSE];
		for (int k = 0; k < POSE; k++)
			for (int l = 0; l < POSE; l++) {
				form.info[k][l] *= independent / (sum * square);
				a[k][l] = form.info[k][l];
			}
		for (int k = 0; k < POSE; k++)
			form.best[k] *= independent / (sum * square);
		ok = chol_solve(POSE, POSE, &a[0][0], form.best);
	}
	if (ok)
		*out = form;
	free(work);
	free(seen);
	return ok;
}

double head_shade_patches(const struct head_form *form, const struct head_shape *s, const struct head_shade_conf *conf)
{
	return s->area * form->n / (s->n * conf->patch * conf->patch);
}
