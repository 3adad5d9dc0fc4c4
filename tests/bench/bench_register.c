/* register: pairs of meshes with truth brought together as transfer does it, beside Open3D's rigid registration, where that is
 * installed (apt-get install python3-open3d), and the published figures of other programs on the same pairs. Errors in per cent
 * of the diagonal, processor seconds of one core from files to the result. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/pair.h"
#include "tests/peers/peer.h"
#include "tests/lib/scratch.h"
#include "tests/lib/conf/transfer_conf.h"

/* Other programs' measured figures: the whole program, one core of a desktop. The last of each pair is the fastest. */
struct peer {
	const char *pair, *method;
	double seconds, surface, truth;  // NAN: not given
};

static const struct peer peers[] = {
	{ "ict_id", "MeshMonk", 7.0, 0.0242, NAN },
	{ "ict_id", "MeshMonk pyramid", 2.5, 0.0274, 0.210 },
	{ "ict_id", "Fast_RNRR", 0.53, 0.065, 0.416 },
	{ "ict_id_noise", "MeshMonk pyramid", 3.4, 0.085, 0.368 },
	{ "ict_id_noise", "Fast_RNRR", 0.70, 0.114, 0.476 },
	{ "ict_id_outliers", "MeshMonk rigid + pyramid", 6.0, 0.0272, NAN },
	{ "ict_id_outliers", "MeshMonk pyramid", 3.7, NAN, 0.209 },
	{ "ict_id_outliers", "Fast_RNRR", 0.68, 0.065, 0.422 },
	{ "ict_id_partial", "MeshMonk pyramid", NAN, 0.071, 3.8 },
	{ "ict_id_partial", "SPARE", 3.7, 0.163, 0.574 },
	{ "ict_id_partial", "AMM_NRR", 1.38, 0.328, 3.33 },
	{ "ict_id_rot20", "SPARE", 5.1, 0.0256, NAN },
	{ "ict_id_rot20", "MeshMonk rigid + pyramid", 5.2, NAN, 0.213 },
	{ "ict_id_rot20", "AMM_NRR", 1.42, 0.262, 5.7 },
	{ "ict_id_26k", "MeshMonk pyramid", 7.6, 0.0140, NAN },
	{ "ict_id_26k", "AMM_NRR", 2.9, NAN, 0.303 },
	{ "ict_id_26k", "Fast_RNRR", 1.39, 0.0295, 0.321 },
	{ "ict_id_100k", "MeshMonk pyramid", 41, 0.0067, 0.280 },
	{ "ict_id_100k", "Fast_RNRR", 12.2, 0.0175, 0.325 },
	{ "ict_id_100k", "BCPD++", 5.0, 0.181, 0.738 },
};

/* Processor seconds that count as reached. */
static const struct {
	const char *name;
	double seconds;
} pairs[] = {
	{ "ict_id", 0.25 },       { "ict_id_noise", 0.25 }, { "ict_id_outliers", 0.25 }, { "ict_id_partial", 0.25 },
	{ "ict_id_rot20", 0.25 }, { "ict_id_26k", 0.69 },   { "ict_id_100k", 2.5 },
};

static double processor_s(void)
{
	return (double)clock() / CLOCKS_PER_SEC;
}

/* What the stage does with one character, but for writing. */
static double register_files(struct transfer *out, const char *name)
{
	char rel[2][256];
	struct mesh mesh[2] = { 0 };
	struct err err = { 0 };
	snprintf(rel[0], sizeof rel[0], "registration/%s/source.ply", name);
	snprintf(rel[1], sizeof rel[1], "registration/%s/target.ply", name);
	double start = processor_s();
	for (int i = 0; i < 2; i++)
		om_mesh_load(&mesh[i], bench_data(rel[i]), 10000000, &err);
	if (err_is(&err) || !transfer_run(out, &mesh[0], &mesh[1], 0, &transfer_defaults, &err))
		fprintf(stderr, "bench_register: %s: %s\n", name, err.msg);
	start = processor_s() - start;
	mesh_free(&mesh[0]);
	mesh_free(&mesh[1]);
	return start;
}

static void show_peers(const char *name)
{
	char table[64];
	for (int i = 0; i < COUNT(peers); i++) {
		const struct peer *p = &peers[i];
		if (strcmp(p->pair, name))
			continue;
		snprintf(table, sizeof table, "register %s", name);
		bench_row(table, p->method, "as published", bench_time_of(1, (double[]){ p->seconds }), "pair", p->surface, "%", "surface, mean");
		snprintf(table, sizeof table, "register %s, truth", name);
		bench_row(table, p->method, "as published", bench_time_of(1, (double[]){ p->seconds }), "pair", p->truth, "%", "true place, mean");
	}
}

