#include "track/clip/subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/vec.h"
#include "optics/camera_rig.h"
#include "track/clip/average.h"
#include "track/clip/rim.h"

static const long limit_vertices = 2000000;
static const double usual_radius = 12;  // mm: an eyeball
static const double half_apart = 31.5;  // mm, of a person's eyes
static const double rim_sigma = 0.3;    // mm, of a centre from the rim of the mesh's hole: 0.1 and 0.2 on two rendered heads

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

/* Centre of an eyeball that touches the middles of both lids from behind. */
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

/* Parabolas through the corners of the eye and the middles of its lids. */
static void opening_through(struct eye_opening *o, const float *in, const float *out, const float *const mid[2])
{
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

/* A round corner has no end of its own: marked corners replace those found. */
static void corners_from_marks(struct eye_opening *margin, const struct track_subject *s, int side)
{
	const float *mark[2] = { at(s, side, MARK_INNER), at(s, side, MARK_OUTER) };
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < 3 && mark[c]; k++)
			margin->canthus[c][k] = mark[c][k];
}

/* Where the mesh has no hole for the eye. */
static void opening_from_marks(struct eye_opening *o, const struct track_subject *s, int side)
{
	const float *in = at(s, side, MARK_INNER), *out = at(s, side, MARK_OUTER);
	const float *mid[2] = { at(s, side, MARK_UPPER), at(s, side, MARK_LOWER) };
	if (!o->open && in && out && mid[0] && mid[1])
		opening_through(o, in, out, (const float *const *)mid);
}

/* Opening where nothing but the eyeball is known: the mean palpebral fissure (Farkas 1994: 30 mm long; the upper lid stands 4
 * mm above the pupil's centre, the lower 5.5 mm below), laid on the mesh; where that has holes, on the eyeball, its corners so far before the eyeball's centre: of heads of a model
 * made from scans 9.2 and 4.2 mm, its eyeballs of 15 mm taken for 12 behind the same corneas; by exophthalmometry 5 to 8 and 2 to 3. */
static void opening_usual(struct eye_opening *o, const struct ray_scene *rays, const double center[3], double radius)
{
	static const float offsets[4][2] = { { -15, -1 }, { 15, 0 }, { 0, 4 }, { 0, -5.5f } }, corner[2] = { 8, 3.5f };
	const float side = center[0] < 0 ? -1 : 1, back[3] = { 0, 0, -1 };
	float p[4][3];
	for (int i = 0; i < 4; i++) {
		const float from[3] = { (float)center[0] + side * offsets[i][0], (float)center[1] + offsets[i][1], (float)center[2] + 500 };
		struct ray_hit hit = ray_first(rays, from, back, 0, 520);
		double off = hypot((double)offsets[i][0], (double)offsets[i][1]);
		p[i][0] = from[0];
		p[i][1] = from[1];
		p[i][2] = hit.face >= 0 ? from[2] - hit.t : (float)center[2] + (i < 2 ? corner[i] : (float)sqrt(fmax(0, radius * radius - off * off)));
	}
	const float *const mid[2] = { p[2], p[3] };
	opening_through(o, p[0], p[1], mid);
}

/* Eyeballs estimated by calibrate, where the mesh is its own. */
static bool eyes_of_rig(struct camera_rig *rig, const struct track_subject *s, struct stage *stage, struct err *err)
{
	const char *path = stage_path(stage, "work/rig.json");
	*rig = (struct camera_rig){ 0 };
	return strncmp(s->file, "work/", 5) || !file_exists(path) || camera_rig_load(rig, path, err);
}

