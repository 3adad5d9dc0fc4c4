#include "tests/lib/truth/tracked.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "math/rng.h"

/* An array of the truth as double; null where the clip has none (the eye is not in view). free(). */
static double *array(const char *npz, const char *name, long *last)
{
	struct npy a;
	struct err err = { 0 };
	if (!npz_read(&a, npz, name, NPY_LIMIT, &err))
		return 0;
	double *x = npy_doubles(&a);
	if (last)
		*last = a.ndim > 1 ? a.shape[1] : 1;
	npy_free(&a);
	return x;
}

/* px of the modelling camera of a point in the head, cm. */
static void project(double px[2], const struct skin_camera *c, const double head_cm[3])
{
	double p[3];
	for (int i = 0; i < 3; i++)
		p[i] = c->cam_from_head[i][0] * 10 * head_cm[0] + c->cam_from_head[i][1] * 10 * head_cm[1]
		       + c->cam_from_head[i][2] * 10 * head_cm[2] + c->cam_from_head[i][3];
	px[0] = c->center_px[0] + c->focal_px * p[0] / p[2];
	px[1] = c->center_px[1] + c->focal_px * p[1] / p[2];
}

static bool load_camera(struct tracked *t, const char *dir, const char *npz, struct err *err)
{
	char path[1100];
	snprintf(path, sizeof path, "%s/truth.json", dir);
	json_t *j = json_read(path, 1 << 24, err);
	double *R = array(npz, "head_R", 0), *at = array(npz, "head_t", 0);
	bool ok = j && R && at;
	if (ok) {
		const json_t *row = json_array_get(json_object_get(j, "K"), 0), *row1 = json_array_get(json_object_get(j, "K"), 1);
		t->camera = (struct skin_camera){ .width = 1280, .height = 720, .cam_from_head[3][3] = 1 };
		t->camera.focal_px = json_number_value(json_array_get(row, 0));
		t->camera.center_px[0] = json_number_value(json_array_get(row, 2));
		t->camera.center_px[1] = json_number_value(json_array_get(row1, 2));
		for (int i = 0; i < 3; i++) {
			memcpy(t->camera.cam_from_head[i], R + 3 * i, 3 * sizeof *R);
			t->camera.cam_from_head[i][3] = 10 * at[i];
		}
	}
	json_decref(j);
	free(R);
	free(at);
	return ok || err_is(err) || err_set(err, "%s: no head pose", npz);
}

/* A margin of m points in the head, resampled to TRACKED_POINTS of equal distance along it. */
static void margin(double (*out)[2], const struct skin_camera *camera, const double *head_cm, long m, double noise,
                   struct rng *rng)
{
	double px[64][2], along[64] = { 0 };
	for (long i = 0; i < m; i++) {
		project(px[i], camera, head_cm + 3 * i);
		along[i] = i ? along[i - 1] + hypot(px[i][0] - px[i - 1][0], px[i][1] - px[i - 1][1]) : 0;
	}
	for (int k = 0; k < TRACKED_POINTS; k++) {
		double to = along[m - 1] * k / (TRACKED_POINTS - 1);
		long i = 0;
		while (i < m - 2 && along[i + 1] < to)
			i++;
		double a = (to - along[i]) / (along[i + 1] - along[i]);
		for (int c = 0; c < 2; c++)
			out[k][c] = (1 - a) * px[i][c] + a * px[i + 1][c] + noise * rng_normal(rng);
	}
}

static void fill(double *x, size_t n, double value)
{
	for (size_t i = 0; i < n; i++)
		x[i] = value;
}

/* g4 and g5 from the middles of the margins: above and below where the lids meet in the most closed frame. */
static void apertures(struct tracked *t, int eye, const double *openness)
{
	enum { MIDDLE = TRACKED_POINTS / 2 };
	const double(*lid)[SKIN_LIDS][TRACKED_POINTS][2] = (const void *)t->lid;
	long shut = 0;
	for (long i = 1; i < t->n; i++)
		shut = openness[i] < openness[shut] ? i : shut;
	double plane = 0.5 * (lid[shut][2 * eye][MIDDLE][1] + lid[shut][2 * eye + 1][MIDDLE][1]);
	for (long i = 0; i < t->n; i++) {
		double *g = t->g + i * TRACKED_INPUTS + 5 * eye;
		g[3] = plane - lid[i][2 * eye][MIDDLE][1];
		g[4] = lid[i][2 * eye + 1][MIDDLE][1] - plane;
		t->confidence[2 * i + eye] = openness[i] < 0.25 ? 0 : 1;
		for (int k = 0; k < 3 && openness[i] < 0.25; k++)
			g[k] = NAN;
	}
}

