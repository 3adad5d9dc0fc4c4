#include "track/head/rigid.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/vec.h"

enum { P = 6, STARTS = 5, COARSE_POINTS = 60, COARSE_FRAMES = 8, COARSE_STEPS = 6, STEPS = 12, ROUNDS = 3, LEAST_POINTS = 20 };

static const double correlated = 25;      // measurements that err together: neighbouring skin, neighbouring frames
static const double least_px = 0.3;       // of a measurement: of skin that is followed well
static const double step_turn = 2e-3, step_shift = 0.1;  // radians, mm: of numeric derivatives
static const double grazing = 0.35, clear_mm = 1.5;      // cosine of the steepest skin that counts; of it from what hides it
static const double lost_px = 20;         // residual of a point that lies off the mesh
static const double least_share = 0.2;    // of the points that are seen where they tell a pose

struct task {
	const struct rigid_film *film;
	const struct mesh *mesh;
	const struct ray_scene *rays;
	float *seen;                         // [film's frames][film's points]: what is left of the film's
	const struct camera *camera;
	const struct rigid_anchor *anchor;
	int anchors, every_point, every_frame, points, frames;  // what is taken of the film
	double robust;
	double (*pose)[4][4];                // [frames]; start and result of the frames' own
};

static int rows_of(const struct task *t)
{
	return 2 * (t->points * t->frames + t->anchors);
}

/* The point of the mesh at a pixel, and its face; -1 where there is none. */
static int face_at(double head[3], const struct task *t, const double m[4][4], const double px[2])
{
	double ray[3], from[3], to[3], origin[3] = { 0 };
	camera_ray(ray, t->camera, px);
	head_to(from, m, origin);
	head_to(to, m, ray);
	float o[3], d[3];
	for (int k = 0; k < 3; k++) {
		o[k] = (float)from[k];
		d[k] = (float)(to[k] - from[k]);
	}
	struct ray_hit hit = ray_first(t->rays, o, d, 0, FLT_MAX);
	for (int k = 0; k < 3; k++)
		head[k] = from[k] + (double)hit.t * (to[k] - from[k]);
	return hit.face;
}

static bool on_mesh(double head[3], const struct task *t, const double m[4][4], const double px[2])
{
	return face_at(head, t, m, px) >= 0;
}

/* Residuals (px) with the frames' poses fitted to a reference's; weight: of each, before robust weights. Returns the robust cost. */
static double residuals(double *r, double *weight, struct task *t, const double m[4][4])
{
	struct head_sight *sights = mem_new((size_t)t->points + 1, sizeof *sights);
	double cost = 0, robust2 = t->robust * t->robust;
	bool *there = mem_new((size_t)t->points + 1, sizeof *there);
	for (int i = 0; i < t->points; i++)
		there[i] = on_mesh(sights[i].head, t, m, t->film->at[i * t->every_point]);
	int row = 0;
	for (int f = 0; f < t->frames; f++) {
		const long at = (long)f * t->every_frame * t->film->points;
		for (int i = 0; i < t->points; i++) {
			const float *px = t->film->px[at + i * t->every_point];
			sights[i].px[0] = (double)px[0];
			sights[i].px[1] = (double)px[1];
			sights[i].weight = there[i] ? (double)t->seen[at + i * t->every_point] * t->film->weight[i * t->every_point] : 0;
		}
		head_pose_fit(t->pose[f], t->points, sights, t->camera, t->robust, 0);
		for (int i = 0; i < t->points; i++, row += 2) {
			double px[2], w = (double)t->seen[at + i * t->every_point] * t->film->weight[i * t->every_point];
			bool seen = there[i] && head_project(px, t->camera, t->pose[f], sights[i].head);
			for (int k = 0; k < 2; k++)
				r[row + k] = seen ? px[k] - sights[i].px[k] : 0;
			weight[row] = weight[row + 1] = seen ? w : 0;
			double e2 = seen ? r[row] * r[row] + r[row + 1] * r[row + 1] : lost_px * lost_px;
			cost += w * e2 / (1 + e2 / robust2);
		}
	}
	for (int a = 0; a < t->anchors; a++, row += 2) {
		double px[2] = { 0 };
		bool seen = head_project(px, t->camera, m, t->anchor[a].head);
		// of as much weight as their sigma says beside all of the measurements, which err together
		double w = correlated / (t->anchor[a].sigma_px * t->anchor[a].sigma_px);
		for (int k = 0; k < 2; k++) {
			r[row + k] = seen ? px[k] - t->anchor[a].px[k] : 1e3;
			cost += w * r[row + k] * r[row + k];
		}
		weight[row] = weight[row + 1] = w;
	}
	free(sights);
	free(there);
	return cost;
}

