/* A driven character for the interactive page: its mesh as portrait.h poses and lights it, on a grid of gazes and apertures
 * between which the page interpolates. Lengths mm, in the head's axes about the middle of both eyes. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "math/vec.h"
#include "render/page.h"
#include "render/viewer_face_impl.h"
#include "skin/skin_look.h"

static const double at_h[NH] = { -32, -16, 0, 16, 32 }, at_v[NV] = { -22, 0, 22 }, at_a[NA] = { 0, 0.5, 1, 1.4 };
static const float reach = 110;  // mm about the eyes: what the page shows of the face

static void to_head(float out[3], const struct face *f, const float x[3], bool point)
{
	double d[3], h[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - (point ? f->middle[c] : 0);
	mat_vec(h, f->rig->head_from_target, d);
	for (int c = 0; c < 3; c++)
		out[c] = (float)h[c];
}

static uint8_t byte(double t)
{
	return (uint8_t)lrint(fmin(fmax(t, 0), 255));
}

/* The pose as it stands. */
static void record(uint8_t *to, const struct face *f)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	static const float up[3] = { 0, 0, 1 }, even[3] = { 0.8f, 0.8f, 0.8f };  // hairs know neither normal nor light
	for (int i = 0; i < f->n; i++, to += RECORD) {
		float x[3], n[3];
		const float *light = i < m->n ? m->light[i] : even;
		to_head(x, f, m->x[i], true);
		to_head(n, f, i < m->n ? m->normal[i] : up, false);
		for (int c = 0; c < 3; c++) {
			unsigned v = (unsigned)lrint(fmin(fmax((x[c] / (2 * reach) + 0.5) * 65535, 0), 65535));
			to[2 * c] = (uint8_t)(v & 255);
			to[2 * c + 1] = (uint8_t)(v >> 8);
			to[6 + c] = byte(127.5 + 127.5 * n[c]);
			to[9 + c] = byte(255 * sqrt(fmax(light[c], 0) / 3));
		}
	}
}

/* Share of the sky over places of both globes: their front halves, seen along the line of sight straight ahead. */
static void sky(uint8_t *to, const struct face *f)
{
	enum { RAYS = 20 };
	for (int side = 0; side < 2; side++)
		for (int k = 0; k < SKY * SKY; k++) {
			double x = (2 * (k % SKY) + 1.0) / SKY - 1, y = (2 * (k / SKY) + 1.0) / SKY - 1, z2 = 1 - x * x - y * y;
			double n[3] = { x, y, sqrt(fmax(z2, 0)) }, t[3], u[3], w[3], open = 0;
			vec_unit(n, n);
			mat_tvec(t, f->rig->head_from_target, n);
			vec_cross(u, t, fabs(t[0]) < 0.6 ? (double[]){ 1, 0, 0 } : (double[]){ 0, 1, 0 });
			vec_unit(u, u);
			vec_cross(w, t, u);
			for (int j = 0; j < RAYS; j++) {
				double r = sqrt((j + 0.5) / RAYS), turn = 2.399963 * j, up = sqrt(1 - r * r);
				float from[3], dir[3];
				for (int c = 0; c < 3; c++) {
					from[c] = (float)(f->rig->globe[side].center[c] + f->rig->globe[side].radius * t[c]);
					dir[c] = (float)(r * cos(turn) * u[c] + r * sin(turn) * w[c] + up * t[c]);
				}
				open += !ray_blocked(f->portrait->shadow, from, dir, 0.02f, 60);
			}
			to[(k / SKY) * 2 * SKY + side * SKY + k % SKY] = byte(255 * open / RAYS);
		}
}

static void pose_all(struct face *f)
{
	double *controls = mem_new((size_t)f->rig->n_inputs + 1, sizeof *controls);
	f->sky = mem_new((size_t)POSES * SKY * SKY, 2);
	f->record = mem_new((size_t)(POSES + f->n_au), sizeof *f->record);
	for (int k = 0; k < POSES + f->n_au; k++) {
		int pose = k < POSES ? k : REST;
		drive_look(controls, f->rig, at_h[pose % NH], at_v[pose / NH % NV], at_a[pose / NH / NV]);
		if (k >= POSES)
			controls[SKIN_EYE_INPUTS + k - POSES] = 1;
		portrait_pose(f->portrait, controls);
		struct portrait_view view = portrait_front(f->rig, -1, 140, 0, 0, 1280, 720);
		portrait_light(f->portrait, &view, k == 0);
		portrait_lashes_move(f->portrait, &view);
		f->record[k] = mem_array((size_t)f->n * RECORD, 1);
		record(f->record[k], f);
		if (k < POSES)
			sky(f->sky + (long)k * SKY * SKY * 2, f);
	}
	free(controls);
}

