/* find: detects the limbus and pupil ellipses of one photograph, or states why there are none. Needs no hint, no camera and no
 * size. Doubtful ellipses are rejected.
 */
#ifndef LIMBUS_FIND_H
#define LIMBUS_FIND_H
#include "limbus/propose/lean.h"
#include "limbus/pupil.h"
#include "limbus/propose/seek.h"

struct limbus_conf {
	struct seek_conf seek;
	struct rim_conf rim;
	struct pupil_conf pupil;
	double min_coverage;   // share of the limbus that must be seen
	double min_contrast;   // Weber contrast of sclera and iris, linear light
	double max_blur;       // width of the step, share of the semi-axis
	double max_rms;        // scatter of the edge, share of the semi-axis
	double max_sigma;      // of centre and semi-axes, share of the semi-axis
	double max_flank_rms, max_flank_sigma, min_flank_coverage;  // the same for eyes found by the sides of the limbus
	double hint_sigma, drawn_sigma;  // of what a person says: share of the semi-axis
	double max_over, min_level;  // share of burnt pixels; encoded brightness of the 90 % quantile
};

struct limbus_found {
	bool ok;
	bool by_hand;      // the search did not find it: it is where a person says
	char reason[256];
	struct rim limbus, pupil;
	bool has_pupil;
	struct band band;
	double score;      // of the search, 0..1
};

/* found  overwritten; owns no memory; found->ok false with found->reason when no limbus is accepted
 * hint   x, y, radius px, or null; with one an ellipse near it is always accepted (hand.h), but in a photograph too small to hold an iris */
void limbus_find(struct limbus_found *found, const struct photo *photo, const double *hint,
                 const struct limbus_conf *conf);

/* The limbus as a person has drawn it, moved to the edge where there is one close by. */
void limbus_find_drawn(struct limbus_found *found, const struct photo *photo, const struct ellipse *drawn, const struct limbus_conf *conf);

#endif
