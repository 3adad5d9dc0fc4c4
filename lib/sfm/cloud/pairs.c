#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "sfm/cloud/cloud.h"

/* The shared points, each weighted by the angle between its two rays: 1 at the best angle, falling to both sides (cf. the view selection
 * of Goesele et al. 2007, section 3.1). */
static double *scores(const struct colmap_model *m, double best_angle)
{
	int n = m->n_images;
	double *score = mem_new((size_t)n * (size_t)n, sizeof *score), (*center)[3] = mem_array((size_t)n, sizeof *center);
	for (int i = 0; i < n; i++)
		colmap_center(center[i], &m->images[i]);
	for (int p = 0; p < m->n_points; p++) {
		const struct colmap_point *point = &m->points[p];
		for (int k = 0; k < point->n_track; k++)
			for (int l = 0; l < k; l++) {
				int i = point->track[k].image, j = point->track[l].image;
				double u[3], v[3];
				vec_add(u, center[i], -1, point->xyz);
				vec_add(v, center[j], -1, point->xyz);
				double c = vec_dot(u, v) / (vec_norm(u) * vec_norm(v)), angle = acos(fmax(-1, fmin(1, c)));
				double off = (angle - best_angle) / (angle < best_angle ? 0.5 * best_angle : best_angle);
				double near = vec_norm(u) / vec_norm(v), scale = fmin(near, 1 / near);
				double w = exp(-0.5 * off * off) * scale * scale;
				score[i * n + j] += i == j ? 0 : w;
				score[j * n + i] += i == j ? 0 : w;
			}
	}
	free(center);
	return score;
}

static int by_ends(const void *a, const void *b)
{
	const struct cloud_pair *p = a, *q = b;
	return p->a != q->a ? p->a - q->a : p->b - q->b;
}

struct cloud_pair *cloud_pairs(int *n, const struct colmap_model *m, const bool *is_new, const struct cloud_conf *conf)
{
	int N = m->n_images;
	double *score = scores(m, conf->best_angle);
	struct cloud_pair *pairs = mem_new((size_t)N * (size_t)conf->neighbours, sizeof *pairs);
	*n = 0;
	for (int i = 0; i < N; i++) {
		if (is_new && !is_new[i])
			continue;
		bool *taken = mem_new((size_t)N, 1);
		for (int k = 0; k < conf->neighbours; k++) {
			int best = -1;
			for (int j = 0; j < N; j++)
				if (!taken[j] && score[i * N + j] > 0 && (best < 0 || score[i * N + j] > score[i * N + best]))
					best = j;
			if (best < 0)
				break;
			taken[best] = true;
			pairs[(*n)++] = (struct cloud_pair){ i < best ? i : best, i < best ? best : i, score[i * N + best] };
		}
		free(taken);
	}
	qsort(pairs, (size_t)*n, sizeof *pairs, by_ends);
	int kept = 0;
	for (int i = 0; i < *n; i++)
		if (!i || by_ends(&pairs[i], &pairs[i - 1]))
			pairs[kept++] = pairs[i];
	*n = kept;
	free(score);
	return pairs;
}
