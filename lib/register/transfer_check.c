#include "register/transfer_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"
#include "mesh/closest.h"
#include "mesh/topology.h"
#include "register/eyes.h"
#include "register/nricp/frame.h"
#include "register/transfer_quality.h"

/* The triangles whose corners all follow. free(). */
static int32_t (*following(int *n, const struct transfer *t, const struct mesh *target))[3]
{
	int32_t (*faces)[3] = mem_array((size_t)target->n_faces + 1, sizeof *faces);
	*n = 0;
	for (int f = 0; f < target->n_faces; f++) {
		const int32_t *v = target->faces[f];
		if (fminf(t->confidence[v[0]], fminf(t->confidence[v[1]], t->confidence[v[2]])) > TRANSFER_TRUSTED)
			memcpy(faces[(*n)++], v, sizeof *faces);
	}
	return faces;
}

/* Share of the subject's area within `reach` of the mesh. */
static double covered_by(const struct mesh *mesh, const struct mesh *subject, double reach)
{
	enum { SAMPLES = 2000 };
	int step = 1 + subject->n_vertices / SAMPLES;
	double *area = mesh_vertex_areas(subject), all = 0, near = 0;
	struct closest_scene *scene = mesh->n_faces ? closest_new(mesh, 0) : 0;
	for (int i = 0; i < subject->n_vertices; i += step) {
		all += area[i];
		near += scene && closest_find(scene, subject->vertices[i], 0, 0, (float)reach, -1).face >= 0 ? area[i] : 0;
	}
	closest_free(scene);
	free(area);
	return all > 0 ? near / all : 0;
}

static void placed(double out[3], const double m[4][4], const float x[3])
{
	for (int r = 0; r < 3; r++)
		out[r] = m[r][0] * (double)x[0] + m[r][1] * (double)x[1] + m[r][2] * (double)x[2] + m[r][3];
}

static void normal_of(double n[3], double p[3][3])
{
	double a[3], b[3];
	vec_add(a, p[1], -1, p[0]);
	vec_add(b, p[2], -1, p[0]);
	vec_cross(n, a, b);
}

/* Flipped triangles and stretched edges. */
static void distortion(struct transfer_check *out, const struct transfer *t, const struct mesh *target, int n, const int32_t (*faces)[3])
{
	double *stretch = mem_array(3 * (size_t)n + 1, sizeof *stretch);
	int edges = 0;
	for (int f = 0; f < n; f++) {
		double was[3][3], is[3][3], before[3], after[3], d[3], e[3];
		for (int k = 0; k < 3; k++) {
			placed(was[k], t->subject_from_target, target->vertices[faces[f][k]]);
			for (int c = 0; c < 3; c++)
				is[k][c] = (double)t->registered[faces[f][k]][c];
		}
		normal_of(before, was);
		normal_of(after, is);
		out->flipped += vec_dot(before, after) < 0;
		for (int k = 0; k < 3; k++) {
			vec_add(d, was[(k + 1) % 3], -1, was[k]);
			vec_add(e, is[(k + 1) % 3], -1, is[k]);
			if (vec_norm(d) > 0)
				stretch[edges++] = fabs(log(fmax(vec_norm(e) / vec_norm(d), 1e-6)));
		}
	}
	out->stretch = edges ? stats_quantile(edges, stretch, 0.95) : 0;
	free(stretch);
}

/* How far the target's eyeballs, carried along, are from the subject's. */
static double eyes_off(const struct transfer *t, const struct mesh *target, const double subject_eye[2][3])
{
	double eye[2][3], radius, apart[3], d[3], worst = 0;
	struct mesh registered = *target;
	registered.vertices = t->registered;
	if (!eyes_of_target(eye, &radius, target) || !eyes_of_target(eye, &radius, &registered))
		return NAN;
	vec_add(apart, subject_eye[0], -1, subject_eye[1]);
	bool swapped = apart[0] < 0;  // eyes_of_target gives the one of larger x first
	for (int e = 0; e < 2; e++) {
		vec_add(d, eye[e ^ swapped], -1, subject_eye[e]);
		worst = fmax(worst, vec_norm(d) / vec_norm(apart));
	}
	return worst;
}

static double landmarks_off(const struct transfer *t, const struct mesh *subject, const struct nricp_landmarks *given, double size)
{
	double sum = 0;
	for (int i = 0; i < given->n; i++) {
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (double)t->registered[given->moving[i]][k] - (double)subject->vertices[given->fixed[i]][k];
		sum += vec_norm(d) / (size * given->n);
	}
	return given->n ? sum : NAN;
}

static void judge(struct transfer_check *c, const struct transfer_check_conf *limits, int faces)
{
	if (c->covered < limits->covered)
		snprintf(c->reason, sizeof c->reason, "%.0f %% of the subject has the character on it, must be at least %.0f %% (check_covered)",
		         100 * c->covered, 100 * limits->covered);
	else if (c->flipped > limits->flipped * faces)
		snprintf(c->reason, sizeof c->reason, "%d of %d triangles are turned over, must be at most %.2g %% (check_flipped)", c->flipped, faces,
		         100 * limits->flipped);
	else if (c->stretch > limits->stretch)
		snprintf(c->reason, sizeof c->reason, "its edges had to be stretched by a factor of %.2f, must be at most %.2f (check_stretch)",
		         exp(c->stretch), exp(limits->stretch));
	else if (c->eyes > limits->eyes)
		snprintf(c->reason, sizeof c->reason, "an eyeball lies %.2f of the distance between the eyes off the subject's, must be at most %.2f (check_eyes)",
		         c->eyes, limits->eyes);
	else if (c->landmarks > limits->landmarks)
		snprintf(c->reason, sizeof c->reason, "its landmarks lie %.2f of the subject's size off their places, must be at most %.2f (check_landmarks)",
		         c->landmarks, limits->landmarks);
}

bool transfer_check(struct transfer_check *out, const struct transfer *t, const struct mesh *target, const struct mesh *subject,
                    const double (*subject_eye)[3], const struct nricp_landmarks *given, const struct transfer_conf *conf,
                    const struct transfer_check_conf *limits)
{
	*out = (struct transfer_check){ .eyes = NAN, .landmarks = NAN };
	out->follow = (double)transfer_trusted(t) / fmax(t->n, 1);
	if (t->same_topology) {
		out->covered = 1;
		return true;
	}
	double center[3], size = mesh_size(center, subject);
	int n;
	int32_t (*faces)[3] = following(&n, t, target);
	struct mesh part = { target->n_vertices, n, t->registered, faces, 0 };
	out->covered = covered_by(&part, subject, conf->snap * size);
	distortion(out, t, target, n, (const int32_t(*)[3])faces);
	if (subject_eye)
		out->eyes = eyes_off(t, target, subject_eye);
	out->landmarks = landmarks_off(t, subject, given, size);
	judge(out, limits, n);
	free(faces);
	return !*out->reason;
}
