/* The page evaluates the rig itself; light it interpolates between poses of a grid of gazes and apertures, which portrait.h lights. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/template.h"
#include "draw/face/skin_look.h"
#include "draw/face/sky.h"
#include "draw/web/face_impl.h"
#include "draw/web/packed.h"
#include "math/vec.h"

static const double at_h[NH] = { -32, -16, 0, 16, 32 }, at_v[NV] = { -22, 0, 22 }, at_a[NA] = { 0, 0.5, 1, 1.4 };
static const float reach = 110;  // mm about the eyes: what the page shows of the face

static void to_head(float out[3], const struct web_face *f, const float x[3], bool point)
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

/* Stores the present irradiance of the rig's vertices: its square root, 255 for 3. */
static void record(uint8_t (*to)[3], const struct web_face *f)
{
	for (int i = 0; i < f->rig->n; i++)
		for (int c = 0; c < 3; c++)
			to[i][c] = byte(255 * sqrt(fmax(f->portrait->mesh.light[i][c], 0) / 3));
}

/* What sky lids leave open over points of both globes: SKY x SKY on the front half of each, seen along the line of sight straight ahead. Its share, 255 all; and
 * the direction of its middle in the head's axes, 0 -1 to 255 1. */
static void sky(uint8_t (*to)[4], const struct web_face *f)
{
	for (int side = 0; side < 2; side++)
		for (int k = 0; k < SKY * SKY; k++) {
			double x = (2 * (k % SKY) + 1.0) / SKY - 1, y = (2 * (k / SKY) + 1.0) / SKY - 1, z2 = 1 - x * x - y * y;
			double n[3] = { x, y, sqrt(fmax(z2, 0)) }, t[3], middle[3];
			float from[3], normal[3], about[3];
			vec_unit(n, n);
			mat_tvec(t, f->rig->head_from_target, n);
			for (int c = 0; c < 3; c++) {
				from[c] = (float)(f->rig->globe[side].center[c] + f->rig->globe[side].radius * t[c]);
				normal[c] = (float)t[c];
			}
			uint8_t *at = to[(k / SKY) * 2 * SKY + side * SKY + k % SKY];
			at[0] = byte(255 * (double)portrait_sky_over(about, f->portrait, from, normal));
			mat_vec(middle, f->rig->head_from_target, (double[]){ (double)about[0], (double)about[1], (double)about[2] });
			for (int c = 0; c < 3; c++)
				at[1 + c] = byte(127.5 + 127.5 * middle[c]);
		}
}

/* Computes the light of every pose of the grid and of every expression; leaves the portrait at rest. */
static void pose_all(struct web_face *f)
{
	double *controls = mem_new((size_t)f->rig->n_inputs + 1, sizeof *controls);
	struct portrait_view view = portrait_front(f->rig, -1, 140, 0, 0, 1280, 720);
	f->sky = mem_new((size_t)(POSES + f->n_au) * SKY * SKY * 2, sizeof *f->sky);
	f->light = mem_new((size_t)(POSES + f->n_au), sizeof *f->light);
	for (int k = 0; k < POSES + f->n_au; k++) {
		int pose = k < POSES ? k : REST;
		drive_look(controls, f->rig, at_h[pose % NH], at_v[pose / NH % NV], at_a[pose / NH / NV]);
		if (k >= POSES)
			drive_express(controls, f->rig, k - POSES, 1, 1);
		portrait_pose(f->portrait, controls);
		portrait_light(f->portrait, &view, k == 0);
		f->light[k] = mem_array((size_t)f->rig->n + 1, sizeof **f->light);
		record(f->light[k], f);
		sky(f->sky + (long)k * SKY * SKY * 2, f);
	}
	drive_look(controls, f->rig, 0, 0, 1);
	portrait_pose(f->portrait, controls);
	portrait_lashes_move(f->portrait, &view);
	free(controls);
}

/* Square roots of albedo; with them 255 for a hair, else half of the wetness. Light of the rig's own vertices. */
static void put_colours(json_t *out, const struct web_face *f)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	int n = f->n_shown, base = f->level[0].end, posed = f->level[0].posed, poses = POSES + f->n_au;
	uint8_t *skin = mem_array((size_t)n * 4 + 1, 1), *still = mem_array((size_t)base * 3 + 1, 1), *light = mem_array((size_t)posed * 3 * (size_t)poses + 1, 1);
	for (int i = 0; i < n; i++) {
		int at = f->order[i];
		const struct portrait *p = f->portrait;
		double hair[3];
		if (at >= m->n)
			portrait_lash_albedo(hair, p, &p->hairs.hair[p->hair_of[(at - p->lash_vertex) / 2]]);
		for (int c = 0; c < 3; c++)
			skin[4 * i + c] = byte(255 * sqrt(fmax(at >= m->n ? hair[c] : (double)m->albedo[at][c], 0)));
		skin[4 * i + 3] = at < m->n ? byte(127 * m->wet[at]) : 255;
	}
	for (int i = 0; i < base; i++) {
		memcpy(still + 3L * i, f->light[REST][f->order[i]], 3);
		for (int k = 0; k < poses && i < posed; k++)
			memcpy(light + 3 * ((long)k * posed + i), f->light[k][f->order[i]], 3);
	}
	json_object_set_new(out, "n", json_integer(n));
	json_object_set_new(out, "faces", packed_json(f->faces, (size_t)f->n_faces * sizeof *f->faces, sizeof *f->faces, sizeof *f->faces));
	json_object_set_new(out, "skin", packed_json(skin, (size_t)n * 4, 4, 4));
	json_object_set_new(out, "still", packed_json(still, (size_t)base * 3, 1, 3));
	json_object_set_new(out, "light", packed_json(light, (size_t)posed * 3 * (size_t)poses, 1, (size_t)posed * 3));
	json_object_set_new(out, "rest_pose", json_integer(REST));
	free(skin);
	free(still);
	free(light);
}

