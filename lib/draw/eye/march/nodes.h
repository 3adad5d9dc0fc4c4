/* nodes: the quadrature of the march: where its nodes lie along a ray in each layer, and their weights. */
#ifndef DRAW_EYE_MARCH_NODES_H
#define DRAW_EYE_MARCH_NODES_H
#include "draw/eye/scene.h"

/* Sets the scene's nodes for its tissue, its mean thickness and conf.quadrature. One in SCENE_SHARE of conf.steps goes to the
 * anterior border layer. */
void scene_nodes_make(struct scene *scene);

/* Gauss's rule of n points on 0..1 for integrands near exp(-c x), which it integrates exactly.
 * n  at most SCENE_EXPONENTIAL_MAX; c: at most SCENE_FADE_MAX; node, weight: [n], out */
enum { SCENE_EXPONENTIAL_MAX = 12, SCENE_FADE_MAX = 40, SCENE_SHARE = 4 };
void scene_exponential(int n, double c, double node[], double weight[]);

/* Mean thickness of a layer (TISSUE_ABL, TISSUE_STROMA), mm. */
double scene_thickness(const struct scene *scene, int layer);

#endif