static bool eyes(struct track_subject *s, struct stage *stage, const struct track_conf *conf, struct err *err)
{
	struct camera_rig rig;
	if (!eyes_of_rig(&rig, s, stage, err))
		return false;
	s->radius = isfinite(conf->eye_radius) ? conf->eye_radius * s->unit_mm : usual_radius;
	// Where capture.conf does not tell, the rims of a modelled mesh's own holes do; those of a reconstruction are what was not seen.
	bool on_rim[SIDES];
	double rim[SIDES][3], radius[SIDES];
	for (int e = 0; e < SIDES; e++)
		on_rim[e] = !given(&conf->eye_center, sides[e]) && strncmp(s->file, "work/", 5)
		            && rim_eyeball(rim[e], &radius[e], &s->mesh, e == SIDE_LEFT, at(s, e, MARK_INNER));
	if ((on_rim[0] || on_rim[1]) && !isfinite(conf->eye_radius))
		s->radius = ((on_rim[0] ? radius[0] : 0) + (on_rim[1] ? radius[1] : 0)) / (on_rim[0] + on_rim[1]);
	struct ray_scene *rays = ray_scene_new(s->mesh.n_vertices, (const float(*)[3])s->mesh.vertices, s->mesh.n_faces,
	                                       (const int32_t(*)[3])s->mesh.faces);
	bool any = false, usual = false;
	for (int e = 0; e < SIDES; e++) {
		const double *center = given(&conf->eye_center, sides[e]);
		s->center_given[e] = center;
		for (int k = 0; k < 3; k++)
			s->center[e][k] = center ? center[k] * s->unit_mm : rig.has_eyes ? rig.eye_center[e][k] : NAN;
		if (on_rim[e])
			memcpy(s->center[e], rim[e], sizeof rim[e]);
		else if (!center && !rig.has_eyes && !center_from_marks(s->center[e], s, e))
			continue;
		s->center_sigma[e] = on_rim[e] ? rim_sigma : !center && !rig.has_eyes ? conf->guess_sigma : 0;
		const double from[3] = { s->center[e][0], s->center[e][1], s->center[e][2] + 1000 };
		eye_opening_find(&s->opening[e], rays, from, s->center[e], s->radius);
		eye_opening_find(&s->margin[e], rays, from, s->center[e], s->radius + conf->meniscus_mm);
		corners_from_marks(&s->margin[e], s, e);
		opening_from_marks(&s->opening[e], s, e);
		if (!s->opening[e].open && rig.has_eyes) {
			opening_usual(&s->opening[e], rays, s->center[e], s->radius);
			usual = true;
		}
		any |= s->opening[e].open;
	}
	ray_scene_free(rays);
	camera_rig_free(&rig);
	if (usual)
		stage_skipped(stage, "%s: no lids are seen in it: people's mean opening stands for their lids; mark the corners of the eyes and the lids (subject.landmark.*)",
		              s->file);
	if (!any && !strncmp(s->file, "work/", 5))
		return err_set(err, "%s: where its eyes are is not known: name them in two views in capture.conf (view.NAME.left_eye_px = x y radius, view.NAME.right_eye_px)", s->file);
	if (!any)
		return err_set(err, "%s: where its eyes are is not known: set subject.eye_center.left and .right, or subject.landmark.left_inner_canthus and so on, in capture.conf", s->file);
	return true;
}

/* Without a mesh: eyes as people have them, 63 mm apart (Dodgson 2004), to be looked for in the picture; of one that is not shown there is no opening. */
static void assume_eyes(struct track_subject *s, enum track_shown shown)
{
	struct ray_scene *nothing = ray_scene_new(0, 0, 0, 0);
	s->assumed = true;
	s->radius = usual_radius;
	for (int e = 0; e < SIDES; e++) {
		s->center[e][0] = e == SIDE_LEFT ? half_apart : -half_apart;
		s->center[e][1] = s->center[e][2] = 0;
		if (shown == SHOWN_BOTH || (shown == SHOWN_LEFT) == (e == SIDE_LEFT))
			opening_usual(&s->opening[e], nothing, s->center[e], s->radius);
	}
	ray_scene_free(nothing);
	average_skin(&s->mesh, half_apart);
}

/* Where capture.conf says where both eyeballs are: beside each other, the left one on the person's left, each where the mesh is.
   A mask that ends at the lids lies wholly in front of the eyes, a radius and a lid's thickness away; hence two radii. */
