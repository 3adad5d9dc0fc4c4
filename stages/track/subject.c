#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/vec.h"
#include "stages/track/track.h"

static const long limit_vertices = 2000000;
static const double usual_radius = 12;  // mm: an eyeball

static const char *const sides[SIDES] = { "left", "right" };
static const char *const marks[MARKS] = { "inner_canthus", "outer_canthus", "upper_lid_mid", "lower_lid_mid" };

static const double *given(const struct opt_each_list *list, const char *name)
{
	for (int i = 0; i < list->n; i++)
		if (!strcmp(list->items[i].name, name))
			return list->items[i].value;
	return 0;
}

/* mm in a unit, from how far the vertices lie from their middle: 40 to 200 mm in a face, a head or a patch of either. */
static double guess_unit(const struct mesh *mesh)
{
	static const double units[] = { 1, 10, 100, 1000 };
	double mean[3] = { 0 }, sum = 0, best = 1;
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++)
			mean[k] += mesh->vertices[i][k] / (double)mesh->n_vertices;
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++)
			sum += pow(mesh->vertices[i][k] - mean[k], 2) / mesh->n_vertices;
	for (int i = 0; i < COUNT(units) && sum > 0; i++)
		if (fabs(log(sqrt(sum) * units[i] / 85)) < fabs(log(sqrt(sum) * best / 85)))
			best = units[i];
	return best;
}

static bool read_marks(struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	for (int i = 0; i < SIDES * MARKS; i++) {
		char name[64];
		snprintf(name, sizeof name, "%s_%s", sides[i / MARKS], marks[i % MARKS]);
		const double *row = given(&conf->landmark, name);
		s->mark[i / MARKS][i % MARKS] = row ? (int)*row : -1;
		if (row && !(*row >= 0 && *row < s->mesh.n_vertices && *row == floor(*row)))
			return err_set(err, "capture.conf: subject.landmark.%s = %g: must be a row of %s, in [0, %d]", name, *row, s->file,
			               s->mesh.n_vertices - 1);
	}
	return true;
}

static const float *at(const struct track_subject *s, int side, int mark)
{
	return s->mark[side][mark] < 0 ? 0 : s->mesh.vertices[s->mark[side][mark]];
}

/* The eyeball touches the middles of both lids from behind. */
static bool center_from_marks(double center[3], const struct track_subject *s, int side)
{
	const float *up = at(s, side, MARK_UPPER), *low = at(s, side, MARK_LOWER), *in = at(s, side, MARK_INNER), *out = at(s, side, MARK_OUTER);
	if (!up || !low || !in || !out)
		return false;
	double half2 = 0;
	for (int k = 0; k < 3; k++) {
		center[k] = k == 0 ? 0.5 * (in[0] + out[0]) : 0.5 * (up[k] + low[k]);
		half2 += 0.25 * pow(up[k] - low[k], 2);
	}
	center[2] -= sqrt(fmax(0.25 * s->radius * s->radius, s->radius * s->radius - half2));
	return true;
}

/* Where the mesh has no hole for the eye: parabolas through the landmarks. */
static void opening_from_marks(struct eye_opening *o, const struct track_subject *s, int side)
{
	const float *in = at(s, side, MARK_INNER), *out = at(s, side, MARK_OUTER);
	const float *mid[2] = { at(s, side, MARK_UPPER), at(s, side, MARK_LOWER) };
	if (o->open || !in || !out || !mid[0] || !mid[1])
		return;
	// counter-clockwise as seen from in front: over the upper lid from right to left
	const float *right = in[0] > out[0] ? in : out, *left = in[0] > out[0] ? out : in;
	*o = (struct eye_opening){ .open = true };
	for (int i = 0; i < OPENING_POINTS; i++) {
		int lower = i >= OPENING_POINTS / 2;
		double t = (i % (OPENING_POINTS / 2)) / (OPENING_POINTS / 2.0);
		const float *a = lower ? left : right, *b = lower ? right : left;
		for (int k = 0; k < 3; k++) {
			double chord = (1 - t) * a[k] + t * b[k], bend = mid[lower][k] - 0.5 * (a[k] + b[k]);
			o->edge[i][k] = chord + 4 * t * (1 - t) * bend;
			o->center[k] += o->edge[i][k] / OPENING_POINTS;
			o->canthus[0][k] = in[k];
			o->canthus[1][k] = out[k];
		}
	}
}

static bool eyes(struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	s->radius = isfinite(conf->eye_radius) ? conf->eye_radius * s->unit_mm : usual_radius;
	struct ray_scene *rays = ray_scene_new(s->mesh.n_vertices, (const float(*)[3])s->mesh.vertices, s->mesh.n_faces,
	                                       (const int32_t(*)[3])s->mesh.faces);
	bool any = false;
	for (int e = 0; e < SIDES; e++) {
		const double *center = given(&conf->eye_center, sides[e]);
		for (int k = 0; k < 3; k++)
			s->center[e][k] = center ? center[k] * s->unit_mm : NAN;
		if (!center && !center_from_marks(s->center[e], s, e))
			continue;
		const double from[3] = { s->center[e][0], s->center[e][1], s->center[e][2] + 1000 };
		eye_opening_find(&s->opening[e], rays, from, s->center[e], s->radius);
		opening_from_marks(&s->opening[e], s, e);
		any |= s->opening[e].open;
	}
	ray_scene_free(rays);
	if (!any)
		return err_set(err, "%s: where its eyes are is not known: set subject.eye_center.left and .right, or subject.landmark.left_inner_canthus and so on, in capture.conf", s->file);
	return true;
}

bool track_subject_load(struct track_subject *s, struct stage *stage, const struct track_conf *conf, struct err *err)
{
	static const char *const files[] = { "subject.ply", "subject.obj", "work/subject.ply" };
	*s = (struct track_subject){ .radius = NAN };
	for (int i = 0; i < COUNT(files) && !s->file; i++)
		if (file_exists(stage_path(stage, "%s", files[i])))
			s->file = files[i];
	if (!s->file)
		return true;
	if (!om_mesh_load(&s->mesh, stage_path(stage, "%s", s->file), limit_vertices, err))
		return false;
	bool own = !strncmp(s->file, "work/", 5);  // calibrate's is in mm
	s->unit_mm = isfinite(conf->unit_mm) && !own ? conf->unit_mm : own ? 1 : guess_unit(&s->mesh);
	for (int i = 0; i < s->mesh.n_vertices; i++)
		for (int k = 0; k < 3; k++)
			s->mesh.vertices[i][k] *= (float)s->unit_mm;
	return read_marks(s, conf, err) && eyes(s, conf, err);
}

void track_subject_free(struct track_subject *s)
{
	mesh_free(&s->mesh);
}
