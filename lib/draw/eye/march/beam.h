/* beam: lights as tables of their ways into the eye. */
#ifndef DRAW_EYE_MARCH_BEAM_H
#define DRAW_EYE_MARCH_BEAM_H
#include "draw/eye/lighting.h"
#include "draw/eye/scene.h"

/* One light in the eye's frame, or several neighbours (draw/eye/march/beam.c), with its own refraction function over the iris, on planes
 * at the depths z[0] and z[1]: direction towards it, irradiance of a plane that faces it, where on the cornea its light
 * came in (1: at the limbus), and what of the irradiance falls on the iris plane. */
enum { SCENE_PATH_STEPS = 4 };  // Newton's, from the closed-form start: 2e-5 mm at worst
enum { SCENE_WAY = 8 };  // six, and room for a whole vector
enum { SCENE_FLAT = 64 };  // texels of flat light, across
enum { SCENE_COARSE = 24 };  // several lights together are smooth: a coarser grid, and cubics (Catmull and Rom's) between
struct scene_beam {
	float dir[3], rgb[3];
	float z[2];
	float way[2][SCENE_GRID][SCENE_GRID][SCENE_WAY];
};

struct scene_beams {
	int n;
	struct scene_beam *beam;  // owned
};

/* The lights that reach the iris, for one view. free(beams.beam). */
struct scene_beams scene_beams(const struct scene *scene, const struct scene_lighting *light,
                               const double eye_from_cam[3][3]);

/* The way from points of the iris out to a camera at C, as if it were a light. free(). */
struct scene_beam *scene_sight(const struct scene *scene, const double C[3]);

#endif
