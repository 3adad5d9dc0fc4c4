/* pupil: the margin of the pupil as the photograph shows it, through the cornea. */
#ifndef LIMBUS_PUPIL_H
#define LIMBUS_PUPIL_H
#include "limbus/rim.h"

struct pupil_conf {
	double min_contrast;  // Weber contrast of pupil and iris, linear light
	double min_coverage;  // share of the margin that must be seen
};

/* Searches the limbus for an ellipse that is evenly dark inside and brighter outside, then measures it like the limbus (rim_fit).
 * pupil  out; undefined on failure
 * False when no pupil is seen: a dark iris in little light, a lid, a reflection. */
bool limbus_pupil(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid,
                  const struct ellipse *limbus, const struct rim_conf *rim_conf, const struct pupil_conf *conf);

#endif
