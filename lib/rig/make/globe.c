/* Finds the eyeballs of a mesh: round connected pieces where an eye is expected. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/vec.h"
#include "mesh/topology.h"
#include "rig/make/make_impl.h"

enum { LEAST_VERTICES = 20, ROUNDS = 8 };
/* A human eye: cornea of 7.8 mm on a sclera of 11.8, limbus radius 5.85: apex at 12.95 mm from the centre. */
static const double cornea_share = 7.8 / 11.8, apex_share = 12.95 / 11.8;

struct ball {
	double center[3], radius, rms;
	int n, component;
};

/* Area of the surface around each vertex, the weight of a sphere fit: corneas are meshed finely and would otherwise dominate. free(). */
static double *areas_of(const struct rig *rig)
{
	double *area = mem_new((size_t)rig->n + 1, sizeof *area);
	for (int f = 0; f < rig->n_faces; f++) {
		const int32_t *v = rig->faces[f];
		double a[3], b[3];
		for (int c = 0; c < 3; c++) {
			a[c] = rig->rest[v[1]][c] - rig->rest[v[0]][c];
			b[c] = rig->rest[v[2]][c] - rig->rest[v[0]][c];
		}
		vec_cross(a, a, b);
		for (int k = 0; k < 3; k++)
			area[v[k]] += vec_norm(a) / 6;
	}
	return area;
}

/* Fits a sphere to a component's vertices by iteratively reweighted least squares (Cauchy weights), so that a cornea on it counts
 * little. False: too few vertices, or no sphere. */
