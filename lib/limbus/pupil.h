/* pupil: the margin of the pupil as the photograph shows it, through the cornea. */
#ifndef LIMBUS_PUPIL_H
#define LIMBUS_PUPIL_H
#include "limbus/evidence.h"
#include "limbus/rim.h"

struct pupil_conf {
	double min_contrast;  // Weber contrast of pupil and iris, linear light
	double min_coverage;  // share of the margin that must be seen
	double clear_coverage, clear_used;  // of a margin that needs no second witness: share seen; share good enough to measure
	double largest;       // of the limbus: a larger one is the limbus, or the collarette's shadow
};

/* Searches the limbus for an ellipse that is evenly dark inside and brighter outside, then measures it like the limbus (rim_fit).
 * pupil  out; undefined on failure
 * False when no pupil is seen: a dark iris in little light, a lid, a reflection. */
bool limbus_pupil(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid,
                  const struct ellipse *limbus, const struct rim_conf *rim_conf, const struct pupil_conf *conf);

/* The same where the evidence of the pixels (evidence_window) tells no other: where it does, or where no pupil was found, the margin is
 * measured near the evidence's ellipse. */
bool limbus_pupil_told(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *limbus,
                       const struct evidence *evidence, const struct rim_conf *rim_conf, const struct pupil_conf *conf);


/* Measures the margin where the other eye has one of `size` semi-axes of its limbus, known to so many of that; half of what tells a pupil
 * from none is enough then. */
bool limbus_pupil_like(struct rim *pupil, const struct photo *photo, const struct ellipse *limbus, double size, double sigma,
                       const struct rim_conf *rim_conf, const struct pupil_conf *conf);

#endif