json_t *web_clip(const char *name, const struct drive *drive)
{
	json_t *rows = json_array();
	double step = 1 / 60.0, next = -1e9;
	for (int i = 0; i < drive->n; i++) {
		const double *c = drive_at(drive, i);
		if (drive->time[i] < next)
			continue;
		next = drive->time[i] + step * 0.9;
		json_t *row = json_pack("[f]", round(1e3 * (drive->time[i] - drive->time[0])) / 1e3);
		for (int k = 0; k < drive->n_inputs; k++) {
			double unit = k < SKIN_EYE_INPUTS && k % 5 < 3 ? 1e2 : 1e4;  // degrees; else shares
			json_array_append_new(row, json_real(round(unit * c[k]) / unit));
		}
		json_array_append_new(rows, row);
	}
	return json_pack("{s:s,s:o}", "name", name, "rows", rows);
}

/* Inner corner of an eye, from its centre, and the globe's radius over the mean of 12 mm; 0: the corner is not known. */
static json_t *corner_of(const struct web_face *f, int side)
{
	float h[3] = { 0 }, d[3];
	for (int c = 0; c < 3; c++)
		d[c] = f->portrait->corner[side][c] - (float)f->rig->globe[side].center[c];
	to_head(h, f, d, false);
	double v[4] = { h[0], h[1], h[2], f->portrait->corner_known[side] ? f->rig->globe[side].radius / 12 : 0 };
	return json_numbers(4, v);
}

/* Range of the gaze in the video, degrees: to the person's right, left, down, up; where it was not measured, how far eyes turn. */
static json_t *looked(const struct skin_model *m)
{
	static const double turn[4] = { -40, 40, -30, 30 };
	double v[4];
	for (int k = 0; k < 4; k++) {
		const double *of = k % 2 ? m->high : m->low, a = of[k / 2], b = of[5 + k / 2];
		v[k] = k % 2 ? fmax(a, b) : fmin(a, b);
		v[k] = isfinite(v[k]) ? v[k] : turn[k];
	}
	return json_numbers(4, v);
}

json_t *web_face(const char *name, struct portrait *portrait, const struct skin_model *model, double gain, const struct scene *const eyes[2], struct err *err)
{
	struct web_face f = { .rig = portrait->rig, .portrait = portrait, .n = portrait->mesh.n, .n_au = model->n_au };
	for (int i = portrait->first_lash; i < portrait->mesh.n_faces; i++)
		for (int j = 0; j < 3; j++)
			f.n = portrait->mesh.faces[i][j] < f.n ? f.n : portrait->mesh.faces[i][j] + 1;
	json_t *out = json_object(), *globes = json_array(), *corners = json_array();
	for (int c = 0; c < 3; c++)
		f.middle[c] = 0.5 * (f.rig->globe[0].center[c] + f.rig->globe[1].center[c]);
	pose_all(&f);
	json_object_set_new(out, "name", template_text(name));
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
	json_object_set_new(out, "looked", looked(model));
	json_object_set_new(out, "globes", globes);
	json_object_set_new(out, "corners", corners);
	json_object_set_new(out, "sky_px", json_integer(SKY));
	json_object_set_new(out, "sky", packed_json(f.sky, (size_t)(POSES + f.n_au) * SKY * SKY * 2 * sizeof *f.sky, 1, (size_t)SKY * SKY * 2 * sizeof *f.sky));
	web_order(&f, 0.98 * reach);
	put_colours(out, &f);
	web_settle_put(out, &f);
	web_put_rig(out, &f);
	json_t *names = json_array();
	for (int k = 0; k < f.n_au; k++)
		json_array_append_new(names, json_pack("{s:o}", "name", template_text(model->au_names[k])));
	json_object_set_new(out, "expressions", names);
	if (!web_put_folds(out, &f, err) || !web_put_dress(out, &f, err)) {
		json_decref(out);
		out = 0;
	}
	web_order_free(&f);
	web_settle_free(&f);
	for (int k = 0; k < POSES + f.n_au; k++)
		free(f.light[k]);
	free(f.light);
	free(f.sky);
	return out;
}
