#include "tests/lib/truth/pair.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/stats.h"
#include "math/vec.h"
#include "mesh/closest.h"
#include "tests/lib/bench/bench.h"

static bool load(struct mesh *mesh, const char *folder, const char *file, struct err *err)
{
	char rel[256];
	snprintf(rel, sizeof rel, "registration/%s/%s", folder, file);
	const char *path = bench_data(rel);
	return path ? om_mesh_load(mesh, path, 10000000, err) : err_set(err, "%s is not there", rel);
}

/* Of noise, strays, holes and turning the surface is that of the plain pair. */
static bool has_own_surface(const char *name)
{
	return !strcmp(name, "ict_id") || !strcmp(name, "ict_id_26k") || !strcmp(name, "ict_id_100k");
}

static bool load_covered(struct pair *p)
{
	char rel[256];
	snprintf(rel, sizeof rel, "registration/%s/mask.txt", p->name);
	const char *path = bench_data(rel);
	p->covered = mem_array((size_t)p->source.n_vertices, sizeof *p->covered);
	FILE *f = path ? fopen(path, "r") : 0;
	bool ok = true;
	for (int i = 0, covered; i < p->source.n_vertices; i++) {
		p->covered[i] = true;
		if (f) {
			ok = ok && fscanf(f, "%d", &covered) == 1;
			p->covered[i] = ok && covered;
		}
	}
	if (f)
		fclose(f);
	return ok;
}

static bool load_diag(struct pair *p, struct err *err)
{
	char rel[256];
	snprintf(rel, sizeof rel, "registration/%s/info.json", p->name);
	const char *path = bench_data(rel);
	json_t *root = path ? json_load_file(path, 0, 0) : 0;
	p->diag = json_number_value(json_object_get(root, "diag"));
	json_decref(root);
	return p->diag > 0 || err_set(err, "%s: must have diag, a number above 0", rel);
}

bool pair_load(struct pair *p, const char *name, struct err *err)
{
	struct mesh truth = { 0 };
	*p = (struct pair){ .name = name };
	bool ok = load(&p->source, name, "source.ply", err) && load(&p->target, name, "target.ply", err)
	          && load(&p->clean, has_own_surface(name) ? name : "ict_id", "target.ply", err) && load(&truth, name, "truth.ply", err);
	if (ok && truth.n_vertices != p->source.n_vertices)
		ok = err_set(err, "%s: truth of %d vertices, source of %d", name, truth.n_vertices, p->source.n_vertices);
	p->truth = truth.vertices;
	truth.vertices = 0;
	mesh_free(&truth);
	if (ok && !load_covered(p))
		ok = err_set(err, "%s: mask.txt is short", name);
	ok = ok && load_diag(p, err);
	if (!ok)
		pair_free(p);
	return ok;
}

void pair_free(struct pair *p)
{
	mesh_free(&p->source);
	mesh_free(&p->target);
	mesh_free(&p->clean);
	free(p->truth);
	free(p->covered);
	*p = (struct pair){ 0 };
}

static double mean(int n, const double *x)
{
	double sum = 0;
	for (int i = 0; i < n; i++)
		sum += x[i] / n;
	return n ? sum : NAN;
}

static void normal_of(double n[3], const float (*v)[3], const int32_t f[3])
{
	double e[3], g[3];
	for (int k = 0; k < 3; k++) {
		e[k] = (double)v[f[1]][k] - (double)v[f[0]][k];
		g[k] = (double)v[f[2]][k] - (double)v[f[0]][k];
	}
	vec_cross(n, e, g);
}

struct pair_error pair_measure(const struct pair *p, const float (*place)[3])
{
	struct pair_error out = { 0 };
	int n = p->source.n_vertices, covered = 0;
	double *surface = mem_array((size_t)n + 1, sizeof *surface), *truth = mem_array((size_t)n + 1, sizeof *truth);
	struct closest_scene *scene = closest_new(&p->clean, 0);
	for (int i = 0; i < n; i++) {
		double d2 = 0;
		surface[i] = 100 * (double)closest_find(scene, place[i], 0, 0, INFINITY, -1).distance / p->diag;
		for (int k = 0; k < 3; k++)
			d2 += pow((double)place[i][k] - (double)p->truth[i][k], 2);
		if (p->covered[i])
			truth[covered++] = 100 * sqrt(d2) / p->diag;
	}
	closest_free(scene);
	out.surface = mean(n, surface);
	out.truth = mean(covered, truth);
	out.surface_95 = stats_quantile(n, surface, 0.95);
	out.truth_95 = stats_quantile(covered, truth, 0.95);
	for (int f = 0; f < p->source.n_faces; f++) {
		double before[3], after[3];
		normal_of(before, (const float(*)[3])p->source.vertices, p->source.faces[f]);
		normal_of(after, place, p->source.faces[f]);
		out.flipped += vec_dot(before, after) < 0;
	}
	free(surface);
	free(truth);
	return out;
}
