/* iris_light: how bright white would be on the iris: light in through the cornea and out again to the camera; and from where it comes. */
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
 * slant  new, or null; [n][n][IRIS_SLANT]: the strength E of the light at P, and its sums of E s_x, E s_y, E s_x^2, E s_x s_y, E s_y^2 over
 *      the lights, s the slant inside the eye: mm sideways towards the light for a mm of height, at most IRIS_SLANT_MOST; image_free.
 *      Sums, so that those of several photographs may be added
 * The same bits for any number of threads. */
enum { IRIS_SLANT = 6 };
#define IRIS_SLANT_MOST 3.0f
void iris_light_make(struct image *out, struct image *slant, int n, double extent, const struct iris_view *view);

/* Both as one map of IRIS_LIT channels of those names, as files hold it: R, G, B, mean cosine; means of s_x and s_y; covariance xx, xy, yy.
 * new; image_free */
enum { IRIS_LIT = 9 };
extern const char *const iris_lit_names[IRIS_LIT];
struct image iris_lit(const struct image *light, const struct image *slant);

#endif
