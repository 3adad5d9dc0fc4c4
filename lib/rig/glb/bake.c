#include "rig/glb/bake.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/glb/poser.h"
#include "rig/glb/poses.h"

/* Most frames that the decomposition is computed from; the others are projected onto it. */
enum { LEARN = 320 };

/* From rest to now, in the rig's axes: target_from_globe head_from_target. */
static void quaternion(float q[4], const double target_from_globe[3][3], const double head_from_target[3][3])
{
	double m[3][3];
	mat_mul(m, target_from_globe, head_from_target);
	double w = 0.5 * sqrt(fmax(1 + m[0][0] + m[1][1] + m[2][2], 1e-12));  // gaze turns by less than half a circle
	double v[4] = { (m[2][1] - m[1][2]) / (4 * w), (m[0][2] - m[2][0]) / (4 * w), (m[1][0] - m[0][1]) / (4 * w), w };
	double len = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
	for (int k = 0; k < 4; k++)
		q[k] = (float)(v[k] / len);
}

static void find_moving(struct glb_bake *b, const struct rig *rig)
{
	b->vertex = mem_new((size_t)rig->n + 1, sizeof *b->vertex);
	for (int i = 0; i < rig->n; i++) {
		bool moves = rig->glue[i] > 0;
		for (int k = 0; k < RIG_BASIS; k++)
			moves = moves || rig->basis[i][k] != 0;
		if (moves && !rig_is_globe(rig->part[i]))
			b->vertex[b->n++] = i;
	}
}

/* Displacements of the frames that the decomposition is computed from. */
struct learnt {
	int n, *frame;
	float *x, *nrm, *hair;   // [n][3 moving], [n][3 n_hair]
};

static void evaluate(struct learnt *l, struct poser *p, struct glb_bake *b, const struct drive *drive)
{
	size_t row = 3 * (size_t)b->n;
	l->n = drive->n < LEARN ? drive->n : LEARN;
	l->frame = mem_new((size_t)l->n + 1, sizeof *l->frame);
	l->x = mem_array((size_t)l->n * row + 1, sizeof *l->x);
	l->nrm = mem_array((size_t)l->n * row + 1, sizeof *l->nrm);
	l->hair = mem_array(3 * (size_t)l->n * (size_t)p->n_hair + 1, sizeof *l->hair);
	for (int i = 0; i < 2; i++)
		b->turn[i] = mem_new(4 * (size_t)drive->n + 1, sizeof(float));
	for (int f = 0, k = 0; f < drive->n; f++) {
		double turn[2][3][3];
		poser_pose(p, drive_at(drive, f), turn);
		for (int s = 0; s < 2; s++)
			quaternion(b->turn[s] + 4 * f, (const double(*)[3])turn[s], p->rig->head_from_target);
		if (k < l->n && f == (int)((long)k * drive->n / l->n)) {
			poser_skin(l->x + (size_t)k * row, l->nrm + (size_t)k * row, p, b->n, b->vertex);
			poser_hair(l->hair + 3 * (size_t)k * (size_t)p->n_hair, p);
			l->frame[k++] = f;
		}
	}
}

/* Eigenvectors of the frames' inner products: by columns of gram, largest last; values rising. */
static bool decompose(double *gram, double *value, const struct learnt *l, size_t row, struct err *err)
{
	int n = l->n, threads = openblas_get_num_threads();
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < n; i++)
		for (int j = 0; j <= i; j++) {
			const float *a = l->x + (size_t)i * row, *b = l->x + (size_t)j * row;
			double part[8] = { 0 }, sum = 0;
			size_t k = 0;
			for (; k + 8 <= row; k += 8)
				for (int q = 0; q < 8; q++)
					part[q] += (double)a[k + (size_t)q] * b[k + (size_t)q];
			for (; k < row; k++)
				sum += (double)a[k] * b[k];
			for (int q = 0; q < 8; q++)
				sum += part[q];
			gram[(size_t)i * (size_t)n + (size_t)j] = gram[(size_t)j * (size_t)n + (size_t)i] = sum;
		}
	openblas_set_num_threads(1);  // rounding of its sums depends on their number
	bool ok = LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'L', n, gram, n, value) == 0;
	openblas_set_num_threads(threads);
	return ok || err_set(err, "morph targets: the decomposition did not converge");
}

/* target k = sum over frames of its eigenvector times their displacements; unit length, so that weights are projections. */
static void component(float *out, const float *frames, const double *gram, double value, const struct learnt *l, size_t row, int k)
{
	double scale = 1 / sqrt(value);
	memset(out, 0, row * sizeof *out);
	for (int f = 0; f < l->n; f++) {
		float w = (float)(gram[(size_t)f * (size_t)l->n + (size_t)(l->n - 1 - k)] * scale);
		for (size_t i = 0; i < row; i++)
			out[i] += w * frames[(size_t)f * row + i];
	}
}

