#include "iris/unrefract/told.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

struct told told_new(const struct evidence *evidence, const struct occlusion *occlusion, const struct iris_map *map, const float *seen, double limbus)
{
	const double least = 0.3;  // mean probability of an iris in the ring: eyes are above 0.5, what is none below 0.1
	struct told told = { 0 };
	if (!evidence)
		return told;
	size_t n = (size_t)map->size * (size_t)map->size;
	float **plane[] = { &told.cover, &told.lid, &told.mirror, &told.pupil };
	for (int k = 0; k < COUNT(plane); k++)
		*plane[k] = mem_new(n, sizeof(float));
	double eye = 0;
	long ring = 0;
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < n; i++) {
		if (!(seen[i] > 0))
			continue;
		double x = map->u[i], y = map->v[i];
		const float lid = evidence_at(evidence, EVIDENCE_SKIN, x, y) + evidence_at(evidence, EVIDENCE_LASH, x, y), all = lid + evidence_at(evidence, EVIDENCE_SCLERA, x, y);
		told.cover[i] = occlusion ? fmaxf(occlusion_at(occlusion, OCCLUSION_LID, x, y), all) : all;  // what either takes for a lid may be dark with its shadow
		told.lid[i] = all > 0 ? told.cover[i] * lid / all : 0;
		told.mirror[i] = occlusion ? occlusion_at(occlusion, OCCLUSION_MIRROR, x, y) : evidence_at(evidence, EVIDENCE_REFLECTION, x, y);
		told.pupil[i] = occlusion ? occlusion_at(occlusion, OCCLUSION_PUPIL, x, y) : evidence_at(evidence, EVIDENCE_PUPIL, x, y);
	}
	for (size_t i = 0; i < n; i++)
		if (seen[i] > 0 && map->rim[i] > 0.4 * limbus && map->rim[i] < 0.9 * limbus) {
			eye += 1 - told.cover[i];
			ring++;
		}
	if (!(eye > least * (double)ring))
		told_free(&told);
	return told;
}

void told_free(struct told *told)
{
	free(told->cover);
	free(told->lid);
	free(told->mirror);
	free(told->pupil);
	*told = (struct told){ 0 };
}

float *told_iris(const struct told *told, const float *seen, size_t n)
{
	float *out = mem_array(n, sizeof *out);
	for (size_t i = 0; i < n; i++)
		out[i] = told->cover ? seen[i] * fmaxf(1 - told->cover[i] - told->mirror[i], 0) : seen[i];
	return out;
}
