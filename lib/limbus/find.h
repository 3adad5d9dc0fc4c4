/* find: detects the limbus and pupil ellipses of one photograph, or states why there are none. Needs no hint, no camera and no
 * size. Doubtful ellipses are rejected.
 */
#ifndef LIMBUS_FIND_H
#define LIMBUS_FIND_H
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
	double region_alike;  // logarithm of the sizes' ratio of two regions that may be one face's eyes, at most
	double off_alike;     // chance that two ellipses, of which one at least is off, are off for one reason, lids or a collarette, and about as large
	double off_sigma;     // how many times size_sigma those differ
	double broad;         // of the logarithm of the others' ratio
	double unlike;        // chance that two right ones are as unlike as any
	double far;           // sigmas, beyond which sizes, or pupils, contradict each other
};

/* Which ellipses are tried, and how roughly (trial.h). */
struct trial_conf {
	int regions, votes, rounds;    // of the evidence; of the edges' votes; of these, round which a larger one is looked for
	int reads;                     // of a strip, each round the ellipse of the one before
	int passes;                    // of a rough measure
	double limbus_px, pupil_px;    // larger semi-axes are reduced to that for it
	double window_place, window_size;  // of the radius, and of the logarithm of its ratio: a window serves an ellipse that near
	double window_again;           // of either, from which the evidence's ellipse is looked for anew in a window of its own
	double least_region;           // size of the evidence's ellipse, of the radius looked for, below which it is none
	double start_alike;            // of the radius and the logarithms of the sizes' ratios: a start that is that near one that was tried is left out
	double other_scale[2];         // of the first region's radius: other sizes that are looked for
	double prior_arcs, strip_arcs; // so many arcs of a rim count as one against what the evidence, or a strip, tells of its ellipse
};

/* When two ellipses say the same (posterior.h). */
struct same_conf {
	double sigmas, most;  // so many sigmas apart, at most so many semi-axes
	double unseen;        // semi-axes: and no farther, however little of either is seen
	double other_eye;     // semi-axes between centres: no rival, but another eye
	double moved;         // chance of being off where the full measurement left its trial
};

/* What is believed beside a hand's mark (hand.h). */
struct hand_conf {
	double close;  // of the radius, and of the logarithms of the sizes' ratios: how far an edge may be
	double seen;   // share of the ring that it shows
};

struct limbus_conf {
	struct seek_conf seek;
	struct rim_conf rim;
	struct pupil_conf pupil;
	struct evidence_net *net;    // borrowed
	struct strip_net *strip;     // borrowed
	struct strip_conf strip_conf;
	struct odds_net *odds;       // borrowed
	struct occlusion_net *occlusion;  // borrowed
	struct face_conf face;
	struct trial_conf trial;
	struct same_conf same;
	struct hand_conf hand;
	double region_sigma, region_shape_sigma;  // of the evidence's ellipse: centre and size, shape; share of the semi-axis
	double strip_sigma;    // of the strip's ellipse, beside what its rays say; share of the semi-axis
	double region_hidden;  // how many times more where no sclera is beside it
	double tolerance;      // share of the semi-axis: an answer that is farther off is a gross error
	double rough_tolerance; // the widest to which a refused ellipse may be known
	double max_gross;      // chance of that, beyond which a limbus is refused
	double rough_gross;    // chance of being farther off than it is known to, beyond which it is not known roughly either
	double sure_gross;     // chance of being off below which the votes of edges are not asked
	double max_rms;        // scatter of an edge that is believed by a hand's mark, share of the semi-axis
	double hint_sigma, drawn_sigma;  // of what a person says: share of the semi-axis
	double max_over, min_level;  // share of burnt pixels; encoded brightness of the 90 % quantile
};

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
	double rough;      // refused, but known to this share of the semi-axis, at most conf->rough_tolerance; 0: to none
	char reason[256];
	struct rim limbus, pupil;
	bool has_pupil;
	struct band band;
	double reach[2];   // opening.h
	struct posterior posterior;
};

/* found  overwritten; owns no memory; found->ok false with found->reason when no limbus is accepted
 * hint   x, y, radius px, or null; with one an ellipse near it is always accepted (hand.h), but in a photograph too small to hold an iris */
void limbus_find(struct limbus_found *found, const struct photo *photo, const double *hint,
                 const struct limbus_conf *conf);

/* Whether there is an ellipse to go on with, refused as it may be. */
static inline bool limbus_usable(const struct limbus_found *found)
{
	return found->ok || found->rough > 0;
}

/* Refuses a photograph too small to hold an iris; true where it is. */
bool limbus_too_small(struct limbus_found *found, const struct photo *photo);

struct trials;

/* The same on trials that hold none yet (trial.h), without a pupil; they hold what was tried afterwards. */
void limbus_find_in(struct limbus_found *found, struct trials *trials, const double *hint);

/* The pupil of an eye that is usable, and where between its lids it lies. trials: those among which it was found, or none where a person says where it is. */
void limbus_find_pupil(struct limbus_found *found, const struct trials *trials);

/* Measures the likeliest of the trials, as found->posterior has it, in full; refuses what is doubtful. */
void limbus_settle(struct limbus_found *found, struct trials *trials);

/* The limbus as a person has drawn it, moved to the edge where there is one close by. */
void limbus_find_drawn(struct limbus_found *found, const struct photo *photo, const struct ellipse *drawn, const struct limbus_conf *conf);

#endif
