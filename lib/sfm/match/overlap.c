#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/match/match.h"

struct ranked {
	float scale;
	int index;
};

static int by_scale(const void *a, const void *b)
{
	const struct ranked *p = a, *q = b;
	return p->scale != q->scale ? (p->scale < q->scale) - (p->scale > q->scale) : p->index - q->index;
}

/* The features of the largest scale: these are seen from near and far and under blur, so that few of them suffice. */
static struct sfm_features strongest(const struct sfm_features *f, int most)
{
	struct ranked *order = mem_array((size_t)f->n, sizeof *order);
	for (int i = 0; i < f->n; i++)
		order[i] = (struct ranked){ f->scale[i], i };
	qsort(order, (size_t)f->n, sizeof *order, by_scale);
	struct sfm_features out = { .n = f->n < most ? f->n : most };
	out.descriptors = mem_array((size_t)out.n, SIFT_DIM);
	for (int i = 0; i < out.n; i++)
		memcpy(out.descriptors[i], f->descriptors[order[i].index], SIFT_DIM);
	free(order);
	return out;
}

static int by_number(const void *a, const void *b)
{
	int x = *(const int *)a, y = *(const int *)b;
	return (x < y) - (x > y);
}

/* The score of a picture's `always`-th best pair. */
static int bar_of(const int *scores, int n, int always)
{
	int *sorted = mem_array((size_t)n, sizeof *sorted);
	memcpy(sorted, scores, (size_t)n * sizeof *sorted);
	qsort(sorted, (size_t)n, sizeof *sorted, by_number);
	int bar = always > 0 && always <= n ? sorted[always - 1] : always > n ? 0 : INT_MAX;
	free(sorted);
	return bar > 0 ? bar : 1;  // nothing in common is nothing in common
}

static int *score_all(int n, const struct sfm_features f[], int first_new, const struct sfm_overlap_conf *conf)
{
	struct sfm_features *few = mem_array((size_t)n, sizeof *few);
	int *scores = mem_new((size_t)n * (size_t)n, sizeof *scores);
	for (int i = 0; i < n; i++)
		few[i] = strongest(&f[i], conf->strongest);
#pragma omp parallel for schedule(dynamic)
	for (int b = n - 1; b >= first_new; b--)
		for (int a = 0; a < b; a++) {
			struct sfm_matches m;
			sfm_match(&m, &few[a], &few[b], &conf->match);
			scores[a * n + b] = scores[b * n + a] = m.n;
			free(m.index);
		}
	for (int i = 0; i < n; i++)
		sfm_features_free(&few[i]);
	free(few);
	return scores;
}

struct sfm_pair *sfm_overlap(int *n, int n_pictures, const struct sfm_features f[], int first_new,
                             const struct sfm_overlap_conf *conf)
{
	int *scores = score_all(n_pictures, f, first_new, conf), *bars = mem_array((size_t)n_pictures, sizeof *bars);
	bool all = n_pictures <= conf->always + 1;
	struct sfm_pair *pairs = 0;
	*n = 0;
	for (int i = 0; i < n_pictures; i++)
		// A picture that is not new has its pairs already.
		bars[i] = i < first_new ? INT_MAX : bar_of(scores + (long)i * n_pictures, n_pictures, conf->always);
	for (int a = 0; a < n_pictures; a++)
		for (int b = a + 1 > first_new ? a + 1 : first_new; b < n_pictures; b++) {
			int s = scores[a * n_pictures + b];
			if (!all && s < conf->min_matches && s < bars[a] && s < bars[b] && b - a > conf->neighbours)
				continue;
			if (!(*n & (*n - 1)))
				pairs = mem_grow(pairs, *n ? 2 * (size_t)*n : 1, sizeof *pairs);
			pairs[(*n)++] = (struct sfm_pair){ a, b, s };
		}
	free(scores);
	free(bars);
	return pairs;
}

bool sfm_is_sequence(int n_pictures, const struct sfm_pair pairs[], int n_pairs)
{
	// A picture follows the one before when no more than two others are closer to it.
	int follows = 0;
	for (int i = 1; i < n_pictures; i++) {
		int before = -1, closer = 0;
		for (int k = 0; k < n_pairs; k++)
			if (pairs[k].a == i - 1 && pairs[k].b == i)
				before = pairs[k].score;
		for (int k = 0; k < n_pairs; k++)
			closer += (pairs[k].a == i || pairs[k].b == i) && pairs[k].score > before;
		follows += before > 0 && closer <= 2;
	}
	return n_pictures > 3 && follows >= 0.8 * (n_pictures - 1);
}