/* What differs by more than that or a few steps of light anywhere on the grid moves. */
static bool moves(const struct face *f, int i)
{
	const uint8_t *a = f->record[0] + (long)i * RECORD;
	for (int k = 1; k < POSES; k++) {
		const uint8_t *b = f->record[k] + (long)i * RECORD;
		for (int c = 0; c < 3; c++)
			if (abs(a[2 * c] + 256 * a[2 * c + 1] - b[2 * c] - 256 * b[2 * c + 1]) > f->least || abs(a[9 + c] - b[9 + c]) > (f->least + 7) / 4)
				return true;
	}
	return false;
}

static bool shown(const struct face *f, const int32_t v[3])
{
	for (int j = 0; j < 3; j++) {
		float x[3];
		to_head(x, f, f->portrait->mesh.x[v[j]], true);
		if (fabsf(x[0]) > 0.98f * reach || fabsf(x[1]) > 0.98f * reach || fabsf(x[2]) > 0.98f * reach)
			return false;
	}
	return true;
}

json_t *viewer_base64(const void *bytes, size_t size)
{
	char *text = page_base64(bytes, size, "");
	json_t *out = json_string(text);
	free(text);
	return out;
}

/* Orders the vertices that faces within reach use, moving ones first; returns their number. */
static int order(struct face *f, uint32_t **faces, int *n_faces)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	int *place = mem_array((size_t)f->n, sizeof *place), n = 0;
	bool *used = mem_new((size_t)f->n, sizeof *used);
	*faces = mem_array((size_t)m->n_faces * 3, sizeof **faces);
	*n_faces = 0;
	for (int i = 0; i < m->n_faces; i++)
		if (shown(f, m->faces[i])) {
			for (int j = 0; j < 3; j++) {
				used[m->faces[i][j]] = true;
				(*faces)[3 * *n_faces + j] = (uint32_t)m->faces[i][j];
			}
			++*n_faces;
		}
	f->order = mem_array((size_t)f->n, sizeof *f->order);
	// A page that is too large for the post is of no use: then less counts as motion.
	long count = LONG_MAX;
	for (f->least = 6; count > MOST;) {
		f->least *= 2;
		count = 0;
		for (int i = 0; i < f->n; i++)
			count += used[i] && moves(f, i);
	}
	for (int pass = 0; pass < 2; pass++) {
		for (int i = 0; i < f->n; i++)
			if (used[i] && moves(f, i) == !pass) {
				place[i] = n;
				f->order[n++] = i;
			}
		f->moving = pass ? f->moving : n;
	}
	for (int i = 0; i < 3 * *n_faces; i++)
		(*faces)[i] = (uint32_t)place[(*faces)[i]];
	free(place);
	free(used);
	return n;
}

static int put_mesh(json_t *out, struct face *f)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	uint32_t *faces;
	int n_faces, n = order(f, &faces, &n_faces);
	static const float hair[3] = { 0.022f, 0.014f, 0.010f };
	uint8_t *skin = mem_array((size_t)n * 4 + 1, 1), *still = mem_array((size_t)n * RECORD + 1, 1);
	uint8_t *poses = mem_array((size_t)f->moving * RECORD * POSES + 1, 1);
	for (int i = 0; i < n; i++) {
		for (int c = 0; c < 3; c++)
			skin[4 * i + c] = byte(255 * sqrt(fmax(f->order[i] < m->n ? m->albedo[f->order[i]][c] : hair[c], 0)));
		skin[4 * i + 3] = f->order[i] < m->n ? byte(127 * m->wet[f->order[i]]) : 255;  // a hair, or half of how moist it is
		memcpy(still + (long)i * RECORD, f->record[REST] + (long)f->order[i] * RECORD, RECORD);
		for (int k = 0; k < POSES && i < f->moving; k++)
			memcpy(poses + ((long)k * f->moving + i) * RECORD, f->record[k] + (long)f->order[i] * RECORD, RECORD);
	}
	json_object_set_new(out, "n", json_integer(n));
	json_object_set_new(out, "moving", json_integer(f->moving));
	json_object_set_new(out, "faces", viewer_base64(faces, (size_t)n_faces * 3 * sizeof *faces));
	json_object_set_new(out, "skin", viewer_base64(skin, (size_t)n * 4));
	json_object_set_new(out, "still", viewer_base64(still, (size_t)n * RECORD));
	json_object_set_new(out, "poses", viewer_base64(poses, (size_t)f->moving * RECORD * POSES));
	free(faces);
	free(skin);
	free(still);
	free(poses);
	return n;
}

/* How far the lids of one eye are open, against what people do at this gaze. */
static double opened(const struct rig *rig, const double *c, int side, const double gaze[2])
{
	double open = 0, usual = 0;
	for (int k = 2 * side; k < 2 * side + 2; k++) {
		open += c[k < 2 ? 3 + k : 6 + k];
		usual += rig->baseline[k][0] * gaze[0] + rig->baseline[k][1] * gaze[1] + rig->baseline[k][2];
	}
	return fmin(fmax(usual > 0.05 ? open / usual : 1, 0), 1.4);
}

