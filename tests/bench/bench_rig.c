/* bench_rig: what one frame of a driven character costs a vertex, and how far the folded, single-precision rig is from
 * the paper's general path (model, barycentric map, extrapolation, algorithm 1 as printed) in double precision. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/simd.h"
#include "math/vec.h"
#include "rig/deform/deform.h"
#include "rig/deform/impl.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/bench/fronts.h"
#include "tests/lib/scratch.h"

struct general {
	const struct face *face;
	const struct rig *rig;
	const struct rig_motion *motion;
	double c[12], turn[2][3][3], *u, *u_rest, *ut;
	double (*x)[3], (*normal)[3];
};

/* The skull map in double precision. */
static void skull(double p[3], double n[3], const struct skull_map *m, const double px[2])
{
	double u = fmin(fmax((px[0] - m->x0) / m->step, 0), m->width - 1.001), v = fmin(fmax((px[1] - m->y0) / m->step, 0), m->height - 1.001);
	int iu = (int)u, iv = (int)v;
	const float *t = m->texel + ((long)iv * m->width + iu) * SKULL_CHANNELS;
	u -= iu;
	v -= iv;
	for (int k = 0; k < 6; k++) {
		double a = t[k], b = t[k + SKULL_CHANNELS], c = t[k + (long)m->width * SKULL_CHANNELS];
		double d = t[k + ((long)m->width + 1) * SKULL_CHANNELS];
		*(k < 3 ? &p[k] : &n[k - 3]) = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
	}
}

/* Algorithm 1 as printed, with this project's offset of the skull map and its fading delta0. */
static void algorithm1(struct general *g, int i, const double px[2])
{
	const struct rig *rig = g->rig;
	const struct rig_globe *globe = &rig->globe[rig->side[i]];
	double home[2] = { rig->home[i][0], rig->home[i][1] }, at[3], facing[3], at0[3], facing0[3], tau[3], tau0[3], r[3], axis[3], nn[3];
	skull(at, facing, &rig->skull, px);
	skull(at0, facing0, &rig->skull, home);
	for (int k = 0; k < 3; k++) {
		at[k] += rig->rest[i][k] - at0[k];
		facing[k] += rig->normal[i][k] - facing0[k];
		tau[k] = at[k] - globe->center[k];
		tau0[k] = rig->rest[i][k] - globe->center[k];
	}
	mat_tvec(r, (const double(*)[3])g->turn[rig->side[i]], tau);
	// The paper's polar angles, and D through them.
	double len = vec_norm(r), a = atan2(r[0], r[2]), b = acos(r[1] / len);
	float dir[3] = { (float)(sin(b) * sin(a)), (float)cos(b), (float)(sin(b) * cos(a)) };
	double D = globe_map_at(&globe->map, dir), out = D + rig->thickness[i], w = rig->glue[i];
	double pushed = fmax(len, out), to = pushed + w * (D + rig->gap[i] - pushed);
	vec_unit(tau, tau);
	vec_unit(tau0, tau0);
	double turn[3][3];
	mat_smallest_rotation(turn, tau0, tau);
	mat_vec(axis, (const double(*)[3])turn, (double[]){ rig->normal[i][0], rig->normal[i][1], rig->normal[i][2] });
	double on = fmin(fmax(10 * (out - len), 0), 1);
	for (int k = 0; k < 3; k++) {
		nn[k] = facing[k] + on * (tau[k] - facing[k]);
		nn[k] += w * (axis[k] - nn[k]);
		g->x[i][k] = globe->center[k] + to * tau[k];
	}
	vec_unit(g->normal[i], nn);
}