static void pivot_of(double pivot[3], const struct task *t, const double m[4][4])
{
	int n = 0;
	pivot[0] = pivot[1] = pivot[2] = 0;
	for (int i = 0; i < t->points; i++) {
		double head[3], p[3];
		if (!on_mesh(head, t, m, t->film->at[i * t->every_point]))
			continue;
		head_from(p, m, head);
		vec_add(pivot, pivot, 1, p);
		n++;
	}
	for (int k = 0; k < 3; k++)
		pivot[k] /= n ? n : 1;
}

/* The normal equations at m: derivatives by differences, the frames' poses following. */
static void normal(double H[P][P], double g[P], struct task *t, const double m[4][4], const double *r, const double *weight, const double pivot[3])
{
	const int rows = rows_of(t);
	double *J = mem_array((size_t)P * (size_t)rows + 1, sizeof *J), *w = mem_array((size_t)rows + 1, sizeof *w);
	double(*was)[4][4] = mem_array((size_t)t->frames + 1, sizeof *was);
	memcpy(was, t->pose, (size_t)t->frames * sizeof *was);
	for (int k = 0; k < P; k++) {
		double d[P] = { 0 }, moved[4][4], *column = J + (size_t)k * (size_t)rows;
		d[k] = k < 3 ? step_turn : step_shift;
		head_moved(moved, m, d, pivot);
		residuals(column, w, t, moved);
		for (int i = 0; i < rows; i++)
			column[i] = w[i] > 0 && weight[i] > 0 ? (column[i] - r[i]) / d[k] : 0;
		memcpy(t->pose, was, (size_t)t->frames * sizeof *was);
	}
	memset(H, 0, P * sizeof *H);
	memset(g, 0, P * sizeof *g);
	for (int i = 0; i < rows; i += 2) {
		double e2 = r[i] * r[i] + r[i + 1] * r[i + 1], robust = i < rows - 2 * t->anchors ? 1 / (1 + e2 / (t->robust * t->robust)) : 1;
		for (int c = i; c < i + 2; c++)
			for (int a = 0; a < P; a++) {
				const double wa = weight[i] * robust * robust * J[(size_t)a * (size_t)rows + (size_t)c];
				g[a] -= wa * r[c];
				for (int b = 0; b < P; b++)
					H[a][b] += wa * J[(size_t)b * (size_t)rows + (size_t)c];
			}
	}
	free(was);
	free(J);
	free(w);
}

/* Levenberg-Marquardt from m. Returns the cost; sigma may be null. */
static double climb(double m[4][4], double sigma[P], double *off_px, struct task *t, int steps)
{
	const int rows = rows_of(t);
	double *r = mem_array((size_t)rows + 1, sizeof *r), *w = mem_array((size_t)rows + 1, sizeof *w), damp = 1e-3, H[P][P], g[P];
	double(*was)[4][4] = mem_array((size_t)t->frames + 1, sizeof *was);
	double cost = residuals(r, w, t, m);
	for (int step = 0; step < steps; step++) {
		double pivot[3], next[4][4];
		pivot_of(pivot, t, m);
		normal(H, g, t, m, r, w, pivot);
		for (int k = 0; k < P; k++)
			H[k][k] *= 1 + damp;
		memcpy(was, t->pose, (size_t)t->frames * sizeof *was);
		if (!chol_solve(P, P, &H[0][0], g))
			break;
		head_moved(next, m, g, pivot);
		double now = residuals(r, w, t, next);
		if (now < cost) {
			bool small = cost - now < 1e-5 * cost;
			memcpy(m, next, sizeof next);
			cost = now;
			damp = fmax(0.1 * damp, 1e-6);
			if (small)
				break;
		} else {
			memcpy(t->pose, was, (size_t)t->frames * sizeof *was);
			residuals(r, w, t, m);
			damp = fmax(10 * damp, 1e-4);
			if (damp > 1e3)
				break;
		}
	}
	if (sigma) {
		double pivot[3], sum = 0, weight = 0;
		pivot_of(pivot, t, m);
		residuals(r, w, t, m);
		normal(H, g, t, m, r, w, pivot);
		for (int i = 0; i < rows - 2 * t->anchors; i += 2) {
			double e2 = r[i] * r[i] + r[i + 1] * r[i + 1], k = 1 / (1 + e2 / (t->robust * t->robust));
			sum += w[i] * k * k * e2;
			weight += w[i] * k * k;
		}
		*off_px = sqrt(sum / fmax(weight, 1e-12));
		// variances: unit weight stands for the mean residual
		double unit = correlated * fmax(0.5 * sum, least_px * least_px * weight) / fmax(1, 0.5 * (rows - 2 * t->anchors));
		for (int k = 0; k < P; k++) {
			double A[P][P], e[P] = { 0 };
			memcpy(A, H, sizeof A);
			e[k] = 1;
			sigma[k] = chol_solve(P, P, &A[0][0], e) ? sqrt(fmax(0, e[k]) * unit) : INFINITY;
		}
	}
	free(was);
	free(r);
	free(w);
	return cost;
}

