/* paths: the refracted paths of light into one eye, solved once a scene. The cornea is rotationally symmetric: a light's azimuth only
 * turns its field about the axis. */
#ifndef DRAW_EYE_MARCH_PATHS_H
#define DRAW_EYE_MARCH_PATHS_H
#include "draw/eye/march/march.h"

/* Needs the scene's geometry, range of heights and tissue. Returns null when conf asks for no quick pictures; free(). */
struct scene_paths *scene_paths_make(const struct scene *scene);

/* The one direction (way[0..2]; way[5]: its cosine with the axis) from which a beam's light makes tissue as bright as its several
 * lights do. power, dir, down: sums over the lights at a point of power, power times direction, power times direction times
 * cosine. A surface that light meets at the cosine m reflects R = m / (m + v) of it at the cosine v (Lommel-Seeliger); the mean
 * over lights of covariance C about their mean d is R at m - C_nn / (m + v), n the normal: linear in n about the axis, where
 * v = 1, it is a direction's. */
SIMD_INLINE void scene_beam_direction(float way[SCENE_WAY], float power, const float dir[3], const float down[3])
{
	float per = 1 / power, d[3], c[3];
	for (int k = 0; k < 3; k++)
		d[k] = per * dir[k];
	float m = -d[2] > 0.05f ? -d[2] : 0.05f, part = 1 / (m + 1);
	for (int k = 0; k < 3; k++)
		c[k] = per * down[k] + d[k] * d[2];  // covariance with the cosine
	for (int k = 0; k < 3; k++)
		way[k] = d[k] * (1 - part * c[2] / m) - 2 * part * c[k];
	way[5] = -d[2];
}

/* Fills one plane (0, 1) of a beam's table, SCENE_COARSE points each way. in: its lights, shares that sum to one. */
void scene_paths_beam(float way[][SCENE_WAY], const struct scene *scene, int plane, const struct beam_lights *in);

#endif