/* Equations 3.2 to 3.5 one after the other, then algorithm 1. */
static void general_frame(void *ctx)
{
	struct general *g = ctx;
	const struct rig *rig = g->rig;
	skin_model_predict(g->u, 0, &g->face->model, g->c);
	for (int i = 0; i < rig->n; i++)
		for (int k = 0; k < 2; k++) {
			double sum = 0;
			for (int j = g->face->b_start[i]; j < g->face->b_start[i + 1]; j++) {
				int col = 2 * g->face->b_column[j] + k;
				sum += g->face->b_weight[j] * (g->u[col] - g->u_rest[col]);
			}
			g->ut[2 * i + k] = sum;
		}
	for (int i = 0; i < rig->n; i++) {
		double px[2] = { rig->home[i][0], rig->home[i][1] };
		if (rig->part[i] != RIG_SKIN)
			continue;
		for (int j = rig->bplus.start[i]; j < rig->bplus.start[i + 1]; j++)
			for (int k = 0; k < 2; k++)
				px[k] += rig->fade[i] * rig->bplus.weight[j] * g->ut[2 * rig->bplus.column[j] + k];
		algorithm1(g, i, px);
	}
}

struct folded {
	const struct rig *rig;
	const struct deform *deform;
	double c[12], turn[2][3][3];
	float (*x)[3], (*normal)[3];
};

static void folded_frame(void *ctx)
{
	struct folded *f = ctx;
	double e[RIG_COMPONENTS];
	rig_components(e, f->rig, f->c);
	deform_pose(f->deform, e, (const double(*)[3][3])f->turn, f->x, f->normal);
}

static void positions_frame(void *ctx)
{
	struct folded f = *(struct folded *)ctx;
	f.normal = 0;
	folded_frame(&f);
}

enum { LARGE = 20000 };

static void *tiled(const void *of, size_t size, int n)
{
	char *out = malloc(size * LARGE);
	for (int i = 0; i < LARGE; i++)
		memcpy(out + size * (size_t)i, (const char *)of + size * (size_t)(i % n), size);
	return out;
}

struct stream {
	uint32_t *in, seen;
	long n;
	float out[6 * LARGE];
};

/* Numbers of the rig that a frame reads (rig/deform/impl.h); the maps come on top. */
static long numbers(const struct deform *d)
{
	long n = (long)(sizeof *d->globe / sizeof(float)) * d->n_globe_blocks;
	for (int k = 0; k < d->n_blocks; k++) {
		size_t lids = sizeof d->terms->lids, all = sizeof *d->terms, skin = offsetof(struct deform_terms_block, lids);
		n += (long)((d->block[k].glue ? all - (d->block[k].lids ? 0 : lids) : skin + (d->block[k].lids ? lids : 0)) / sizeof(float));
	}
	return n;
}

/* What memory allows: every number read once, position and normal written once, one core. */
SIMD_CLONES static void read_and_write(struct stream *restrict s)
{
	const uint32_t *restrict in = s->in;
	uint32_t seen = 0;
	SIMD_LOOP
	for (int i = 0; i < 6 * LARGE; i++)
		s->out[i] = (float)s->seen;
#pragma omp simd reduction(^ : seen)
	for (long i = 0; i < s->n; i++)
		seen ^= in[i];
	s->seen += seen + 1;
}

static void stream(void *ctx)
{
	read_and_write(ctx);
}

/* What is left when algorithm 1 is left out: where 20 000 vertices are seen, four components of the skin. */
struct four {
	float mean[2][LARGE], basis[2][4][LARGE], u[2][LARGE], e[4], xyz[LARGE][3];
};

static void four_components(void *ctx)
{
	struct four *f = ctx;
	for (int c = 0; c < 2; c++) {
		const float *restrict m = f->mean[c], *restrict p = f->basis[c][0], *restrict q = f->basis[c][1], *restrict r = f->basis[c][2], *restrict s = f->basis[c][3];
		float *restrict u = f->u[c];
#pragma omp simd
		for (int i = 0; i < LARGE; i++)
			u[i] = m[i] + ((f->e[0] * p[i] + f->e[1] * q[i]) + (f->e[2] * r[i] + f->e[3] * s[i]));
	}
}

/* Nothing but storing 20 000 positions; they differ from call to call. */
static void positions_alone(void *ctx)
{
	struct four *f = ctx;
	float *restrict x = f->xyz[0], t = f->e[0] += 1;
#pragma omp simd
	for (int i = 0; i < 3 * LARGE; i++)
		x[i] = t;
}