static bool fit_ball(struct ball *ball, const struct rig *rig, const int *component, const double *area, int which)
{
	double origin[3] = { 0 };
	*ball = (struct ball){ .component = which };
	for (int i = 0; i < rig->n; i++)
		if (component[i] == which) {
			for (int c = 0; c < 3; c++)
				origin[c] += rig->rest[i][c];
			ball->n++;
		}
	if (ball->n < LEAST_VERTICES)
		return false;
	for (int c = 0; c < 3; c++)
		origin[c] /= ball->n;
	double x[4] = { 0 }, total = 0, all = 0;
	for (int round = 0; round < ROUNDS; round++) {
		double A[16] = { 0 }, b[4] = { 0 }, rms = 0, radius = ball->radius;
		total = all = 0;
		for (int i = 0; i < rig->n; i++) {
			if (component[i] != which)
				continue;
			double p[4] = { 0, 0, 0, 1 }, square = 0, w = area[i], off[3];
			for (int c = 0; c < 3; c++) {
				off[c] = rig->rest[i][c] - origin[c];
				p[c] = 2 * off[c];
				square += off[c] * off[c];
				off[c] -= x[c];
			}
			double residual = (vec_norm(off) - radius) / fmax(radius, 1e-9);
			if (round)
				w /= 1 + (residual / 0.02) * (residual / 0.02);
			for (int j = 0; j < 4; j++) {
				for (int k = 0; k < 4; k++)
					A[4 * j + k] += w * p[j] * p[k];
				b[j] += w * p[j] * square;
			}
			rms += w * residual * residual;
			total += w;
			all += area[i];
		}
		if (!chol_solve(4, 4, A, b))
			return false;
		for (int j = 0; j < 4; j++)
			x[j] = b[j];
		ball->radius = sqrt(x[3] + x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
		ball->rms = sqrt(rms / total);
	}
	for (int c = 0; c < 3; c++)
		ball->center[c] = origin[c] + x[c];
	// A strip of lid lies on a sphere, too, but does not surround its centre: globe_map_from_mesh refuses that.
	return isfinite(ball->radius) && total > 0.4 * all;
}

/* Whether the ball lies on that side of the face: all that is checked where no centre is known. */
static bool on_side(const struct rig *rig, const struct ball *ball, int side)
{
	const double *across = rig->head_from_target[0];
	double mean = 0;
	for (int i = 0; i < rig->n; i++)
		for (int c = 0; c < 3; c++)
			mean += across[c] * rig->rest[i][c] / rig->n;
	return (vec_dot(across, ball->center) < mean) == side;
}

/* Whether the ball can be that side's eyeball. */
static bool expected(const struct rig *rig, const struct ball *ball, int side, const double center[3], double radius)
{
	double d[3];
	if (!isfinite(center[0]))
		return on_side(rig, ball, side) && ball->radius > 0.5 * radius && ball->radius < 2 * radius;
	vec_add(d, ball->center, -1, center);
	return vec_norm(d) < radius && ball->radius > 0.4 * radius && ball->radius < 2.2 * radius;
}

/* The globe's vertices in its own frame (axes of the head, origin at its centre). mesh_free. */
static struct mesh own_mesh(const struct rig *rig, const double center[3], enum rig_part part)
{
	struct mesh mesh = { .vertices = mem_new((size_t)rig->n + 1, sizeof *mesh.vertices),
		                 .faces = mem_new((size_t)rig->n_faces + 1, sizeof *mesh.faces) };
	int *row = mem_new((size_t)rig->n + 1, sizeof *row);
	for (int i = 0; i < rig->n; i++) {
		double p[3];
		if (rig->part[i] != part)
			continue;
		for (int c = 0; c < 3; c++)
			p[c] = rig->rest[i][c] - center[c];
		mat_vec(p, rig->head_from_target, p);
		for (int c = 0; c < 3; c++)
			mesh.vertices[mesh.n_vertices][c] = (float)p[c];
		row[i] = mesh.n_vertices++;
	}
	for (int f = 0; f < rig->n_faces; f++)
		if (rig->part[rig->faces[f][0]] == part) {
			for (int k = 0; k < 3; k++)
				mesh.faces[mesh.n_faces][k] = row[rig->faces[f][k]];
			mesh.n_faces++;
		}
	free(row);
	return mesh;
}

/* How a component lies around a globe: distances of its nearest and farthest vertex over the radius, least cosine from the axis, and
 * the sum of its vertices over the radius, for the distance of its middle from the axis. */
struct lie {
	double low, high, least_cos, off[3];
	int n;
};

static void look_round(struct lie *lie, const struct rig *rig, const struct ball *ball, const int *component)
{
	for (int i = 0; i < rig->n; i++) {
		struct lie *l = &lie[component[i]];
		double p[3], r;
		for (int c = 0; c < 3; c++)
			p[c] = (rig->rest[i][c] - ball->center[c]) / ball->radius;
		mat_vec(p, rig->head_from_target, p);
		r = vec_norm(p);
		if (!l->n++)
			l->low = r, l->least_cos = 1;
		l->low = fmin(l->low, r);
		l->high = fmax(l->high, r);
		l->least_cos = fmin(l->least_cos, p[2] / fmax(r, 1e-9));
		vec_add(l->off, l->off, 1, p);
	}
}

/* Marks the ball and further pieces of the eyeball (a separate cornea, an iris, a lens) as globe, and pieces around it (lashes, tear
 * film) as RIG_NEAR_EYE. */
static void mark(struct rig *rig, int side, const struct ball *ball, const int *component)
{
	struct lie *lie = mem_new((size_t)rig->n + 1, sizeof *lie);
	enum rig_part globe = side ? RIG_GLOBE_RIGHT : RIG_GLOBE_LEFT;
	look_round(lie, rig, ball, component);
	for (int i = 0; i < rig->n; i++) {
		const struct lie *l = &lie[component[i]];
		double middle = hypot(l->off[0], l->off[1]) / l->n;
		bool front = l->n >= 8 && l->high < 1.3 && l->least_cos > 0.7 && middle < 0.12;
		bool round = l->n >= 8 && l->high < 1.15 && (l->high < 0.98 || l->least_cos < -0.8);
		if (component[i] == ball->component || round || front)
			rig->part[i] = globe;
		else if (l->n >= 3 && l->high < 1.9 && rig->part[i] == RIG_SKIN)
			rig->part[i] = RIG_NEAR_EYE;
	}
	free(lie);
}

/* Adds a cornea to a globe that has none, as the renderer draws one and lids bulge where it passes below them. False: it has one. */
static bool add_cornea(struct globe_map *map, double radius, double bulge)
{
	float front = 0;
	for (int k = -1; k <= 1; k++)  // a little off the axis, too: modelled irises have a dent there
		front = fmaxf(front, globe_map_at(map, (float[3]){ 0.1f * (float)k, 0, 1 }));
	if (front > bulge * radius)
		return false;
	struct globe_map round = globe_map_round(map->n, radius, cornea_share * radius, apex_share * radius);
	size_t nodes = (size_t)(map->n + 1) * (size_t)(map->n + 1);
	for (size_t i = 0; i < nodes; i++)
		map->radius[i] = fmaxf(map->radius[i], round.radius[i]);
	globe_map_free(&round);
	return true;
}

/* Makes a globe from the character's own ball. */
static void take_own(struct rig *rig, int side, const struct ball *ball, const int *component, int cells)
{
	struct rig_globe *globe = &rig->globe[side];
	struct err none = { 0 };
	mark(rig, side, ball, component);
	struct mesh mesh = own_mesh(rig, ball->center, side ? RIG_GLOBE_RIGHT : RIG_GLOBE_LEFT);
	globe->own = globe_map_from_mesh(&globe->map, cells, &mesh, &none);
	mesh_free(&mesh);
	if (!globe->own)  // a cap, not a ball: not an eyeball
		for (int i = 0; i < rig->n; i++)
			rig->part[i] = rig->part[i] == (side ? RIG_GLOBE_RIGHT : RIG_GLOBE_LEFT) ? RIG_NEAR_EYE : rig->part[i];
	vec_add(globe->center, ball->center, 0, ball->center);
	globe->radius = ball->radius;
}

void rig_expect_globes(double center[2][3], double *radius, const struct rig *rig, const struct rig_character *ch)
{
	double scale = vec_norm(ch->subject_from_target[0]);
	*radius = (isfinite(ch->eye_radius) ? ch->eye_radius : 12) / scale;
	for (int s = 0; s < 2; s++) {
		double sum[3] = { 0 }, moved[3] = { 0 }, total = 0, at[3];
		for (int i = 0; i < rig->n; i++) {
			double d[3];
			for (int c = 0; c < 3; c++)
				d[c] = ch->registered[i][c] - ch->eye_center[s][c];
			double w = exp(-0.5 * vec_dot(d, d) / (20.0 * 20.0));
			for (int c = 0; c < 3 && w > 1e-6; c++) {
				double there = 0;
				for (int k = 0; k < 3; k++)
					there += ch->subject_from_target[k][c] * (ch->registered[i][k] - ch->subject_from_target[k][3]) / (scale * scale);
				moved[c] += w * (rig->rest[i][c] - there);
			}
			total += w;
		}
		for (int c = 0; c < 3; c++) {
			for (int k = 0; k < 3; k++)
				sum[c] += ch->subject_from_target[k][c] * (ch->eye_center[s][k] - ch->subject_from_target[k][3]) / (scale * scale);
			at[c] = sum[c] + (total > 0 ? moved[c] / total : 0);
			center[s][c] = at[c];
		}
	}
}

bool rig_find_globes(struct rig *rig, const double center[2][3], double radius, const struct rig_conf *conf,
                     struct rig_report *report, struct err *err)
{
	static const char *const sides[] = { "left", "right" };
	int *component = mesh_pieces(rig->n, rig->n_faces, rig->faces);
	double *area = areas_of(rig);
	struct ball best[2] = { 0 };
	for (int i = 0; i < rig->n; i++) {
		struct ball ball;
		if (component[i] != i || !fit_ball(&ball, rig, component, area, i) || ball.rms > 0.12)
			continue;
		for (int side = 0; side < 2; side++)
			if (expected(rig, &ball, side, center[side], radius) && ball.radius > best[side].radius)
				best[side] = ball;
	}
	for (int side = 0; side < 2; side++)
		if (best[side].radius > 0)
			take_own(rig, side, &best[side], component, conf->globe_cells);
	free(area);
	free(component);
	bool ok = true;
	for (int side = 0; side < 2; side++) {
		struct rig_globe *globe = &rig->globe[side];
		if (!globe->own && !isfinite(center[side][0])) {
			ok = err_set(err, "no %s eyeball: the character has no round closed mesh there; give subject.eye_center.%s and "
			             "subject.eye_radius", sides[side], sides[side]);
			continue;
		}
		if (!globe->own) {
			globe->radius = radius;
			vec_add(globe->center, center[side], 0, center[side]);
			globe->map = globe_map_round(conf->globe_cells, radius, cornea_share * radius, apex_share * radius);
		}
		report->cornea_added[side] = globe->own && conf->cornea_bulge > 0 && add_cornea(&globe->map, globe->radius, conf->cornea_bulge);
	}
	return ok;
}
