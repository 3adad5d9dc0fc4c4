/* melanin: a map of the border layer's melanin: the profile over the rings that pigment_solve found, and a smooth field about it.
 *
 * The field is a Gaussian process of covariance field^2 exp(-distance / reach) over square nodes. A node's observation are the two ratios
 * of its texels' mean colour under the forward model, thickness and all other unknowns as fitted; its luminance is not, which shadows and
 * thickness change as well. The errors are those that the iris' own fit was left with, taken as independent from node to node. Where
 * nothing was seen the profile remains, with the field's sigma.
 */
#ifndef TISSUE_PIGMENT_MELANIN_H
#define TISSUE_PIGMENT_MELANIN_H
#include "tissue/pigment/pigment.h"

struct melanin_conf {
	double field, reach, cell;  // rms of ln melanin; mm; pitch of the nodes, mm
};

enum { MELANIN_SIDE_MAX = 48 };
struct melanin_map {
	int n;                      // nodes across; 0: no map
	double extent;              // half-width, mm; rows from -y
	double ln[MELANIN_SIDE_MAX * MELANIN_SIDE_MAX];     // of melanin over that of the iris
	double sigma[MELANIN_SIDE_MAX * MELANIN_SIDE_MAX];  // given the iris' own
};

/* texture, conf, classes: as for the fit. Without a map where the fit found that one melanin explains the colours (varies = 0). Returns false, err set, when the covariance cannot be factorised. */
bool melanin_fit(struct melanin_map *out, const struct pigment_texture *texture, const struct pigment_fit *fit, const struct pigment_conf *conf,
                 const struct pigment_classes_conf *classes, const struct melanin_conf *map, struct err *err);

/* ln at a point, mm; bilinear, constant beyond the nodes. */
double melanin_at(const struct melanin_map *map, double x, double y);

#endif
