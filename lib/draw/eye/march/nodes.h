/* nodes: the quadrature of the march: where its steps lie along a ray and what they weigh. */
#ifndef DRAW_EYE_MARCH_NODES_H
#define DRAW_EYE_MARCH_NODES_H
#include "draw/eye/scene.h"

/* Where the march's steps lie and what they weigh, for this tissue and thickness. */
void scene_nodes_make(struct scene *scene);

/* Gauss's rule of n points, at most SCENE_EXPONENTIAL_MAX, on 0..1 for what fades as exp(-c x), c at most SCENE_FADE_MAX; one
 * in SCENE_SHARE of the steps goes to the anterior layer. */
enum { SCENE_EXPONENTIAL_MAX = 12, SCENE_FADE_MAX = 40, SCENE_SHARE = 4 };
void scene_exponential(int n, double c, double node[], double weight[]);

/* Mean thickness of a layer, mm. */
double scene_thickness(const struct scene *scene, int layer);

#endif
