/* iris: textures of rendered captures, unrefracted with the true limbus, and the renderer's truth about them. The numbers are those
 * of config/, read from there: run from the top of the checkout.
 */
#ifndef TESTS_IRIS_H
#define TESTS_IRIS_H
#include "iris/freckle/freckle.h"
#include "iris/unrefract/unrefract.h"
#include "tests/lib/truth/truth.h"

/* As config/unrefract.conf and config/freckles.conf have them. quality: "review". */
struct unrefract_conf iris_unrefract_conf(const char *quality);
struct balance_conf iris_balance_conf(void);
struct freckle_conf iris_freckle_conf(const char *quality);

/* The texture as the stage makes it. fit, view: filled, the caller's; unrefract_view_free; image_free(&texture.rgbw). */
bool iris_texture(struct unrefract_texture *texture, struct unrefract_view *view, struct fit *fit,
                  const struct truth *truth, const struct unrefract_conf *conf, struct err *err);

/* The painted iris without cornea as a map of its own: linear RGB, weight 1 between pupil and iris_r; half-width
 * *extent. size: texels a side. False where the capture has none. */
bool iris_painted(struct image *rgbw, double *extent, const struct truth *truth, const char *dir, int size);

/* 1 where the renderer painted a freckle of at least half its own opacity; on a map of that size in the product's eye frame (lib/README.md)
 * (turned: as textures are) or the renderer's own. free(); null where the capture has no mask. */
uint8_t *iris_freckle_mask(const struct truth *truth, const char *dir, int size, double extent, bool turned);

/* Intersection over union of the found (opacity >= 0.5) and the painted, where the texture has weight. NAN where neither
 * has any. */
double iris_freckle_overlap(const struct freckles *found, const uint8_t *painted, const struct image *rgbw);

#endif
