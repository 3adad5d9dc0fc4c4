/* beam: lights of the environment as tables of their refracted paths into the eye. */
#ifndef DRAW_EYE_MARCH_BEAM_H
#define DRAW_EYE_MARCH_BEAM_H
#include "draw/eye/lighting.h"
#include "draw/eye/scene.h"

enum { SCENE_PATH_STEPS = 4 };  // Newton's, from the closed-form start: 2e-5 mm at worst
enum { SCENE_WAY = 8 };         // channels of a table: six, padded to a whole vector
enum { SCENE_FLAT = 64 };       // texels across the light of a flat iris (paths_flat.h)
enum { SCENE_BESIDE = 64 };      // texels across the map of light from beside (beside.h)
enum { SCENE_COARSE = 24 };     // nodes across the table of several lights, before cubic (Catmull-Rom) interpolation to SCENE_GRID

/* One light, or several neighbouring ones (beam.c), with its refraction function tabulated on two planes across the iris. */
struct scene_beam {
	float dir[3], rgb[3];       // mean direction towards its lights outside of the eye, in the eye's frame; their sum, as in struct envmap_light
	float z[2];                 // depths of the planes, mm
	float way[2][SCENE_GRID][SCENE_GRID][SCENE_WAY];  // 0..2: direction towards the light inside the eye (unit for one light, see scene_beam_direction for several); 3: irradiance of a
	                            // plane that faces it, as a share of rgb; 4: where it entered the cornea, 1 at the limbus;
	                            // 5: cosine of incidence on the iris plane
};

struct scene_beams {
	int n;
	float mean[3], own;         // mean direction of all lights, by luminance; how much it is the photograph's own (own_light.h)
	struct scene_beam *beam;    // owned
	float *beside;              // [SCENE_BESIDE][SCENE_BESIDE][4]: what light that spreads in the tissue changes (beside.h); owned; null: nothing
};

/* The beams of a lighting for one view. scene_beams_free, which accepts empty ones. */
struct scene_beams scene_beams(const struct scene *scene, const struct scene_lighting *light,
                               const double eye_from_cam[3][3]);
void scene_beams_free(struct scene_beams *beams);

/* The paths from points of the iris out to a camera at C (eye's frame, mm), tabulated like those of a light. free(). */
struct scene_beam *scene_sight(const struct scene *scene, const double C[3]);

#endif
