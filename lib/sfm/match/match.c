#include "sfm/match/match.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { BLOCK = 256 };
static const float unit2 = 512.0f * 512.0f;  // inner product of a descriptor with itself

void sfm_features_free(struct sfm_features *f)
{
	free(f->descriptors);
	free(f->scale);
	*f = (struct sfm_features){ 0 };
}

/* The two largest inner products of a feature, and the index of the largest. */
struct nearest {
	float best, second;
	int index;
};

static float *widen(const struct sfm_features *f)
{
	const uint8_t *bytes = (const uint8_t *)f->descriptors;
	float *out = mem_array((size_t)f->n * SIFT_DIM, sizeof *out);
	for (long i = 0; i < (long)f->n * SIFT_DIM; i++)
		out[i] = bytes[i];
	return out;
}

static void scan_row(struct nearest *out, const float *s, int m)
{
	float best = -1, second = -1;
	for (int j = 0; j < m; j++)
		best = s[j] > best ? s[j] : best;
	int at = 0;
	while (at < m - 1 && s[at] < best)
		at++;
	for (int j = 0; j < at; j++)
		second = s[j] > second ? s[j] : second;
	for (int j = at + 1; j < m; j++)
		second = s[j] > second ? s[j] : second;
	*out = (struct nearest){ best, second, at };
}

/* Updates each column's best and second best by one row; three arrays, so that the loop vectorises. */
static void scan_columns(float *restrict best, float *restrict second, int *restrict index, const float *restrict s, int m,
                         int row)
{
	for (int j = 0; j < m; j++) {
		float v = s[j], b = best[j], low = v < b ? v : b;
		bool better = v > b;
		second[j] = low > second[j] ? low : second[j];
		best[j] = better ? v : b;
		index[j] = better ? row : index[j];
	}
}

static bool accepted(float best, float second, const struct sfm_match_conf *conf)
{
	double near = acos(fmin(1, (double)best / (double)unit2)), next = acos(fmin(1, fmax(0, (double)second / (double)unit2)));
	return near <= conf->max_distance && near < conf->max_ratio * next;
}

void sfm_match(struct sfm_matches *out, const struct sfm_features *a, const struct sfm_features *b,
               const struct sfm_match_conf *conf)
{
	*out = (struct sfm_matches){ 0 };
	if (!a->n || !b->n)
		return;
	float *A = widen(a), *B = widen(b), *S = mem_array((size_t)BLOCK * (size_t)b->n, sizeof *S);
	struct nearest *rows = mem_array((size_t)a->n, sizeof *rows);
	float *best = mem_array((size_t)b->n, sizeof *best), *second = mem_array((size_t)b->n, sizeof *second);
	int *index = mem_new((size_t)b->n, sizeof *index);
	for (int j = 0; j < b->n; j++)
		best[j] = second[j] = -1;
	for (int i0 = 0; i0 < a->n; i0 += BLOCK) {
		int n = a->n - i0 < BLOCK ? a->n - i0 : BLOCK;
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n, b->n, SIFT_DIM, 1, A + (long)i0 * SIFT_DIM, SIFT_DIM, B,
		            SIFT_DIM, 0, S, b->n);
		for (int i = 0; i < n; i++) {
			scan_row(&rows[i0 + i], S + (long)i * b->n, b->n);
			scan_columns(best, second, index, S + (long)i * b->n, b->n, i0 + i);
		}
	}
	out->index = mem_array((size_t)a->n, sizeof *out->index);
	for (int i = 0; i < a->n; i++) {
		int j = rows[i].index;
		if (index[j] == i && accepted(rows[i].best, rows[i].second, conf) && accepted(best[j], second[j], conf)) {
			out->index[out->n][0] = (uint32_t)i;
			out->index[out->n++][1] = (uint32_t)j;
		}
	}
	free(A);
	free(B);
	free(S);
	free(rows);
	free(best);
	free(second);
	free(index);
}
