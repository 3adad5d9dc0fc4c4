/* loss: what a program that draws triangles shows of an exported eye, against what the renderer shows of the fitted one. */
#ifndef EXPORT_LOSS_H
#define EXPORT_LOSS_H
#include "draw/eye/render.h"
#include "export/eye_maps.h"

/* One view, eye turned to the side by `deg`. */
struct export_loss {
	double deg;
	double mm_mean, mm_most;     // on the iris plane, between the point that a pixel shows and the one it ought to; inside the limbus
	double de_mean, de_95;       // CIEDE2000 where iris shows; exposure of the beauty views
	double de_eye;               // mean over all of the eye
};

/* The rasteriser is three.js's: for each pixel the ray is bent at the cornea once, followed by the length that the depth map says, and the
 * point there is drawn as the camera sees it through no cornea; light is the environment's irradiance on the normal map, without shadows;
 * mirrored is the environment times Fresnel's reflectance.
 * drawn   the renderer's picture of the same view and light, [height][width][4]
 * gain    exposure */
struct export_loss export_loss_of(const struct scene *scene, const struct image maps[EXPORT_MAPS], const struct scene_view *view,
                                  const struct envmap *env, const struct image *drawn, double gain);

#endif