/* What drives, as the grid has it: time; gaze and aperture of the left eye, then of the right; expressions; one row a frame. */
json_t *viewer_clip(const char *name, const struct rig *rig, const struct drive *drive)
{
	json_t *rows = json_array();
	double step = 1 / 60.0, next = -1e9;
	for (int i = 0; i < drive->n; i++) {
		const double *c = drive_at(drive, i);
		double gaze[2] = { 0.5 * (c[0] + c[5]), 0.5 * (c[1] + c[6]) };
		if (drive->time[i] < next)
			continue;
		next = drive->time[i] + step * 0.9;
		json_t *row = json_pack("[f,f,f,f,f,f,f]", round(1e3 * (drive->time[i] - drive->time[0])) / 1e3, round(100 * c[0]) / 100, round(100 * c[1]) / 100,
		                        round(1e3 * opened(rig, c, 0, gaze)) / 1e3, round(100 * c[5]) / 100, round(100 * c[6]) / 100, round(1e3 * opened(rig, c, 1, gaze)) / 1e3);
		for (int k = SKIN_EYE_INPUTS; k < drive->n_inputs; k++)
			json_array_append_new(row, json_real(round(1e3 * c[k]) / 1e3));
		json_array_append_new(rows, row);
	}
	return json_pack("{s:s,s:o}", "name", name, "rows", rows);
}

/* Inner corner of an eye, from its centre, and the share of mm there that a mean eyeball would have; 0: not known. */
static json_t *corner_of(const struct face *f, int side)
{
	float h[3] = { 0 }, d[3];
	for (int c = 0; c < 3; c++)
		d[c] = f->portrait->corner[side][c] - (float)f->rig->globe[side].center[c];
	to_head(h, f, d, false);
	double v[4] = { h[0], h[1], h[2], f->portrait->corner_known[side] ? f->rig->globe[side].radius / 12 : 0 };
	return json_numbers(4, v);
}

json_t *viewer_face(const char *name, struct portrait *portrait, const struct skin_model *model, double gain, const struct scene *const eyes[2], struct err *err)
{
	struct face f = { .rig = portrait->rig, .portrait = portrait, .n = portrait->mesh.n, .n_au = model->n_au };
	for (int i = portrait->first_lash; i < portrait->mesh.n_faces; i++)
		for (int j = 0; j < 3; j++)
			f.n = portrait->mesh.faces[i][j] < f.n ? f.n : portrait->mesh.faces[i][j] + 1;
	json_t *out = json_object(), *globes = json_array(), *corners = json_array();
	double reach_mm = reach;
	for (int c = 0; c < 3; c++)
		f.middle[c] = 0.5 * (f.rig->globe[0].center[c] + f.rig->globe[1].center[c]);
	pose_all(&f);
	json_object_set_new(out, "name", template_text(name));
	json_object_set_new(out, "reach", json_number(reach_mm));
	json_object_set_new(out, "gain", json_number(gain));
	double shadow_mm = TEAR_SHADOW_MM, lake = 1 + LAKE_RISE;
	json_object_set_new(out, "tear_mm", json_number(portrait->conf.tear_mm));
	json_object_set_new(out, "shadow_mm", json_number(shadow_mm));
	json_object_set_new(out, "lake", json_number(lake));
	json_object_set_new(out, "tear_absorb", json_numbers(3, portrait->conf.tear_absorb));
	json_object_set_new(out, "skin_rgb", json_numbers(3, portrait->conf.skin_rgb));
	json_object_set_new(out, "h", json_numbers(NH, at_h));
	json_object_set_new(out, "v", json_numbers(NV, at_v));
	json_object_set_new(out, "a", json_numbers(NA, at_a));
	for (int s = 0; s < 2; s++) {
		float center[3] = { (float)f.rig->globe[s].center[0], (float)f.rig->globe[s].center[1], (float)f.rig->globe[s].center[2] }, h[3];
		to_head(h, &f, center, true);
		double v[4] = { h[0], h[1], h[2], f.rig->globe[s].radius / eyes[s]->conf.sclera_radius };
		json_array_append_new(globes, json_numbers(4, v));
		json_array_append_new(corners, corner_of(&f, s));
	}
	json_object_set_new(out, "globes", globes);
	json_object_set_new(out, "corners", corners);
	json_object_set_new(out, "sky_px", json_integer(SKY));
	json_object_set_new(out, "sky", viewer_base64(f.sky, (size_t)POSES * SKY * SKY * 2));
	int n = put_mesh(out, &f);
	json_object_set_new(out, "expressions", viewer_expressions(&f, n, model->au_names));
	if (!viewer_put_folds(out, &f, n, err)) {
		json_decref(out);
		out = 0;
	}
	for (int k = 0; k < POSES + f.n_au; k++)
		free(f.record[k]);
	free(f.record);
	free(f.sky);
	free(f.order);
	return out;
}