/* The same rig over and over, to 20 000 vertices. free(). */
static struct rig large_of(const struct rig *small)
{
	struct rig rig = *small;
	rig.n = LARGE;
	rig.rest = tiled(rig.rest, sizeof *rig.rest, small->n);
	rig.normal = tiled(rig.normal, sizeof *rig.normal, small->n);
	rig.home = tiled(rig.home, sizeof *rig.home, small->n);
	rig.basis = tiled(rig.basis, sizeof *rig.basis, small->n);
	rig.glue = tiled(rig.glue, sizeof *rig.glue, small->n);
	rig.gap = tiled(rig.gap, sizeof *rig.gap, small->n);
	rig.thickness = tiled(rig.thickness, sizeof *rig.thickness, small->n);
	rig.side = tiled(rig.side, sizeof *rig.side, small->n);
	rig.part = tiled(rig.part, sizeof *rig.part, small->n);
	return rig;
}

static void large_free(struct rig *rig)
{
	void *const all[] = { rig->rest, rig->normal, rig->home, rig->basis, rig->glue, rig->gap, rig->thickness, rig->side, rig->part };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
}

/* small: whose controls it is driven by; of: in words. */
static struct bench_time large(const struct folded *small, const char *of)
{
	struct rig rig = large_of(small->rig);
	struct deform *deform = deform_new(&rig);
	struct folded f = *small;
	f.deform = deform;
	f.x = calloc(LARGE, sizeof *f.x);
	f.normal = calloc(LARGE, sizeof *f.normal);
	struct stream *s = calloc(1, sizeof *s);
	s->n = numbers(deform);
	s->in = calloc((size_t)s->n, sizeof *s->in);
	struct four *four = calloc(1, sizeof *four);
	void (*const fn[])(void *) = { folded_frame, stream, four_components, positions_alone };
	void *const ctx[] = { &f, s, four, four };
	struct bench_time t[4];
	bench_times(4, t, fn, ctx, bench_quick() ? 20 : 200);
	char setting[128], limit[96];
	int moving = deform->n + deform->n_globe;
	snprintf(setting, sizeof setting, "%s: %d vertices, %d of them move", of, LARGE, moving);
	snprintf(limit, sizeof limit, "%s: %.0f numbers read a vertex that moves, 6 written", of, (double)s->n / moving);
	bench_row("a driven frame of a large character", "folded, vector code: positions and normals", setting, t[0], "frame", NAN, "", "");
	bench_row("a driven frame of a large character", "limit: memory", limit, t[1], "frame", NAN, "", "");
	if (moving == LARGE) {
		bench_row("a driven frame of a large character", "limit: four components alone, without algorithm 1", "10 numbers read, 2 written a vertex", t[2], "frame", NAN, "", "");
		bench_row("a driven frame of a large character", "limit: positions stored, nothing computed", "3 written a vertex", t[3], "frame", NAN, "", "");
	}
	void *const all[] = { f.x, f.normal, s->in, s, four };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	large_free(&rig);
	deform_free(deform);
	return t[0];
}

/* The bundled head, as its own capture rigs it. */
static void bundled(const struct folded *like)
{
	struct err err = { 0 };
	struct rig rig = { 0 };
	struct folded f = *like;
	scratch_open();
	char *dir = mem_str(scratch_path("face")), *path = mem_printf("%s/work/targets/mpfb/rig.npz", dir);
	char *command = mem_printf("cp -r samples/face '%s' && rm -rf '%s/work' && echo 'quality = draft' >>'%s/capture.conf'", dir, dir, dir);
	if (!system(command) && fronts_make(dir, "extrapolate") && rig_load(&rig, path, &err) && rig.n_inputs <= COUNT(f.c)) {
		f.rig = &rig;
		rig_globes_turned(f.turn, &rig, f.c);
		struct bench_time t = large(&f, "the bundled head");
		bench_goal("deformation of 20 000 vertices of which as many move as of the bundled head's, one core", "<= 0.01 ms a frame (first worded: all of them moving)", 1e3 * t.median, "ms", t.median <= 1e-5);
	} else {
		fprintf(stderr, "bench_rig: the bundled head has no rig: %s\n", err.msg);
		bench_goal("deformation of the bundled head", "measured", NAN, "", false);
	}
	rig_free(&rig);
	scratch_close();
	free(command);
	free(path);
	free(dir);
}

