/* find: detects the limbus and pupil ellipses of one photograph, or states why there are none. Needs no hint, no camera and no
 * size. Doubtful ellipses are rejected.
 */
#ifndef LIMBUS_FIND_H
#define LIMBUS_FIND_H
#include <math.h>

#include "limbus/propose/lean.h"
#include "limbus/pupil.h"
#include "limbus/odds_net.h"
#include "limbus/propose/seek.h"
#include "limbus/strip.h"

/* What both eyes of a face have in common (limbus/face/face.h). */
struct face_conf {
	double distance[2];   // between the limbi, of their semi-axis: least, most
	double roll;          // radians: of the line through both against the picture's rows, at most
	double size_sigma;    // of the logarithm of their sizes' ratio
	double score, sure;   // of a region: where the other eye is looked for; where it is there, found or not
	double pupil_sigma;   // of the logarithm of the pupils' ratio
};

struct limbus_conf {
	struct seek_conf seek;
	struct rim_conf rim;
	struct pupil_conf pupil;
	struct evidence_net *net;    // borrowed
	struct strip_net *strip;     // borrowed
	struct strip_conf strip_conf;
	struct odds_net *odds;       // borrowed
	struct face_conf face;
	double region_sigma, region_shape_sigma;  // of the evidence's ellipse: centre and size, shape; share of the semi-axis
	double strip_sigma;    // of the strip's ellipse, beside what its rays say; share of the semi-axis
	double region_hidden;  // how many times more where no sclera is beside it
	double tolerance;      // share of the semi-axis: an answer that is farther off is a gross error
	double max_gross;      // chance of that, beyond which a limbus is refused
	double sure_gross;     // chance of being off below which the votes of edges are not asked
	double max_rms;        // scatter of an edge that is believed by a hand's mark, share of the semi-axis
	double hint_sigma, drawn_sigma;  // of what a person says: share of the semi-axis
	double max_over, min_level;  // share of burnt pixels; encoded brightness of the 90 % quantile
};

/* How far two answers may be apart, semi-axes, that say the same: three of their sigmas, at least the tolerance and at most 0.05, or that. */
static inline double limbus_alike(double sigma, double tolerance)
{
	return fmax(tolerance, fmin(3 * sigma, 0.05));
}

/* How sure the choice is. */
struct posterior {
	int best, rival;        // trials, -1: none
	double gross;           // chance that the answer is off by more than the tolerance
	double beyond_right;    // the same of LIMBUS_RIGHT where the tolerance is wider; else 0
	double rival_chance;
	struct ellipse other;   // the rival's, where there is one
};

struct limbus_found {
	bool ok;
	bool by_hand;      // the search did not find it: it is where a person says
	char reason[256];
	struct rim limbus, pupil;
	bool has_pupil;
	struct band band;
	struct posterior posterior;
};

/* found  overwritten; owns no memory; found->ok false with found->reason when no limbus is accepted
 * hint   x, y, radius px, or null; with one an ellipse near it is always accepted (hand.h), but in a photograph too small to hold an iris */
void limbus_find(struct limbus_found *found, const struct photo *photo, const double *hint,
                 const struct limbus_conf *conf);

/* Refuses a photograph too small to hold an iris; true where it is. */
bool limbus_too_small(struct limbus_found *found, const struct photo *photo);

struct trials;

/* The same on trials that hold none yet (trial.h); they hold what was tried afterwards. */
void limbus_find_in(struct limbus_found *found, struct trials *trials, const double *hint);

/* Measures the likeliest of the trials, as found->posterior has it, in full; refuses what is doubtful. */
void limbus_settle(struct limbus_found *found, struct trials *trials);

/* The limbus as a person has drawn it, moved to the edge where there is one close by. */
void limbus_find_drawn(struct limbus_found *found, const struct photo *photo, const struct ellipse *drawn, const struct limbus_conf *conf);

#endif
