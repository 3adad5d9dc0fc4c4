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
	double max_over, min_level;  // share of burnt pixels; encoded brightness of the 90 % quantile
};

struct limbus_found {
	bool ok;
	char reason[256];
	struct rim limbus, pupil;
	bool has_pupil;
	struct band band;
	double score;      // of the search, 0..1
};

/* found  overwritten; owns no memory; found->ok false with found->reason when no limbus is accepted
 * hint   x, y, radius px, or null */
void limbus_find(struct limbus_found *found, const struct photo *photo, const double *hint,
                 const struct limbus_conf *conf);

#endif
