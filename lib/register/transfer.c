#include "register/transfer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/linalg.h"
#include "mesh/closest.h"
#include "mesh/kdtree.h"
#include "mesh/mesh_part.h"
#include "mesh/openness.h"
#include "register/nricp/frame.h"

static void unroom(struct transfer *t)
{
	void *const all[] = { t->registered, t->column, t->weight, t->face, t->bary, t->distance, t->confidence };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	t->n = 0;
	t->registered = 0;
	t->column = 0;
	t->weight = 0;
	t->face = 0;
	t->bary = 0;
	t->distance = t->confidence = 0;
}

void transfer_free(struct transfer *t)
{
	unroom(t);
	*t = (struct transfer){ 0 };
}

bool transfer_same_topology(const struct mesh *a, const struct mesh *b)
{
	return a->n_vertices == b->n_vertices && a->n_faces == b->n_faces && a->n_faces
	       && !memcmp(a->faces, b->faces, (size_t)a->n_faces * sizeof *a->faces);
}

static void room(struct transfer *out, int n)
{
	size_t m = (size_t)n + 1;
	*out = (struct transfer){ .n = n };
	out->registered = mem_new(m, sizeof *out->registered);
	out->column = mem_new(m, sizeof *out->column);
	out->weight = mem_new(m, sizeof *out->weight);
	out->face = mem_new(m, sizeof *out->face);
	out->bary = mem_new(m, sizeof *out->bary);
	out->distance = mem_new(m, sizeof *out->distance);
	out->confidence = mem_new(m, sizeof *out->confidence);
}

/* Row i of B: the corners of that face of the subject, rising. */
static void set_row(struct transfer *out, int i, const struct mesh *subject, int face, const float bary[3])
{
	int order[3] = { 0, 1, 2 };
	const int32_t *v = subject->faces[face];
	for (int a = 0; a < 2; a++)
		for (int b = 0; b < 2 - a; b++)
			if (v[order[b]] > v[order[b + 1]]) {
				int t = order[b];
				order[b] = order[b + 1];
				order[b + 1] = t;
			}
	double sum = (double)bary[0] + (double)bary[1] + (double)bary[2];
	out->face[i] = face;
	for (int k = 0; k < 3; k++) {
		out->bary[i][k] = (float)((double)bary[k] / sum);
		out->column[i][k] = v[order[k]];
		out->weight[i][k] = (double)bary[order[k]] / sum;
	}
}

/* The same topology: vertex i is vertex i, and its row of B is one 1. */
static void same(struct transfer *out, const struct mesh *target, const struct mesh *subject, const struct nricp_align_conf *conf)
{
	int *row = mem_array((size_t)target->n_vertices + 1, sizeof *row);
	for (int i = 0; i < target->n_vertices; i++)
		row[i] = i;
	struct nricp_landmarks all = { target->n_vertices, row, row };
	struct nricp_align_result pose;
	struct nricp_align_conf any = *conf;
	struct err none = { 0 };  // vertex goes to vertex, whatever the similarity
	any.scale_max = 1e9;
	nricp_align(&pose, target, subject, &all, &any, &none);
	memcpy(out->subject_from_target, pose.fixed_from_moving, sizeof pose.fixed_from_moving);
	out->scale = pose.scale;
	out->matched = out->covered = 1;
	out->same_topology = true;
	memcpy(out->registered, subject->vertices, (size_t)subject->n_vertices * sizeof *subject->vertices);
	for (int i = 0; i < out->n; i++) {
		int first = i < out->n - 2 ? i : out->n > 2 ? out->n - 3 : 0;  // three columns a row, rising; one counts
		for (int k = 0; k < 3; k++) {
			out->column[i][k] = first + k < out->n ? first + k : out->n - 1;
			out->weight[i][k] = first + k == i;
		}
		out->face[i] = -1;
		out->confidence[i] = 1;
	}
	for (int f = 0; f < subject->n_faces; f++)
		for (int k = 0; k < 3; k++) {
			float bary[3] = { k == 0, k == 1, k == 2 };
			set_row(out, subject->faces[f][k], subject, f, bary);
		}
	free(row);
}