static bool eyes_agree(const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	const double *left = given(&conf->eye_center, "left"), *right = given(&conf->eye_center, "right");
	float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (int i = 0; i < s->mesh.n_vertices; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fminf(low[k], s->mesh.vertices[i][k]);
			high[k] = fmaxf(high[k], s->mesh.vertices[i][k]);
		}
	for (int e = 0; e < SIDES; e++) {
		const double *at = e == SIDE_LEFT ? left : right;
		for (int k = 0; k < 3 && at; k++)
			if (at[k] * s->unit_mm < low[k] - 2 * s->radius || at[k] * s->unit_mm > high[k] + 2 * s->radius)
				return err_set(err, "subject.eye_center.%s = %g %g %g with subject.unit_mm = %g: lies outside of %s", sides[e], at[0], at[1], at[2],
				               s->unit_mm, s->file);
	}
	if (!left || !right)
		return true;
	const double apart = sqrt(pow(left[0] - right[0], 2) + pow(left[1] - right[1], 2) + pow(left[2] - right[2], 2)) * s->unit_mm;
	if (left[0] > right[0] && apart > 2 * s->radius)
		return true;
	return err_set(err, "subject.eye_center.left = %g %g %g with subject.eye_center.right = %g %g %g: must lie more than two radii of an eyeball (%.3g mm) apart, the left one at the greater x",
	               left[0], left[1], left[2], right[0], right[1], right[2], 2 * s->radius);
}

bool track_subject_load(struct track_subject *s, struct stage *stage, const struct track_conf *conf, struct err *err)
{
	static const char *const files[] = { "subject.ply", "subject.obj", "work/subject.ply" };
	*s = (struct track_subject){ .radius = NAN };
	for (int i = 0; i < COUNT(files) && !s->file; i++)
		if (file_exists(stage_path(stage, "%s", files[i])))
			s->file = files[i];
	if (!s->file) {
		stage_skipped(stage, "no mesh of the person (subject.ply): gaze and lids are followed, skin is not; put one in, or photographs into views/");
		assume_eyes(s, conf->alone);
		return true;
	}
	if (!om_mesh_load(&s->mesh, stage_path(stage, "%s", s->file), limit_vertices, err))
		return false;
	bool own = !strncmp(s->file, "work/", 5);  // calibrate's is in mm
	s->unit_mm = isfinite(conf->unit_mm) && !own ? conf->unit_mm : own ? 1 : guess_unit(&s->mesh);
	for (int i = 0; i < s->mesh.n_vertices; i++)
		for (int k = 0; k < 3; k++)
			s->mesh.vertices[i][k] *= (float)s->unit_mm;
	if (!read_marks(s, conf, err) || !eyes(s, stage, conf, err) || !eyes_agree(s, conf, err))
		return false;
	s->shape = conf->shade.patch > 0 ? head_shape_new(&s->mesh, (const double(*)[3])s->center, &conf->shade) : 0;
	return true;
}

void track_subject_free(struct track_subject *s)
{
	mesh_free(&s->mesh);
	head_shape_free(s->shape);
}

double track_eyes_depth(const double cam_from_head[4][4], const struct track_subject *s)
{
	double depth = 0;
	int n = 0;
	for (int e = 0; e < SIDES; e++) {
		const double *at = s->opening[e].open ? s->opening[e].center : s->center[e];
		double p[3];
		if (isnan(at[0] + at[1] + at[2]))
			continue;
		head_from(p, cam_from_head, at);
		depth += p[2];
		n++;
	}
	return n ? depth / n : cam_from_head[2][3];
}

void track_eyes_between(double at[3], const struct track_subject *s)
{
	for (int k = 0; k < 3; k++)
		at[k] = 0.25 * (s->opening[0].canthus[0][k] + s->opening[0].canthus[1][k] + s->opening[1].canthus[0][k] + s->opening[1].canthus[1][k]);
}

bool track_eyes_middle(double px[SIDES][2], const struct camera *camera, const double cam_from_head[4][4], const struct track_subject *s)
{
	for (int e = 0; e < SIDES; e++) {
		double corner[2][2];
		for (int c = 0; c < 2; c++)
			if (!s->opening[e].open || !head_project(corner[c], camera, cam_from_head, s->opening[e].canthus[c]))
				return false;
		for (int k = 0; k < 2; k++)
			px[e][k] = 0.5 * (corner[0][k] + corner[1][k]);
	}
	return true;
}

bool track_on_lid(const double head[3], const struct track_subject *s)
{
	for (int e = 0; e < SIDES; e++) {
		double dx = head[0] - s->center[e][0], dy = head[1] - s->center[e][1];
		if (dx * dx + dy * dy < 1.4 * 1.4 * s->radius * s->radius)
			return true;
	}
	return false;
}
