/* scene_paths: the light's ways into one eye, solved once a scene. The cornea is round: what a light's azimuth changes is only by
 * how much its field is turned about the axis. */
#ifndef DRAW_EYE_MARCH_PATHS_H
#define DRAW_EYE_MARCH_PATHS_H
#include "draw/eye/march/march.h"

/* free(); null: this scene's pictures are not quick ones. Needs geometry, maps' heights and tissue. */
struct scene_paths *scene_paths_make(const struct scene *scene);

/* The one direction (way[0..2]; way[5]: how far it goes down) in which a beam's light makes tissue as bright as its lights do,
 * from what they bring to a point: power, that times direction, times direction and how far it goes down. A surface that light
 * meets at the cosine m sends back R = m / (m + v) of it at the cosine v; the mean over lights of covariance C about their mean d
 * is R at m - C_nn / (m + v), n the normal: linear in n about the axis, where v is 1, that is a direction's. */
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

/* One plane (0, 1) of a beam's table, SCENE_COARSE points each way, from its lights; in: shares that sum to one. */
void scene_paths_beam(float way[][SCENE_WAY], const struct scene *scene, int plane, const struct beam_lights *in);

#endif
