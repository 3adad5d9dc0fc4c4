/* pupil: the margin of the pupil as the photograph shows it, through the cornea. */
#ifndef LIMBUS_PUPIL_H
#define LIMBUS_PUPIL_H
#include "limbus/evidence.h"
#include "limbus/occlusion.h"
#include "limbus/rim.h"

struct pupil_conf {
	double min_contrast;  // Weber contrast of pupil and iris, linear light
	double min_coverage;  // share of the margin that must be seen
	double clear_coverage, clear_used;  // of a margin that needs no second witness: share seen; share good enough to measure
	double largest;       // of the limbus: a larger one is the limbus, or the collarette's shadow
	double first[2];      // sizes that are tried first, of the limbus: least, most
	double first_contrast, first_score;  // contrast of a fully supported edge; score (propose/score.h) from which one is measured
	double least_window;  // px: steps of small pupils are blurred as much as those of large ones
	double told_sigma[2]; // of the networks' ellipse: of the limbus's semi-axis, as its cells are coarse, and of its own
	double told_sure;     // mean chance of pupil in an ellipse of the iris' own network that is believed
	double told_within;   // of the limbus's semi-axis: an edge that near the iris' own network's ellipse is the pupil's
	double told_apart;    // the same of the pixels' evidence, where the search for an edge finds none there
	double told_used;     // share of such an edge that is good enough to measure
	double brightest;     // encoded brightness round a pupil over that of the iris farther out: beyond it a lamp is mirrored there
	double other_eye;     // of what is asked of a margin, where the other eye shows its pupil
	double other_far;     // so many sigmas from the other eye's: not the same
};

/* Searches the limbus for an ellipse that is evenly dark inside and brighter outside, then measures it like the limbus (rim_fit).
 * pupil  out; undefined on failure
 * False when no pupil is seen: a dark iris in little light, a lid, a reflection. */
bool limbus_pupil(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid,
                  const struct ellipse *limbus, const struct rim_conf *rim_conf, const struct pupil_conf *conf);

/* The margin of what both networks take for the pupil: the edge that limbus_pupil finds where it lies on the ellipse of the iris' own network, or else the one near that
 * ellipse, where the pixels' evidence has it there as well. None where that network sees no pupil, and none that a mirrored lamp encloses: the hole of a ring light is
 * as dark and as round as a pupil.
 * evidence  of a window round the limbus; occlusion: of it */
bool limbus_pupil_told(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *limbus, const struct evidence *evidence,
                       const struct occlusion *occlusion, const struct rim_conf *rim_conf, const struct pupil_conf *conf);

/* Measures the margin where the other eye has one of `size` semi-axes of its limbus, known to so many of that; half of what tells a pupil
 * from none is enough then. */
bool limbus_pupil_like(struct rim *pupil, const struct photo *photo, const struct ellipse *limbus, double size, double sigma,
                       const struct rim_conf *rim_conf, const struct pupil_conf *conf);

#endif