/* Subtracts the last target's part from what is left of the frames; returns the largest remaining displacement, mm. */
static double worst_of(float *left, const struct learnt *l, const struct glb_bake *b)
{
	size_t row = 3 * (size_t)b->n;
	double worst = 0;
	const float *t = b->target + (size_t)(b->n_targets - 1) * row;
#pragma omp parallel for reduction(max : worst)
	for (int f = 0; f < l->n; f++) {
		float *x = left + (size_t)f * row;
		double w = 0;
		for (size_t i = 0; i < row; i++)
			w += (double)x[i] * t[i];
		for (size_t i = 0; i < row; i++)
			x[i] -= (float)w * t[i];
		for (size_t i = 0; i < row; i += 3)
			worst = fmax(worst, sqrt((double)x[i] * x[i] + (double)x[i + 1] * x[i + 1] + (double)x[i + 2] * x[i + 2]));
	}
	return worst;
}

/* Weights of every frame, by projection; then weights and targets are scaled so that no weight exceeds 1. */
static void weigh(struct glb_bake *b, struct poser *p, const struct drive *drive)
{
	size_t row = 3 * (size_t)b->n;
	float *x = mem_array(row + 1, sizeof *x), *n = mem_array(row + 1, sizeof *n);
	b->n_frames = drive->n;
	b->weight = mem_new((size_t)drive->n * (size_t)b->n_targets + 1, sizeof *b->weight);
	for (int f = 0; f < drive->n; f++) {
		double turn[2][3][3];
		poser_pose(p, drive_at(drive, f), turn);
		poser_skin(x, n, p, b->n, b->vertex);
		for (int k = 0; k < b->n_targets; k++) {
			double w = 0;
			for (size_t i = 0; i < row; i++)
				w += (double)x[i] * b->target[(size_t)k * row + i];
			b->weight[(size_t)f * (size_t)b->n_targets + (size_t)k] = (float)w;
			for (size_t i = 0; i < row; i++)
				x[i] -= (float)w * b->target[(size_t)k * row + i];
		}
		for (size_t i = 0; i < row; i += 3)
			b->worst = fmax(b->worst, sqrt((double)x[i] * x[i] + (double)x[i + 1] * x[i + 1] + (double)x[i + 2] * x[i + 2]));
	}
	for (int k = 0; k < b->n_targets; k++) {
		float most = 1e-9f;
		for (int f = 0; f < drive->n; f++)
			most = fmaxf(most, fabsf(b->weight[(size_t)f * (size_t)b->n_targets + (size_t)k]));
		for (int f = 0; f < drive->n; f++)
			b->weight[(size_t)f * (size_t)b->n_targets + (size_t)k] /= most;
		for (size_t i = 0; i < row; i++) {
			b->target[(size_t)k * row + i] *= most;
			b->lean[(size_t)k * row + i] *= most;
		}
		for (size_t i = 0; i < 3 * (size_t)b->n_hair; i++)
			b->hair_target[3 * (size_t)k * (size_t)b->n_hair + i] *= most;
	}
	free(x);
	free(n);
}

bool glb_bake_make(struct glb_bake *b, const struct rig *rig, const struct drive *drive, const struct glb_conf *conf, struct err *err)
{
	struct poser p = poser_new(rig, conf);
	struct learnt l;
	*b = (struct glb_bake){ .n_hair = p.n_hair };
	find_moving(b, rig);
	evaluate(&l, &p, b, drive);
	size_t row = 3 * (size_t)b->n, hair = 3 * (size_t)b->n_hair, most = (size_t)conf->targets;
	double *gram = mem_new((size_t)l.n * (size_t)l.n + 1, sizeof *gram), *value = mem_new((size_t)l.n + 1, sizeof *value);
	b->target = mem_new(most * row + 1, sizeof *b->target);
	b->lean = mem_new(most * row + 1, sizeof *b->lean);
	b->hair_target = mem_new(most * hair + 1, sizeof *b->hair_target);
	bool ok = decompose(gram, value, &l, row, err);
	float *left = mem_array((size_t)l.n * row + 1, sizeof *left);
	memcpy(left, l.x, (size_t)l.n * row * sizeof *left);
	double floor_value = ok ? 1e-10 * fmax(value[l.n - 1], 0) : 0, worst = INFINITY;
	while (ok && worst > conf->tolerance && b->n_targets < conf->targets && b->n_targets < l.n
	       && value[l.n - 1 - b->n_targets] > floor_value) {
		int k = b->n_targets++;
		component(b->target + (size_t)k * row, l.x, gram, value[l.n - 1 - k], &l, row, k);
		component(b->lean + (size_t)k * row, l.nrm, gram, value[l.n - 1 - k], &l, row, k);
		component(b->hair_target + (size_t)k * hair, l.hair, gram, value[l.n - 1 - k], &l, hair, k);
		worst = worst_of(left, &l, b);
	}
	free(left);
	free(gram);
	free(value);
	free(l.frame);
	free(l.x);
	free(l.nrm);
	free(l.hair);
	if (ok)
		weigh(b, &p, drive);
	if (ok && conf->poses)
		glb_take_poses(b, &p, conf);
	poser_free(&p);
	return ok;
}

void glb_bake_free(struct glb_bake *b)
{
	free(b->vertex);
	free(b->target);
	free(b->lean);
	free(b->weight);
	free(b->pose);
	free(b->pose_lean);
	free(b->hair_target);
	free(b->hair_pose);
	for (int k = 0; k < b->n_poses; k++)
		free(b->pose_name[k]);
	free(b->pose_name);
	free(b->driven);
	free(b->turn[0]);
	free(b->turn[1]);
	*b = (struct glb_bake){ 0 };
}
