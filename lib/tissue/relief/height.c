#include "tissue/relief/height.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

double relief_heights(struct image *out, const struct image *thickness, double extent, const struct pupil *pupil, double root)
{
	int n = thickness->width;
	double(*rows)[3] = mem_new((size_t)n, sizeof *rows), sum[3] = { 0 };
	*out = image_new(n, n, 2);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			double t = image_at(thickness, x, y)[0];
			double share = iris_share(pupil, root, (2 * (x + 0.5) / n - 1) * extent, (2 * (y + 0.5) / n - 1) * extent);
			bool iris = share > 0 && share < 1;
			rows[y][0] += iris;
			rows[y][1] += iris ? t : 0;
			rows[y][2] += iris ? t * t : 0;
		}
	for (int y = 0; y < n; y++)  // in this order whatever the threads
		for (int k = 0; k < 3; k++)
			sum[k] += rows[y][k];
	double count = fmax(sum[0], 1), mean = sum[1] / count;
	for (long i = 0; i < (long)n * n; i++) {
		float t = thickness->px[i * thickness->channels];
		out->px[2 * i] = (float)(t - mean);
		out->px[2 * i + 1] = t;
	}
	free(rows);
	return sqrt(fmax(sum[2] / count - mean * mean, 0));
}
