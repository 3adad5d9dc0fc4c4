#include "rig/glb/bake.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/glb/poser.h"

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

/* Displacements of one pose: of skin, of its normals, of hairs. */
struct posed {
	float *x, *lean, *hair;
};

static struct posed posed_new(const struct glb_bake *b)
{
	return (struct posed){ mem_array(3 * (size_t)b->n + 1, sizeof(float)), mem_array(3 * (size_t)b->n + 1, sizeof(float)), mem_array(3 * (size_t)b->n_hair + 1, sizeof(float)) };
}

static void posed_take(struct posed *to, const struct poser *p, const struct glb_bake *b)
{
	poser_skin(to->x, to->lean, p, b->n, b->vertex);
	poser_hair(to->hair, p);
}

static void posed_free(struct posed *p)
{
	free(p->x);
	free(p->lean);
	free(p->hair);
}

/* Share of an eye in what moves at x: 1 on its side of the face, 0 on the other. */
static float own_side(const struct rig *rig, int eye, const float x[3])
{
	static const double blend_mm = 10;  // to either side of the nose's bridge
	double from_middle = 0;
	for (int c = 0; c < 3; c++)
		from_middle += rig->head_from_target[0][c] * (x[c] - 0.5 * (rig->globe[0].center[c] + rig->globe[1].center[c]));
	const double t = fmin(fmax(0.5 + (eye ? -0.5 : 0.5) * from_middle / blend_mm, 0), 1);
	return (float)(t * t * (3 - 2 * t));
}

/* A named pose as a target that others may be added to: what it differs by from a look straight ahead, `ahead`; and where the eye shuts, on
 * its side, what that look differs by from rest, too. So what all poses have in common with each other against the mesh (its lids' linings lie in
 * its eyeballs) is in none of them, or it would be there as often as there are targets. */
static void pose_target(float *out, const float *now, const float *ahead, const float *still, int n, const struct rig *rig, const int *vertex, const float (*at)[3],
                        int shuts)
{
	for (int i = 0; i < n; i++) {
		const float share = shuts < 0 ? 0 : own_side(rig, shuts, vertex ? rig->rest[vertex[i]] : at[i]);
		for (int c = 3 * i; c < 3 * i + 3; c++)
			out[c] = now[c] - ahead[c] + share * (ahead[c] - still[c]);
	}
}

static void take_poses(struct glb_bake *b, struct poser *p)
{
	static const double look[GLB_POSES][2] = { { 0, 0 }, { 0, 0 }, { 0, 20 }, { 0, 20 }, { 0, -20 }, { 0, -20 },
		                                       { -25, 0 }, { 25, 0 }, { 25, 0 }, { -25, 0 }, { 0, 0 }, { 0, 0 } };
	const size_t row = 3 * (size_t)b->n, hair = 3 * (size_t)b->n_hair;
	double *straight = mem_new((size_t)p->rig->n_inputs + 1, sizeof *straight), *c = mem_new((size_t)p->rig->n_inputs + 1, sizeof *c);
	double *one = mem_new((size_t)p->rig->n_inputs + 1, sizeof *one), turn[2][3][3];
	struct posed still = posed_new(b), ahead = posed_new(b), now = posed_new(b);
	b->pose = mem_new(GLB_POSES * row + 1, sizeof *b->pose);
	b->pose_lean = mem_new(GLB_POSES * row + 1, sizeof *b->pose_lean);
	b->hair_pose = mem_new(GLB_POSES * hair + 1, sizeof *b->hair_pose);
	drive_look(straight, p->rig, 0, 0, 1);
	poser_still(p);
	posed_take(&still, p, b);
	poser_pose(p, straight, turn);
	posed_take(&ahead, p, b);
	for (int k = 0; k < GLB_POSES; k++) {
		const int eye = k % 2, shuts = k < 2 ? eye : -1;
		drive_look(one, p->rig, look[k][0], look[k][1], k < 2 ? 0 : k >= 10 ? 1.3 : 1);
		memcpy(c, straight, (size_t)p->rig->n_inputs * sizeof *c);
		memcpy(c + 5 * eye, one + 5 * eye, 5 * sizeof *c);
		poser_pose(p, c, turn);
		posed_take(&now, p, b);
		pose_target(b->pose + (size_t)k * row, now.x, ahead.x, still.x, b->n, p->rig, b->vertex, 0, shuts);
		pose_target(b->pose_lean + (size_t)k * row, now.lean, ahead.lean, still.lean, b->n, p->rig, b->vertex, 0, shuts);
		pose_target(b->hair_pose + (size_t)k * hair, now.hair, ahead.hair, still.hair, b->n_hair, p->rig, 0, (const float(*)[3])p->hair_rest, shuts);
	}
	posed_free(&still);
	posed_free(&ahead);
	posed_free(&now);
	free(straight);
	free(one);
	free(c);
}

bool glb_bake_make(struct glb_bake *b, const struct rig *rig, const struct drive *drive, const struct glb_conf *conf, struct err *err)
{
	struct poser p = poser_new(rig, conf->hairs);
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
		take_poses(b, &p);
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
	free(b->turn[0]);
	free(b->turn[1]);
	*b = (struct glb_bake){ 0 };
}