static void load_eye(struct tracked *t, int eye, const char *npz, double noise, struct rng *rng)
{
	static const char *const sides[] = { "left", "right" };
	double(*lid)[SKIN_LIDS][TRACKED_POINTS][2] = (void *)t->lid;
	char name[64];
	long m[2];
	double *curve[2], *gaze, *openness;
	snprintf(name, sizeof name, "lid_upper_head_cm_%s", sides[eye]);
	curve[0] = array(npz, name, &m[0]);
	snprintf(name, sizeof name, "lid_lower_head_cm_%s", sides[eye]);
	curve[1] = array(npz, name, &m[1]);
	snprintf(name, sizeof name, "gaze_%s_deg", sides[eye]);
	gaze = array(npz, name, 0);
	snprintf(name, sizeof name, "openness_%s", sides[eye]);
	openness = array(npz, name, 0);
	for (long i = 0; i < t->n && curve[0] && curve[1] && gaze && openness; i++) {
		for (int k = 0; k < 2; k++)
			margin(lid[i][2 * eye + k], &t->camera, curve[k] + 3 * i * m[k], m[k], 0.6 * noise, rng);
		for (int k = 0; k < 3; k++)
			t->g[i * TRACKED_INPUTS + 5 * eye + k] = gaze[3 * i + k] + 0.3 * noise * rng_normal(rng);
	}
	if (curve[0] && curve[1] && gaze && openness)
		apertures(t, eye, openness);
	free(curve[0]);
	free(curve[1]);
	free(gaze);
	free(openness);
}

/* Action unit 0: the raised brow (browInnerUp_L, 8), 1: the squint (eyeSquint_L, 5); 1 at the peak. */
static void load_expressions(struct tracked *t, const char *npz)
{
	static const int columns[TRACKED_AU] = { 8, 5 };
	long width;
	double *au = array(npz, "au_weights", &width), top[TRACKED_AU] = { 0 };
	for (long i = 0; i < t->n && au; i++)
		for (int a = 0; a < TRACKED_AU; a++)
			top[a] = fmax(top[a], au[i * width + columns[a]]);
	for (long i = 0; i < t->n && au; i++)
		for (int a = 0; a < TRACKED_AU; a++)
			t->g[i * TRACKED_INPUTS + SKIN_EYE_INPUTS + a] = top[a] > 0 ? au[i * width + columns[a]] / top[a] : 0;
	free(au);
}

static void load_skin(struct tracked *t, const char *npz, double noise, struct rng *rng)
{
	double *cam = array(npz, "skin_cam_cm", 0), *R = array(npz, "head_R", 0), *at = array(npz, "head_t", 0);
	double *visible = array(npz, "skin_visible", 0), *rows = array(npz, "skin_vertex", 0);
	t->skin = mem_new((size_t)t->n * (size_t)t->n_vertices * 2, sizeof *t->skin);
	t->seen = visible;
	t->vertices = mem_new((size_t)t->n_vertices, sizeof *t->vertices);
	for (int v = 0; v < t->n_vertices; v++)
		t->vertices[v] = (int)rows[v];
	for (long i = 0; i < t->n; i++)
		for (int v = 0; v < t->n_vertices; v++) {
			const double *x = cam + 3 * (i * t->n_vertices + v), *r = R + 9 * i;
			double head[3], *px = t->skin + 2 * (i * t->n_vertices + v);
			for (int k = 0; k < 3; k++)
				head[k] = r[k] * (x[0] - at[3 * i]) + r[3 + k] * (x[1] - at[3 * i + 1]) + r[6 + k] * (x[2] - at[3 * i + 2]);
			project(px, &t->camera, head);
			for (int k = 0; k < 2; k++)
				px[k] = visible[i * t->n_vertices + v] > 0 ? px[k] + 0.3 * noise * rng_normal(rng) : NAN;
		}
	free(cam);
	free(R);
	free(at);
	free(rows);
}

bool tracked_load(struct tracked *t, const char *dir, double noise, struct err *err)
{
	char npz[1100];
	struct npy shape;
	struct rng rng = { 5 };
	*t = (struct tracked){ 0 };
	snprintf(npz, sizeof npz, "%s/truth.npz", dir);
	if (!npz_read(&shape, npz, "skin_visible", NPY_LIMIT, err) || !load_camera(t, dir, npz, err)) {
		npy_free(&shape);
		return false;
	}
	t->n = shape.shape[0];
	t->n_vertices = (int)shape.shape[1];
	npy_free(&shape);
	size_t n = (size_t)t->n;
	t->time = array(npz, "time_s", 0);
	t->g = mem_array(n * TRACKED_INPUTS, sizeof *t->g);
	t->confidence = mem_array(2 * n, sizeof *t->confidence);
	t->lid = mem_array(n * SKIN_LIDS * TRACKED_POINTS * 2, sizeof *t->lid);
	fill(t->g, n * TRACKED_INPUTS, NAN);
	fill(t->confidence, 2 * n, 0);
	fill(t->lid, n * SKIN_LIDS * TRACKED_POINTS * 2, NAN);
	for (int eye = 0; eye < 2; eye++)
		load_eye(t, eye, npz, noise, &rng);
	load_expressions(t, npz);
	load_skin(t, npz, noise, &rng);
	return true;
}