/* Part of the film, every frame's pose at `m`. */
static struct task part_of(const struct task *whole, int points, int frames)
{
	struct task t = *whole;
	t.every_point = t.film->points > points ? t.film->points / points : 1;
	t.every_frame = t.film->frames > frames ? t.film->frames / frames : 1;
	t.points = t.film->points / t.every_point;
	t.frames = t.film->frames / t.every_frame;
	t.pose = mem_array((size_t)t.frames + 1, sizeof *t.pose);
	return t;
}

/* Whether a camera sees a point of a face, and not at a grazing angle. */
static bool faces(const struct task *t, const double m[4][4], const double head[3], int face)
{
	double from[3], origin[3] = { 0 }, a[3], b[3], n[3], d[3];
	float o[3], dir[3];
	const int32_t *c = t->mesh->faces[face];
	head_to(from, m, origin);
	for (int k = 0; k < 3; k++) {
		a[k] = (double)t->mesh->vertices[c[1]][k] - (double)t->mesh->vertices[c[0]][k];
		b[k] = (double)t->mesh->vertices[c[2]][k] - (double)t->mesh->vertices[c[0]][k];
		d[k] = head[k] - from[k];
		o[k] = (float)from[k];
		dir[k] = (float)d[k];
	}
	vec_cross(n, a, b);
	return -vec_dot(n, d) > grazing * vec_norm(n) * vec_norm(d) && !ray_blocked(t->rays, o, dir, 0, 1 - (float)(clear_mm / vec_norm(d)));
}

/* Leaves out of every frame of the film what is hidden in it, by the pose of the frame of the task next to it. */
static void hide(struct task *t, const double m[4][4])
{
	const struct rigid_film *film = t->film;
	for (int i = 0; i < film->points; i++) {
		double head[3];
		int face = face_at(head, t, m, film->at[i]);
		for (int f = 0; f < film->frames; f++) {
			int near = (f + t->every_frame / 2) / t->every_frame;
			const long at = (long)f * film->points + i;
			t->seen[at] = face >= 0 && faces(t, t->pose[near < t->frames ? near : t->frames - 1], head, face) ? film->seen[at] : 0;
		}
	}
}

static void at_rest(struct task *t, const double m[4][4])
{
	for (int f = 0; f < t->frames; f++)
		memcpy(t->pose[f], m, 16 * sizeof(double));
}

/* The frames whose pose is told: where most points are out of sight, what is left of them is strays. */
static void known_frames(struct rigid_fit *fit, const struct task *t)
{
	const double least = fmax(LEAST_POINTS, least_share * t->points);
	fit->n_known = 0;
	for (int f = 0; f < t->frames && fit->n_known < RIGID_KNOWN; f++) {
		const int frame = f * t->every_frame;
		double seen = 0;
		for (int i = 0; i < t->points; i++)
			seen += (double)t->seen[(long)frame * t->film->points + i * t->every_point];
		if (seen < least)
			continue;
		struct rigid_known *to = &fit->known[fit->n_known++];
		to->frame = frame;
		memcpy(to->cam_from_head, t->pose[f], sizeof to->cam_from_head);
	}
}

