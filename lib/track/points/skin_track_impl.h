/* skin_track_impl: what the files of skin_track share. */
#ifndef TRACK_POINTS_SKIN_TRACK_IMPL_H
#define TRACK_POINTS_SKIN_TRACK_IMPL_H
#include "track/points/skin_track.h"

struct skin_warp {
	struct patch_warp warp, before;  // now, and in the frame before
	double best[2];        // best estimate of the place
	double ncc, usual;     // now; running mean while seen
	double sigma;          // px, of warp.at from the patch alone
	double confidence;
	double changed;        // sum of mean changes of brightness about it since it was measured
	int seen;              // measured in this frame, or unchanged
};

/* Prediction of a point's warp from its neighbours. */
struct skin_field {
	struct patch_warp warp;
	double spread;         // px: rms disagreement of the neighbours
	int n;                 // neighbours seen; 0: no prediction
};

struct skin_track {
	struct skin_track_conf conf;
	int width, height;
	struct skin_points points;
	struct patch_set *patches;
	struct scales frame, last;
	bool has_last, was_still;
	double gain;           // of the frame against the last; 0: they cannot be compared
	struct skin_warp *point;
	struct skin_field *field;
};

/* Measures all points in t->frame. follow.c */
void skin_track_follow(struct skin_track *t);

/* still.c */
/* Factor by which the frame before must be multiplied to be as bright as this one; 0 where their windows differ. */
double skin_track_gain(const struct skin_track *t);
/* Mean change of brightness about a place since the frame before, after t->gain; INFINITY where that is not known. */
double skin_track_changed(const struct skin_track *t, const double at[2]);
/* True when the frame differs from the last one worked on by less than conf.still: slow changes add up until they are seen. */
bool skin_track_stands_still(const struct skin_track *t);

/* Predicts every point from its neighbours that are seen, into t->field. field.c */
void skin_track_ask(struct skin_track *t);

#endif