/* m x */
static void place(double out[3], const double m[4][4], const float x[3])
{
	for (int r = 0; r < 3; r++)
		out[r] = m[r][0] * (double)x[0] + m[r][1] * (double)x[1] + m[r][2] * (double)x[2] + m[r][3];
}

void transfer_show_aligned(struct transfer *t, const struct mesh *target)
{
	struct transfer kept = *t;
	room(t, target->n_vertices);
	memcpy(t->subject_from_target, kept.subject_from_target, sizeof t->subject_from_target);
	t->scale = kept.scale;
	t->matched = kept.matched;
	t->fine = kept.fine;
	t->rival = kept.rival;
	for (int i = 0; i < t->n; i++) {
		double at[3];
		place(at, t->subject_from_target, target->vertices[i]);
		for (int k = 0; k < 3; k++)
			t->registered[i][k] = (float)at[k];
	}
}

/* Places vertices that were not matched: the similarity, and the mean displacement of the nearest matched vertices, weighted by
 * inverse squared distance. placed: of part's vertices. */
static void carry(struct transfer *out, const struct mesh *target, const struct mesh_part *part, const float (*placed)[3])
{
	enum { NEAR = 8 };
	int index[NEAR], near = part->mesh.n_vertices < NEAR ? part->mesh.n_vertices : NEAR;
	float d2[NEAR];
	struct kdtree *tree = kdtree_new(part->mesh.n_vertices, 3, part->mesh.vertices[0]);
	for (int i = 0; i < target->n_vertices; i++) {
		if (part->of[i] >= 0)
			continue;
		double at[3], sum[3] = { 0 }, weight = 0;
		place(at, out->subject_from_target, target->vertices[i]);
		kdtree_find(tree, 1, target->vertices[i], near, index, d2);
		for (int k = 0; k < near; k++) {
			double was[3], w = 1 / ((double)d2[k] + 1e-6 * (double)d2[near - 1] + 1e-300);
			place(was, out->subject_from_target, part->mesh.vertices[index[k]]);
			for (int c = 0; c < 3; c++)
				sum[c] += w * ((double)placed[index[k]][c] - was[c]);
			weight += w;
		}
		for (int c = 0; c < 3; c++)
			out->registered[i][c] = (float)(at[c] + sum[c] / weight);
	}
	kdtree_free(tree);
}

/* Distance of a registered vertex from its place by B. */
static float distance_to(const struct transfer *t, int i, const struct mesh *subject)
{
	double d2 = 0;
	for (int k = 0; k < 3; k++) {
		double at = 0;
		for (int c = 0; c < 3; c++)
			at += t->weight[i][c] * (double)subject->vertices[t->column[i][c]][k];
		d2 += pow(at - (double)t->registered[i][k], 2);
	}
	return (float)sqrt(d2);
}

/* Snaps every vertex to the nearest face of the subject that faces the same way: its row of B, distance and confidence. */
static void snap(struct transfer *out, const struct mesh *target, const struct mesh *subject, const struct mesh_part *target_part,
                 const struct mesh_part *subject_part, const struct nricp_result *result, const struct transfer_conf *conf)
{
	struct mesh registered = *target;
	registered.vertices = out->registered;
	double center[3], size = mesh_size(center, &subject_part->mesh);
	float (*own)[3] = mesh_normals(&registered), (*normals)[3] = mesh_normals(&subject_part->mesh);
	bool search = target_part->mesh.n_vertices < target->n_vertices;
	for (int p = 0; p < target_part->mesh.n_vertices; p++)
		search |= result->face[p] < 0;
	struct closest_scene *scene = search ? closest_new(&subject_part->mesh, (const float(*)[3])normals) : 0;
	float turn = (float)(conf->nricp.turn * size);
#pragma omp parallel for schedule(dynamic, 256)
	for (int i = 0; i < out->n; i++) {
		int p = target_part->of[i];
		struct closest_point c = { .bary = { 1 } };
		if (p >= 0 && result->face[p] >= 0) {
			c.face = result->face[p];
			memcpy(c.bary, result->bary[p], sizeof c.bary);
		} else
			c = closest_find(scene, out->registered[i], own[i], turn, INFINITY, -1);
		c.face = c.face < 0 ? 0 : c.face;
		// Where vertices are doubled, the part's faces name the first; the tracked rows are those of the subject's own faces.
		set_row(out, i, subject, subject_part->face[c.face], c.bary);
		out->distance[i] = distance_to(out, i, subject);
		double away = (double)out->distance[i] / (conf->snap * size);
		out->confidence[i] = p < 0 ? 0 : (float)((double)result->confidence[p] * exp(-away * away));
	}
	closest_free(scene);
	free(own);
	free(normals);
}