/* The largest angle between two of their poses, about the axes across the line of sight: rolls tell no depth. */
static double turned(const struct rigid_fit *fit)
{
	double most = 0, none[3] = { 0 };
	for (int a = 0; a < fit->n_known; a++)
		for (int b = 0; b < a; b++) {
			double d[P];
			head_motion(d, fit->known[a].cam_from_head, fit->known[b].cam_from_head, none);
			most = fmax(most, hypot(d[0], d[1]));
		}
	return most;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* The angle between the poses that the left and the right half of the points tell. */
static double apart(const struct task *whole, const double m[4][4])
{
	const struct rigid_film *film = whole->film;
	double *x = mem_array((size_t)film->points + 1, sizeof *x), *weight = mem_array((size_t)film->points + 1, sizeof *weight), pose[2][4][4], d[P], none[3] = { 0 };
	for (int i = 0; i < film->points; i++)
		x[i] = film->at[i][0];
	qsort(x, (size_t)film->points, sizeof *x, by_value);
	const double middle = x[film->points / 2];
	for (int half = 0; half < 2; half++) {
		struct rigid_film part = *film;
		struct task t = *whole;
		for (int i = 0; i < film->points; i++)
			weight[i] = (film->at[i][0] < middle) == !half ? film->weight[i] : 0;
		part.weight = weight;
		t.film = &part;
		t.pose = mem_array((size_t)t.frames + 1, sizeof *t.pose);
		memcpy(t.pose, whole->pose, (size_t)t.frames * sizeof *t.pose);
		memcpy(pose[half], m, sizeof pose[half]);
		climb(pose[half], 0, 0, &t, STEPS);
		free(t.pose);
	}
	head_motion(d, pose[1], pose[0], none);
	free(x);
	free(weight);
	return vec_norm(d);
}

bool rigid_fit(double cam_from_head[4][4], struct rigid_fit *fit, const struct rigid_film *film, const struct mesh *mesh, const struct camera *camera,
               int anchors, const struct rigid_anchor *anchor, const double reach[2], double robust)
{
	if (film->points < LEAST_POINTS || film->frames < 3 || !anchors)
		return false;
	const size_t all = (size_t)film->points * (size_t)film->frames;
	float *seen = mem_array(all + 1, sizeof *seen);
	struct ray_scene *rays = ray_scene_new(mesh->n_vertices, (const float(*)[3])mesh->vertices, mesh->n_faces, (const int32_t(*)[3])mesh->faces);
	struct task whole = { film, mesh, rays, seen, camera, anchor, anchors, 1, 1, 0, 0, robust, 0 };
	memcpy(seen, film->seen, all * sizeof *seen);
	struct task fine = part_of(&whole, 4 * COARSE_POINTS, 4 * COARSE_FRAMES);
	double start[4][4], pivot[3] = { 0 };
	memcpy(start, cam_from_head, sizeof start);
	for (int a = 0; a < anchors; a++) {
		double p[3];
		head_from(p, start, anchor[a].head);
		vec_add(pivot, pivot, 1.0 / anchors, p);
	}
	const int starts = reach[0] > 0 || reach[1] > 0 ? STARTS * STARTS : 1;
	double each[STARTS * STARTS], found[STARTS * STARTS][4][4];
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < starts; i++) {
		const int yaw = starts > 1 ? i % STARTS - STARTS / 2 : 0, pitch = starts > 1 ? i / STARTS - STARTS / 2 : 0;
		const double d[P] = { reach[1] * pitch / (STARTS / 2), reach[0] * yaw / (STARTS / 2) };
		struct task t = part_of(&whole, COARSE_POINTS, COARSE_FRAMES);
		head_moved(found[i], start, d, pivot);
		at_rest(&t, found[i]);
		t.robust = 4 * robust;
		each[i] = climb(found[i], 0, 0, &t, COARSE_STEPS);
		free(t.pose);
	}
	int best = 0;
	for (int i = 1; i < starts; i++)
		best = each[i] < each[best] ? i : best;
	memcpy(cam_from_head, found[best], sizeof found[best]);
	at_rest(&fine, cam_from_head);
	fine.robust = 4 * robust;
	climb(cam_from_head, 0, 0, &fine, STEPS / 4);
	for (int round = 0; round < ROUNDS; round++) {
		fine.robust = round ? robust : 2 * robust;
		hide(&fine, cam_from_head);
		climb(cam_from_head, fit->sigma, &fit->off_px, &fine, STEPS);
	}
	known_frames(fit, &fine);
	fit->turned = turned(fit);
	fit->apart = apart(&fine, cam_from_head);
	fit->used = fine.points * fine.frames;
	free(fine.pose);
	free(seen);
	ray_scene_free(rays);
	return true;
}
