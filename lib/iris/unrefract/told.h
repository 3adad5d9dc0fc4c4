/* told: what the evidence of a photograph (limbus/evidence.h) says of each texel of a survey. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_TOLD_H
#define IRIS_UNREFRACT_TOLD_H
#include "iris/unrefract/unrefract.h"
#include "limbus/occlusion.h"

/* Probabilities, [size][size] each; null: nothing is told. */
struct told {
	float *cover;   // lid, skin, lash, and sclera where the ellipse reaches too far
	float *lid;     // the same but for sclera
	float *mirror;  // a reflection
	float *pupil;
};

/* Samples the evidence where the map's texels are seen. What it tells is dropped where it does not take the ring inside of the limbus
 * for an iris at all: it errs then, or the ellipse does. told_free.
 * seen      [size][size], 1 where the photograph shows the texel
 * evidence  null: nothing is told
 * occlusion where it is not null, reflections and pupil are taken from it, lids from whichever is surer */
struct told told_new(const struct evidence *evidence, const struct occlusion *occlusion, const struct iris_map *map, const float *seen, double limbus);
void told_free(struct told *told);

/* What is seen, times how likely it is iris or pupil and no reflection. [n]; free(). */
float *told_iris(const struct told *told, const float *seen, size_t n);

#endif
