/* haze: how far into the iris the sclera's light reaches over the blurred limbus of a photograph. Internal to unrefract.
 */
#ifndef IRIS_UNREFRACT_HAZE_H
#define IRIS_UNREFRACT_HAZE_H
#include "iris/unrefract/rings.h"
#include "iris/unrefract/unrefract.h"

/* Distance inwards from the limbus, mm, at which the sclera adds conf->haze of the iris' own light, in the colour of which it adds most.
 * The step of the photograph is a normal distribution of fit->edge_sigma_px, its place known to the ellipse's sigma: beyond d there is a share
 * Phi(-d / sigma) of the sclera's light. Where the iris grows brighter towards the limbus in every colour still farther in, it reaches to where it
 * begins to.
 * view   surveyed: colours, weights, the sclera's colour (white.sclera; where it was not found, the iris' own four times over) */
double unrefract_haze(const struct unrefract_view *view, const struct sheet *sheet, const struct unrefract_conf *conf);

#endif
