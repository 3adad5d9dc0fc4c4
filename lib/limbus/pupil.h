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
	double first[2];      // sizes that are tried first, of the limbus: least, most
	double first_contrast, first_score;  // contrast of a fully supported edge; score (propose/score.h) from which one is measured
	double least_window;  // px: steps of small pupils are blurred as much as those of large ones
	double told_sigma[2]; // of the evidence's ellipse: of the limbus's semi-axis, as its planes are coarse, and of its own
	double told_far;      // so many of these: not the same
	double told_sure;     // mean chance of pupil in an ellipse of the evidence that is believed
	double brightest;     // encoded brightness round a pupil over that of the iris farther out: beyond it a lamp is mirrored there
	double other_eye;     // of what is asked of a margin, where the other eye shows its pupil
};

/* Searches the limbus for an ellipse that is evenly dark inside and brighter outside, then measures it like the limbus (rim_fit).
 * pupil  out; undefined on failure
 * False when no pupil is seen: a dark iris in little light, a lid, a reflection. */
bool limbus_pupil(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid,
                  const struct ellipse *limbus, const struct rim_conf *rim_conf, const struct pupil_conf *conf);

/* The same where the evidence of the pixels (evidence_window) tells no other: where it does, or where no pupil was found, the margin is
 * measured near the evidence's ellipse. None that a mirrored lamp encloses: the hole of a ring light is as dark and as round as a pupil. */
bool limbus_pupil_told(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *limbus,
                       const struct evidence *evidence, const struct rim_conf *rim_conf, const struct pupil_conf *conf);


/* Measures the margin where the other eye has one of `size` semi-axes of its limbus, known to so many of that; half of what tells a pupil
 * from none is enough then. */
bool limbus_pupil_like(struct rim *pupil, const struct photo *photo, const struct ellipse *limbus, double size, double sigma,
                       const struct rim_conf *rim_conf, const struct pupil_conf *conf);

#endif
