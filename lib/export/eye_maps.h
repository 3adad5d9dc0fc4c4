/* eye_maps: the textures of an eye that leaves for other programs. All are square, [px][px], rows downwards as glTF's v.
 * Planar maps (iris, cornea) show x and y of the eye's frame, half-widths as in eye_mesh.h; the sclera's is azimuthal equidistant. */
#ifndef EXPORT_EYE_MAPS_H
#define EXPORT_EYE_MAPS_H
#include "draw/eye/scene.h"

enum export_map {
	EXPORT_IRIS_ALBEDO,       // linear Rec. 709: without light and cornea (draw/eye/albedo.h), the pupil's ruff in it
	EXPORT_IRIS_NORMAL,       // unit, of the whole relief, in tangent space, which is the part's own (eye_mesh.h)
	EXPORT_IRIS_HEIGHT,       // mm over the iris plane
	EXPORT_IRIS_THICKNESS,    // of the stroma, mm
	EXPORT_IRIS_FRECKLES,     // 0..1
	EXPORT_SCLERA_ALBEDO,     // linear; vessels, the darker rim and the tint of light below the surface in it
	EXPORT_SCLERA_NORMAL,     // ripples of the tear film
	EXPORT_SCLERA_VESSELS,    // 0..1: share of green light that vessels take
	EXPORT_SCLERA_ROUGHNESS,  // of the tear film, glTF's (its square is GGX's alpha)
	EXPORT_CORNEA_COLOUR,     // linear; white where it is clear, the sclera's colour where it is not, and between them what makes both together as bright as they are
	EXPORT_CORNEA_CLEAR,      // share of light that goes through, 0..1
	EXPORT_CORNEA_DEPTH,      // length of a refracted ray along the axis from here to the iris plane, mm
	EXPORT_CORNEA_ROUGHNESS,
	EXPORT_MAPS
};

/* Names of the files, without ending; channels. */
extern const char *const export_map_names[EXPORT_MAPS];
extern const int export_map_channels[EXPORT_MAPS];

/* maps    [EXPORT_MAPS], overwritten; image_free each. The iris' are as large as the power of two that holds the scene's texels, the
 *         sclera's that holds its map; the cornea's half of that, roughness and ripples a quarter.
 * most    the largest, px
 * freckles  opacity on the iris maps' extent, any size; null: none
 * lit     light that the albedo's mean is between even light and (albedo.h)
 * Call after scene_fit_colour. Returns false, err set, where resampling fails. */
bool export_eye_maps(struct image maps[EXPORT_MAPS], const struct scene *scene, const struct image *freckles, const struct envmap *lit, int most,
                     struct err *err);

#endif