/* Marks a target's hidden surface: sockets behind the lids, insides of nose and mouth. A scanned subject has none, and matching would
 * draw them into its openings. Null: there is none, the mesh is inside out, or the subject has such surface, too. free(). */
static bool *only_hidden(const struct mesh *target, const struct mesh *subject, double least)
{
	enum { SAMPLES = 700 };
	static const double inside_out = 0.5, has_them = 0.1;
	double share = least > 0 ? mesh_hidden_share(target, least, SAMPLES) : 0;
	if (!(share > 0 && share < inside_out) || mesh_hidden_share(subject, least, SAMPLES) > has_them * share)
		return 0;
	bool *is = mem_new((size_t)target->n_vertices + 1, sizeof *is);
	mesh_hidden(is, target, least);
	return is;
}

static bool registered(struct transfer *out, const struct mesh *target, const struct mesh *subject, const struct nricp_landmarks *landmarks,
                       const struct transfer_conf *conf, struct err *err)
{
	struct mesh_part moving, fixed;
	struct nricp_align_result pose;
	struct nricp_result result = { 0 };
	bool *leave = only_hidden(target, subject, conf->open);
	mesh_part_make(&moving, target, conf->least_piece, leave);
	mesh_part_make(&fixed, subject, conf->least_piece, 0);
	free(leave);
	int n = 0, *rows = mem_array(2 * (size_t)(landmarks ? landmarks->n : 0) + 2, sizeof *rows), *to = rows + (landmarks ? landmarks->n : 0);
	for (int i = 0; landmarks && i < landmarks->n; i++)
		if (moving.of[landmarks->moving[i]] >= 0 && fixed.of[landmarks->fixed[i]] >= 0) {
			rows[n] = moving.of[landmarks->moving[i]];
			to[n++] = fixed.of[landmarks->fixed[i]];
		}
	struct nricp_landmarks kept = { n, rows, to };
	bool ok = nricp_align(&pose, &moving.mesh, &fixed.mesh, &kept, &conf->align, err);
	memcpy(out->subject_from_target, pose.fixed_from_moving, sizeof pose.fixed_from_moving);
	out->scale = pose.scale;
	out->matched = pose.matched;
	out->fine = pose.fine;
	out->rival = pose.rival;
	ok = ok && nricp_run(&result, &moving.mesh, &fixed.mesh, (const double(*)[4])pose.fixed_from_moving, &conf->nricp, err);
	if (ok) {
		out->rms = result.rms;
		out->covered = result.covered;
		for (int i = 0; i < out->n; i++)
			if (moving.of[i] >= 0)
				memcpy(out->registered[i], result.place[moving.of[i]], sizeof *out->registered);
		carry(out, target, &moving, (const float(*)[3])result.place);
		snap(out, target, subject, &moving, &fixed, &result, conf);
	}
	nricp_result_free(&result);
	mesh_part_free(&moving);
	mesh_part_free(&fixed);
	free(rows);
	return ok;
}

bool transfer_run(struct transfer *out, const struct mesh *target, const struct mesh *subject,
                  const struct nricp_landmarks *landmarks, const struct transfer_conf *conf, struct err *err)
{
	*out = (struct transfer){ 0 };
	if (!mesh_check(target, err))
		return false;
	if (!mesh_check(subject, err))
		return err_wrap(err, "the subject");
	room(out, target->n_vertices);
	int threads = linalg_serial();  // the factor's blocks are small: threads of BLAS would only wait for each other
	if (transfer_same_topology(target, subject))
		same(out, target, subject, &conf->align);
	else
		registered(out, target, subject, landmarks, conf, err);
	linalg_threads(threads);
	if (err_is(err))
		unroom(out);
	return !err_is(err);
}
