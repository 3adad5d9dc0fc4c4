/* scene_paths: the light's ways into one eye, solved once a scene. The cornea is round: what a light's azimuth changes is only by
 * how much its field is turned about the axis. */
#ifndef EYE_SCENE_PATHS_H
#define EYE_SCENE_PATHS_H
#include "eye/scene_march.h"

/* free(); null: this scene's pictures are not quick ones. Needs geometry, maps' heights and tissue. */
struct scene_paths *scene_paths_make(const struct scene *scene);

/* One plane (0, 1) of a beam's table, SCENE_COARSE points each way, from its lights; in: shares that sum to one. */
void scene_paths_beam(float way[][SCENE_WAY], const struct scene *scene, int plane, const struct beam_lights *in);

#endif