/* Open3D moves and turns the mesh: what a registration that bends nothing leaves. */
static void open3d(const struct pair *pair, int reps)
{
	static const char *const methods[] = { "Open3D ICP, point to plane (rigid)", "Open3D features, RANSAC, ICP (rigid)" };
	char rel[2][256], table[64], *out = mem_str(scratch_path("open3d_%s", pair->name));
	snprintf(rel[0], sizeof rel[0], "registration/%s/source.ply", pair->name);
	snprintf(rel[1], sizeof rel[1], "registration/%s/target.ply", pair->name);
	char *command = mem_printf("OMP_NUM_THREADS=1 /usr/bin/python3 tests/peers/peer_open3d.py '%s' '%s' '%s' %d", bench_data(rel[0]),
	                           bench_data(rel[1]), out, reps);
	FILE *from = popen(command, "r");
	long n = 3L * pair->source.n_vertices;
	float(*place)[3] = mem_array((size_t)n, sizeof **place);
	for (int i = 0; from && i < COUNT(methods); i++) {
		struct bench_time time = peer_times(from);
		double *at = peer_array(scratch_path("open3d_%s_%d.npy", pair->name, i), n);
		for (long k = 0; at && k < n; k++)
			place[k / 3][k % 3] = (float)at[k];
		struct pair_error e = at ? pair_measure(pair, (const float(*)[3])place) : (struct pair_error){ NAN, NAN, NAN, NAN, -1 };
		snprintf(table, sizeof table, "register %s", pair->name);
		bench_row(table, methods[i], "run here", time, "pair", e.surface, "%", "surface, mean");
		snprintf(table, sizeof table, "register %s, truth", pair->name);
		bench_row(table, methods[i], "run here", time, "pair", e.truth, "%", "true place, mean");
		free(at);
	}
	if (from)
		pclose(from);
	free(place);
	free(command);
	free(out);
}

static double best(const char *name, bool of_surface)
{
	double least = INFINITY;
	for (int i = 0; i < COUNT(peers); i++)
		if (!strcmp(peers[i].pair, name))
			least = fmin(least, of_surface ? peers[i].surface : peers[i].truth);
	return least;
}

static void goals(const char *name, double most_s, double seconds, const struct pair_error *e)
{
	char measure[128], reach[64];
	snprintf(measure, sizeof measure, "%s: surface error", name);
	snprintf(reach, sizeof reach, "<= %g %% (best of the others)", best(name, true));
	bench_goal(measure, reach, e->surface, "%", e->surface <= best(name, true));
	snprintf(measure, sizeof measure, "%s: error against the true places", name);
	snprintf(reach, sizeof reach, "<= %g %% (best of the others)", best(name, false));
	bench_goal(measure, reach, e->truth, "%", e->truth <= best(name, false));
	snprintf(measure, sizeof measure, "%s: processor time", name);
	snprintf(reach, sizeof reach, "<= %g s (half of the fastest)", most_s);
	bench_goal(measure, reach, seconds, "s", seconds <= most_s);
	snprintf(measure, sizeof measure, "%s: flipped triangles", name);
	bench_goal(measure, "none", e->flipped, "", e->flipped == 0);
}

static void one(const char *name, double most_s, bool peer)
{
	enum { REPS = 5 };
	struct pair pair;
	struct err err = { 0 };
	double seconds[REPS];
	char table[64];
	int reps = bench_quick() ? 1 : REPS;
	if (!pair_load(&pair, name, &err)) {
		fprintf(stderr, "bench_register: %s\n", err.msg);
		return;
	}
	struct pair_error e = { NAN, NAN, NAN, NAN, -1 };
	for (int i = 0; i < reps; i++) {
		struct transfer t;
		seconds[i] = register_files(&t, name);
		if (t.n)
			e = pair_measure(&pair, (const float(*)[3])t.registered);
		transfer_free(&t);
	}
	struct bench_time time = bench_time_of(reps, seconds);
	fprintf(stderr, "%-16s %.3f s  surface %.4f (95 %% %.4f)  true place %.4f (95 %% %.4f)  flipped %d\n", name, time.median,
	        e.surface, e.surface_95, e.truth, e.truth_95, e.flipped);
	snprintf(table, sizeof table, "register %s", name);
	bench_row(table, "transfer", "review", time, "pair", e.surface, "%", "surface, mean");
	snprintf(table, sizeof table, "register %s, truth", name);
	bench_row(table, "transfer", "review", time, "pair", e.truth, "%", "true place, mean");
	if (peer)
		open3d(&pair, reps < 3 ? reps : 3);
	show_peers(name);
	goals(name, most_s, time.median, &e);
	pair_free(&pair);
}

int main(int argc, char **argv)
{
	bench_open("register", argc, argv);
	scratch_open();
	bool peer = peer_installed("bench_register", "open3d", "python3-open3d");
	omp_set_num_threads(1);
	for (int i = 0; i < COUNT(pairs); i++)
		if (!bench_quick() || !strcmp(pairs[i].name, "ict_id") || !strcmp(pairs[i].name, "ict_id_rot20"))
			one(pairs[i].name, pairs[i].seconds, peer);
	scratch_close();
	return bench_close();
}
