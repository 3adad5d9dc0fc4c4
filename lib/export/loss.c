#include "export/loss.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/sclera.h"
#include "draw/eye/surface.h"
#include "export/eye_mesh.h"
#include "export/outside.h"
#include "image/colour.h"
#include "math/vec.h"

struct view_of {
	const struct scene *scene;
	const struct image *maps;
	const struct scene_view *view;
	const struct envmap *env;
	double origin[3];  // of the camera, in the eye's frame
};

/* A pixel's ray and where it meets the eye; eye's frame. */
struct met {
	double ray[3], at[3], normal[3], rho, cos_i, white;
};

static void to_cam(float out[3], const struct scene_view *v, const double a[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (float)(v->cam_from_eye[i][0] * a[0] + v->cam_from_eye[i][1] * a[1] + v->cam_from_eye[i][2] * a[2]);
}

static void meet(struct met *m, const struct view_of *o, int x, int y, double depth)
{
	const struct scene_view *v = o->view;
	double px[2] = { v->x0 + v->scale * (x + 0.5), v->y0 + v->scale * (y + 0.5) }, cam[3];
	camera_ray(cam, &v->camera, px);
	for (int j = 0; j < 3; j++)
		m->ray[j] = v->cam_from_eye[0][j] * cam[0] + v->cam_from_eye[1][j] * cam[1] + v->cam_from_eye[2][j] * cam[2];
	vec_add(m->at, o->origin, depth / cam[2], m->ray);
	export_normal(m->normal, o->scene, m->at);
	m->cos_i = fmax(-vec_dot(m->normal, m->ray), 0);
	m->rho = m->at[2] < o->scene->sclera_z ? export_rho(o->scene, m->at[0], m->at[1]) : 2;
	m->white = export_white(o->scene, m->rho);
}

static void sample(float *out, const struct image *map, double x, double y, double half)
{
	for (int c = 0; c < map->channels; c++)
		out[c] = image_sample(map, (x / half + 1) * 0.5 * map->width, (y / half + 1) * 0.5 * map->height, c);
}

/* Where the ray from a to b meets the iris plane. Returns false when it does not. */
static bool on_iris(double at[2], const struct scene *s, const double a[3], const double d[3])
{
	double t = (s->eye.iris_depth - a[2]) / d[2];
	at[0] = a[0] + t * d[0];
	at[1] = a[1] + t * d[1];
	return d[2] > 1e-3 && t > 0 && hypot(at[0], at[1]) < s->extent;
}

/* The points of the iris plane that this pixel shows and ought to show. */
static bool iris_points(double shown[2], double right[2], const struct met *m, const struct view_of *o)
{
	double in[3], out[3], d[3];
	float depth;
	if (!refract(in, m->ray, m->normal, 1, o->scene->cornea.n))
		return false;
	sample(&depth, &o->maps[EXPORT_CORNEA_DEPTH], m->at[0], m->at[1], export_cornea_extent(o->scene));
	vec_add(out, m->at, depth, in);
	for (int i = 0; i < 3; i++)
		d[i] = out[i] - o->origin[i];
	vec_unit(d, d);
	const bool seen = on_iris(shown, o->scene, o->origin, d);
	return on_iris(right, o->scene, m->at, in) && seen;
}

static void lit(float rgb[3], const struct view_of *o, const float albedo[3], const double normal[3])
{
	float cam[3], light[3];
	to_cam(cam, o->view, normal);
	envmap_irradiance(light, o->env, cam);
	for (int c = 0; c < 3; c++)
		rgb[c] = albedo[c] * light[c];
}

static void iris_shown(float rgb[3], const struct view_of *o, const double at[2])
{
	const struct scene *s = o->scene;
	float albedo[3], n[3];
	if (hypot(at[0] - s->pupil[0], at[1] - s->pupil[1]) < s->pupil[2]) {
		rgb[0] = rgb[1] = rgb[2] = 0;
		return;
	}
	sample(albedo, &o->maps[EXPORT_IRIS_ALBEDO], at[0], at[1], s->extent);
	sample(n, &o->maps[EXPORT_IRIS_NORMAL], at[0], at[1], s->extent);
	double leans[3] = { export_normal_scale * n[0], -export_normal_scale * n[1], -n[2] };
	vec_unit(leans, leans);
	lit(rgb, o, albedo, leans);
}

static void eye_shown(float rgb[3], const struct view_of *o, const struct met *m, const double *iris)
{
	float white[3], seen[3] = { 0 }, mirrored[3], cam[3];
	double angle = atan2(hypot(m->at[0], m->at[1]), o->scene->sclera_z - m->at[2]), flat = hypot(m->at[0], m->at[1]);
	double per = flat > 1e-9 ? angle / SCENE_SCLERA_REACH / flat : 0, n = o->scene->cornea.n, t = sqrt(n * n - 1 + m->cos_i * m->cos_i), r[3];
	sample(white, &o->maps[EXPORT_SCLERA_ALBEDO], per * m->at[0], per * m->at[1], 1);
	lit(white, o, white, m->normal);
	if (iris)
		iris_shown(seen, o, iris);
	double sp = (m->cos_i - t) / (m->cos_i + t), pp = (n * n * m->cos_i - t) / (n * n * m->cos_i + t), f = 0.5 * (sp * sp + pp * pp);
	vec_add(r, m->ray, 2 * m->cos_i, m->normal);
	to_cam(cam, o->view, r);
	envmap_at(mirrored, o->env, cam, (float)m->white);
	for (int c = 0; c < 3; c++)
		rgb[c] = (float)((1 - f) * (m->white * white[c] + (1 - m->white) * seen[c]) + f * mirrored[c]);
}

static int rising(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* What one row of a view adds up to. */
struct row {
	long iris, mm, eye;                       // pixels
	double sum_mm, most_mm, sum_eye, *de;     // de: [iris] differences
};

static void pixel(struct row *row, const struct view_of *o, const float *drawn, double depth, double gain, int x, int y)
{
	const struct scene *s = o->scene;
	struct met m;
	double shown[2], right[2];
	float a[3], p[3], q[3];
	meet(&m, o, x, y, depth);
	bool through = m.white < 1 && iris_points(shown, right, &m, o);
	if (through && hypot(right[0] - s->pupil[0], right[1] - s->pupil[1]) > s->pupil[2]) {
		double off = hypot(shown[0] - right[0], shown[1] - right[1]);
		row->sum_mm += off;
		row->most_mm = fmax(row->most_mm, off);
		row->mm++;
	}
	eye_shown(a, o, &m, through ? shown : 0);
	for (int c = 0; c < 3; c++) {
		p[c] = (float)gain * a[c];
		q[c] = (float)gain * drawn[c];
	}
	double d = colour_difference(p, q);
	row->sum_eye += d;
	row->eye++;
	if (m.white < 1)
		row->de[row->iris++] = d;
}

/* Adds up the rows in their order, so that threads change nothing. */
static struct export_loss added(const struct row *row, int n, int width)
{
	struct export_loss loss = { 0 };
	double *de = mem_new((size_t)n * (size_t)width + 1, sizeof *de);
	long iris = 0, mm = 0, eye = 0;
	for (int y = 0; y < n; y++) {
		memcpy(de + iris, row[y].de, (size_t)row[y].iris * sizeof *de);
		iris += row[y].iris;
		mm += row[y].mm;
		eye += row[y].eye;
		loss.mm_mean += row[y].sum_mm;
		loss.mm_most = fmax(loss.mm_most, row[y].most_mm);
		loss.de_eye += row[y].sum_eye;
	}
	qsort(de, (size_t)iris, sizeof *de, rising);
	for (long i = 0; i < iris; i++)
		loss.de_mean += de[i] / (double)iris;
	loss.de_95 = iris ? de[(long)(0.95 * (double)(iris - 1))] : 0;
	loss.mm_mean /= (double)(mm ? mm : 1);
	loss.de_eye /= (double)(eye ? eye : 1);
	free(de);
	return loss;
}

struct export_loss export_loss_of(const struct scene *s, const struct image maps[EXPORT_MAPS], const struct scene_view *view,
                                  const struct envmap *env, const struct image *drawn, double gain)
{
	enum { STEP = 2 };  // every second pixel of every second row
	struct view_of o = { s, maps, view, env, { 0 } };
	struct image surface = scene_surface(s, view);
	int n = view->height / STEP;
	struct row *row = mem_new((size_t)n + 1, sizeof *row);
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++)
			o.origin[j] -= view->cam_from_eye[i][j] * view->cam_from_eye[i][3];
#pragma omp parallel for schedule(dynamic, 4)
	for (int k = 0; k < n; k++) {
		row[k].de = mem_new((size_t)view->width + 1, sizeof *row[k].de);
		for (int x = 0; x < view->width; x += STEP) {
			double depth = image_at(&surface, x, STEP * k)[0];
			if (!isinf(depth) && image_at(drawn, x, STEP * k)[3] == 1)
				pixel(&row[k], &o, image_at(drawn, x, STEP * k), depth, gain, x, STEP * k);
		}
	}
	struct export_loss loss = added(row, n, view->width);
	for (int k = 0; k < n; k++)
		free(row[k].de);
	free(row);
	image_free(&surface);
	return loss;
}
