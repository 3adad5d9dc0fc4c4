/* iris_light: how bright white would be on the iris: light in through the cornea and out again to the camera. */
#ifndef TISSUE_LIGHT_IRIS_LIGHT_H
#define TISSUE_LIGHT_IRIS_LIGHT_H
#include "anatomy/eye.h"
#include "image/envmap/envmap.h"

/* One view of an eye under its light. */
struct iris_view {
	const struct envmap *env;      // in the camera's frame, of level 1 (envmap_normalise)
	const struct eye *eye;
	double cam_from_eye[4][4];
};

/* What a white Lambertian iris plane shows the camera, over what white shows that faces the camera outside the eye:
 *     E(P) T_out / n^2,   E(P) = sum over lights of gain(P, w) E_w
 * with the gain of lightpath_gain_batch (Fresnel, obliquity, focusing), T_out Fresnel's transmittance where the ray of sight leaves,
 * and n^-2 because a cone of light widens on its way out.
 * out  new, [n][n][4]: R, G, B, and the mean cosine of the light at P; square of half-width extent mm about the axis; 0 where no light
 *      or no ray of sight passes the cornea; image_free
 * The same bits for any number of threads. */
void iris_light_make(struct image *out, int n, double extent, const struct iris_view *view);

#endif