void tracked_free(struct tracked *t)
{
	free(t->time);
	free(t->g);
	free(t->confidence);
	free(t->lid);
	free(t->skin);
	free(t->seen);
	free(t->vertices);
	*t = (struct tracked){ 0 };
}

static bool read_frames(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	const struct tracked *t = ctx;
	size_t l = SKIN_LIDS * TRACKED_POINTS * 2, m = (size_t)t->n_vertices, f = (size_t)first, k = (size_t)n;
	(void)err;
	memcpy(lid, t->lid + f * l, k * l * sizeof *lid);
	memcpy(skin, t->skin + f * 2 * m, k * 2 * m * sizeof *skin);
	memcpy(seen, t->seen + f * m, k * m * sizeof *seen);
	return true;
}

struct train_clip tracked_clip(const struct tracked *t)
{
	struct train_clip clip = { .n = t->n, .n_au = TRACKED_AU, .n_points = TRACKED_POINTS, .n_vertices = t->n_vertices };
	clip.time = t->time;
	clip.g = t->g;
	clip.confidence = t->confidence;
	clip.read = read_frames;
	memcpy(&clip.ctx, &t, sizeof t);
	clip.place = "clip";
	return clip;
}

static bool save_floats(const char *dir, const char *name, int ndim, const long *shape, const double *x, struct err *err)
{
	struct npy array = { .type = NPY_F4, .ndim = ndim };
	memcpy(array.shape, shape, (size_t)ndim * sizeof *shape);
	size_t n = (size_t)npy_count(&array);
	float *f = mem_array(n, sizeof *f);
	for (size_t i = 0; i < n; i++)
		f[i] = (float)x[i];
	array.data = f;
	char *path = mem_printf("%s/%s", dir, name);
	bool ok = npy_save(path, &array, err);
	free(path);
	free(f);
	return ok;
}

static bool save_gaze(const struct tracked *t, const char *dir, struct err *err)
{
	static const char *const names[] = { "frame", "time_s", "g1_deg", "g2_deg", "g3_deg", "g4_px", "g5_px", "g6_deg", "g7_deg",
		                                 "g8_deg", "g9_px", "g10_px", "au1", "au2", "confidence_left", "confidence_right" };
	struct csv_table table = csv_table_new(COUNT(names), names);
	for (long i = 0; i < t->n; i++) {
		double row[COUNT(names)] = { (double)i, t->time[i] };
		memcpy(row + 2, t->g + i * TRACKED_INPUTS, TRACKED_INPUTS * sizeof *row);
		memcpy(row + 2 + TRACKED_INPUTS, t->confidence + 2 * i, 2 * sizeof *row);
		csv_add(&table, row);
	}
	char *path = mem_printf("%s/gaze.csv", dir);
	bool ok = csv_save(path, &table, err);
	csv_table_free(&table);
	free(path);
	return ok;
}

static bool save_track(const struct tracked *t, const char *dir, struct err *err)
{
	json_t *j = json_object(), *camera = json_object();
	json_object_set_new(camera, "width", json_integer(t->camera.width));
	json_object_set_new(camera, "height", json_integer(t->camera.height));
	json_object_set_new(camera, "focal_px", json_number(t->camera.focal_px));
	json_object_set_new(camera, "center_px", json_numbers(2, t->camera.center_px));
	json_object_set_new(camera, "distortion", json_numbers(5, t->camera.distortion));
	json_object_set_new(camera, "cam_from_head", json_numbers(16, &t->camera.cam_from_head[0][0]));
	json_object_set_new(j, "camera", camera);
	json_object_set_new(j, "reference_frame", json_integer(0));
	char *path = mem_printf("%s/track.json", dir);
	bool ok = json_write(path, j, 0, err);
	json_decref(j);
	free(path);
	return ok;
}

bool tracked_save(const struct tracked *t, const char *dir, struct err *err)
{
	long m = t->n_vertices;
	char *path = mem_printf("%s/vertices.npy", dir);
	struct npy rows = npy_of(NPY_I4, 1, &m, t->vertices);
	bool ok = save_gaze(t, dir, err) && save_track(t, dir, err) && npy_save(path, &rows, err)
	          && save_floats(dir, "lids.npy", 4, (long[]){ t->n, SKIN_LIDS, TRACKED_POINTS, 2 }, t->lid, err)
	          && save_floats(dir, "skin.npy", 3, (long[]){ t->n, m, 2 }, t->skin, err)
	          && save_floats(dir, "skin_model.npy", 3, (long[]){ t->n, m, 2 }, t->skin, err)
	          && save_floats(dir, "confidence.npy", 2, (long[]){ t->n, m }, t->seen, err);
	free(path);
	return ok;
}
