/* trial: ellipses that may be the limbus, each measured and weighed. Internal to limbus_find.
 */
#ifndef LIMBUS_TRIAL_H
#define LIMBUS_TRIAL_H
#include "limbus/odds_net.h"
#include "limbus/propose/seek.h"
#include "limbus/find.h"
#include "limbus/strip_net.h"

enum { TRIALS = 32, TRIAL_WINDOWS = 8 };

/* What tells sclera from lid beside an arc, and which ellipse is a prior: the evidence's, none, the strip's, against which edges count, or hardly
 * do where they are soft. */
enum trial_guide { GUIDE_EVIDENCE, GUIDE_WHITENESS, GUIDE_WHITENESS_ALONE, GUIDE_STRIP, GUIDE_STRIP_FIRST };

struct trial_window {
	struct evidence evidence;
	struct region_map map;
	struct grey sclera;        // chance of sclera, as a rim's tint
	struct strip *strip;       // round its likeliest ellipse; owned; null: not read, or the limbus is not seen
	struct grey seen;          // strip_seen
	struct ellipse_prior told; // the likeliest ellipse of the strip
	double moved, blind;       // how far the last reading moved it, and one without the evidence would, px
	double x, y, radius;       // px of the photograph
};

/* Where an ellipse was seen: points on it beside some of the arcs that were used, px. */
enum { TRIAL_PLACES = 60 };
struct trial_line { int n; double p[TRIAL_PLACES][2]; };

struct trial {
	enum trial_guide guide;
	const struct trial_window *window;
	struct ellipse region;     // the evidence's, where it is a prior
	struct ellipse e;
	struct trial_line line;
	double sigma;              // the largest of centre and semi-axes, semi-axes
	double x[ODDS_TRAITS], curve[ODDS_CURVE];
	double log_odds;           // to within limbus.tolerance
};

struct trials {
	const struct photo *photo;
	const struct pyramid *pyramid;
	const struct limbus_conf *conf;
	int n, n_windows, n_regions;
	struct evidence_region region[EVIDENCE_REGIONS];  // of trials_of_evidence
	struct trial trial[TRIALS];
	struct trial_window window[TRIAL_WINDOWS];
};

struct trials *trials_new(const struct photo *photo, const struct pyramid *pyramid, const struct limbus_conf *conf);
void trials_free(struct trials *trials);

/* Adds what the network finds; what is smaller or larger where it finds most, as a collarette may be taken for the limbus; what the votes of
 * edges find. True: err is not set. */
bool trials_of_evidence(struct trials *trials, struct err *err);
bool trials_of_scales(struct trials *trials, struct err *err);
bool trials_of_votes(struct trials *trials, struct err *err);
/* Adds the ellipse of the evidence near a circle, measured with either guide. */
bool trials_of_place(struct trials *trials, double x, double y, double radius, struct err *err);
/* Adds the ellipses near a hint: x, y, radius, px. */
bool trials_of_hint(struct trials *trials, const double *hint, struct err *err);

struct trial_line trial_line_of(const struct rim *rim);

/* Measures a trial's limbus and, where they are asked for, its pupil and whether it has one. coarse: to tell trials apart. False when there is no
 * edge. */
bool trial_measure(struct rim *rim, struct rim *pupil, bool *has_pupil, const struct trial *trial, const struct trials *trials, bool coarse);

#endif
