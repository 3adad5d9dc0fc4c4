#include "register/nricp/align.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "register/nricp/align_impl.h"
#include "register/nricp/frame.h"

/* Samples vertices of the fixed mesh in even steps of cumulated area. */
static void take_samples(struct search *s, const struct mesh *fixed, const double center[3], double size)
{
	double *area = mesh_vertex_areas(fixed), sum = 0, passed = 0;
	float (*normal)[3] = mesh_normals(fixed);
	s->samples = mem_new((size_t)s->conf->samples + 1, sizeof *s->samples);
	for (int i = 0; i < fixed->n_vertices; i++)
		sum += area[i];
	for (int i = 0; i < fixed->n_vertices && s->n < s->conf->samples; i++) {
		passed += area[i];
		if (!(passed > sum * (s->n + 0.5) / s->conf->samples))
			continue;
		for (int k = 0; k < 3; k++) {
			s->samples[s->n].at[k] = ((double)fixed->vertices[i][k] - center[k]) / size;
			s->samples[s->n].normal[k] = normal[i][k];
		}
		s->n++;
	}
	s->face = mem_array((size_t)s->n + 1, sizeof *s->face);
	free(area);
	free(normal);
}

static void take_landmarks(struct search *s, const struct nricp_landmarks *l, const struct mesh *fixed, const double center[3],
                           double size)
{
	if (!l || l->n < 3)
		return;
	s->held = mem_new((size_t)l->n, sizeof *s->held);
	for (int i = 0; i < l->n; i++) {
		for (int k = 0; k < 3; k++)
			s->held[i].at[k] = ((double)fixed->vertices[l->fixed[i]][k] - center[k]) / size;
		s->held[i].row = l->moving[i];
	}
	s->n_held = l->n;
}

/* The similarity that fits the landmarks best (least squares), by Gauss-Newton steps from 24 rotations: from one alone they may end
 * at a saddle. False: no landmarks, or no solution. */
static bool from_landmarks(struct pose *best, const struct search *s)
{
	enum { ROUNDS = 30 };
	double cube[24][3][3], least = INFINITY;
	align_cube(cube);
	for (int c = 0; c < 24 && s->n_held; c++) {
		struct pose pose = pose_still;
		memcpy(pose.rotation, cube[c], sizeof pose.rotation);
		bool ok = true;
		for (int round = 0; round < ROUNDS && ok; round++) {
			struct sums sums = { 0 };
			align_hold(&sums, s, &pose, s->n_held);
			for (int k = 0; k < 7; k++)
				sums.a[k][k] += 1e-9;
			ok = sums_move(&pose, &sums, s->conf->scale_max);
		}
		double off = ok ? align_held_off(s, &pose) : INFINITY;
		if (off < 0.999 * least) {
			least = off;
			*best = pose;
		}
	}
	return isfinite(least);
}

/* Inverts the pose and returns to the meshes' own unit. */
static void give(struct nricp_align_result *out, const struct best *best, const double moving_center[3], const double fixed_center[3],
                 double size)
{
	double inverse = 1 / best->pose.scale, back[3];
	*out = (struct nricp_align_result){ .scale = inverse, .matched = best->matched, .rms = best->rms * size,
	                                      .fine = best->fine, .rival = best->rival };
	mat_tvec(back, best->pose.rotation, best->pose.shift);
	for (int r = 0; r < 3; r++) {
		double moved = 0;
		for (int c = 0; c < 3; c++) {
			out->fixed_from_moving[r][c] = inverse * best->pose.rotation[c][r];
			moved += out->fixed_from_moving[r][c] * moving_center[c];
		}
		out->fixed_from_moving[r][3] = fixed_center[r] - inverse * size * back[r] - moved;
	}
	out->fixed_from_moving[3][3] = 1;
}

/* Whether the pose stands out among all. */
static bool known(const struct nricp_align_result *r, const struct nricp_align_conf *conf, struct err *err)
{
	if (r->matched < conf->least)
		return err_set(err, "%.0f %% of the subject lies on it wherever it is put, must be at least %.0f %%", 100 * r->matched,
		               100 * conf->least);
	if (r->bound)
		return err_set(err, "its scale ends at the bound (%.3g, must be within a factor of %g): its unit, or its shape, is another",
		               r->scale, conf->scale_max);
	if (r->rival > 0 && !nricp_stands_out(r->fine, r->rival, conf->margin))
		return err_set(err, "two poses fit it nearly as well (%.0f and %.0f %% of the subject lie close to it): which way up it is, is not known",
		               100 * r->fine, 100 * r->rival);
	return true;
}

bool nricp_align(struct nricp_align_result *out, const struct mesh *moving, const struct mesh *fixed,
                 const struct nricp_landmarks *landmarks, const struct nricp_align_conf *conf, struct err *err)
{
	static const double same[4][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } };
	double fixed_center[3], moving_center[3], offset[3], size = mesh_size(fixed_center, fixed);
	*out = (struct nricp_align_result){ 0 };
	if (!(size > 0) || !(mesh_size(moving_center, moving) > 0))
		return err_set(err, "no surface to align");
	struct search s = { .conf = conf };
	s.moving = nricp_carried(moving, same, moving_center, 1 / size);
	s.normals = mesh_normals(&s.moving);
	topology_make(&s.topology, &s.moving);
	s.scene = closest_new(&s.moving, (const float(*)[3])s.normals);
	take_samples(&s, fixed, fixed_center, size);
	take_landmarks(&s, landmarks, fixed, fixed_center, size);
	for (int k = 0; k < 3; k++)
		offset[k] = (fixed_center[k] - moving_center[k]) / size;
	struct best best = { .pose = pose_still };
	if (from_landmarks(&best.pose, &s)) {
		const double narrow[2] = { conf->welsch[1], conf->welsch[1] };
		align_finish(&best, &s, narrow);
	} else {
		s.n_held = 0;
		best = align_find(&s, offset);
	}
	give(out, &best, moving_center, fixed_center, size);
	out->bound = fabs(log(best.pose.scale)) > 0.999 * log(conf->scale_max);
	free(s.moving.vertices);
	free(s.normals);
	topology_free(&s.topology);
	closest_free(s.scene);
	free(s.samples);
	free(s.face);
	free(s.held);
	return known(out, conf, err);
}