int main(int argc, char **argv)
{
	bench_open("rig", argc, argv);
	struct face face;
	struct rig rig;
	struct rig_report report;
	struct rig_motion motion;
	struct err err = { 0 };
	face_make(&face, false);
	struct rig_conf conf = face_conf();
	struct rig_character character = face_character(&face);
	rig_motion_of_model(&motion, &face.model);
	if (!rig_make(&rig, &report, &motion, &character, &conf, &err)) {
		fprintf(stderr, "bench_rig: %s\n", err.msg);
		return 1;
	}
	struct deform *deform = deform_new(&rig);
	size_t n = (size_t)rig.n;
	int skin = report.tracked + report.extrapolated;
	struct general g = { &face, &rig, &motion, .u = calloc(2 * n, sizeof(double)), .u_rest = calloc(2 * n, sizeof(double)),
		                 .ut = calloc(2 * n, sizeof(double)), .x = calloc(n, sizeof *g.x), .normal = calloc(n, sizeof *g.normal) };
	struct folded f = { &rig, deform, .x = calloc(n, sizeof *f.x), .normal = calloc(n, sizeof *f.normal) };
	struct rng rng = { 21 };
	double worst = 0, worst_normal = 0;
	skin_model_predict(g.u_rest, 0, &face.model, face.model.rest_controls);
	for (int round = 0; round < (bench_quick() ? 4 : 30); round++) {
		for (int i = 0; i < 12; i++)
			f.c[i] = g.c[i] = i < 10 && i % 5 < 3 ? rng_range(&rng, -20, 20) : rng_uniform(&rng);
		for (int s = 0; s < 2; s++) {
			double gaze[3];
			for (int k = 0; k < 3; k++)
				gaze[k] = g.c[5 * s + k] * M_PI / 180;
			rig_globe_rotation(g.turn[s], &rig, gaze);
			memcpy(f.turn[s], g.turn[s], sizeof f.turn[s]);
		}
		general_frame(&g);
		folded_frame(&f);
		for (int i = 0; i < rig.n; i++)
			for (int k = 0; k < 3 && rig.part[i] == RIG_SKIN; k++) {
				worst = fmax(worst, fabs(g.x[i][k] - f.x[i][k]));
				worst_normal = fmax(worst_normal, fabs(g.normal[i][k] - f.normal[i][k]));
			}
	}
	void (*const fn[])(void *) = { folded_frame, positions_frame, general_frame };
	void *const ctx[] = { &f, &f, &g };
	struct bench_time t[3];
	bench_times(3, t, fn, ctx, bench_quick() ? 20 : 200);
	for (int k = 0; k < 3; k++)
		t[k] = bench_time_each(t[k], skin);
	char setting[64];
	snprintf(setting, sizeof setting, "%d vertices, all moving", skin);
	bench_row("a driven frame", "folded, vector code: positions and normals", setting, t[0], "vertex", 1000 * worst, "um", "position against the general path, worst");
	bench_row("a driven frame", "folded, vector code: positions alone", setting, t[1], "vertex", 1000 * worst, "um", "position against the general path, worst");
	bench_row("a driven frame", "general path, unfolded (paper)", setting, t[2], "vertex", 0, "um", "position against the general path, worst");
	bench_row("normals", "folded, vector code: positions and normals", setting, t[0], "vertex", worst_normal, "", "component of a unit normal against the general path, worst");
	bench_goal("model evaluation, algorithm 1 included, one core", "<= 50 ns a vertex a frame", 1e9 * t[0].median, "ns", t[0].median <= 50e-9);
	struct bench_time all = large(&f, "a made face");
	bench_goal("deformation of 20 000 vertices, all moving, algorithm 1 included, one core", "<= 0.01 ms a frame", 1e3 * all.median, "ms", all.median <= 1e-5);
	if (!bench_quick())
		bundled(&f);
	return bench_close();
}
