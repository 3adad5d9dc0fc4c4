/* skin_track_impl: what the files of skin_track share. */
#ifndef TRACK_POINTS_SKIN_TRACK_IMPL_H
#define TRACK_POINTS_SKIN_TRACK_IMPL_H
#include "track/points/skin_track.h"

struct skin_warp {
	struct patch_warp warp, before;  // now, and in the frame before
	double best[2];        // warp.at steadied by the neighbours
	double ncc, usual;     // now; running mean while seen
	double sigma;          // px, of warp.at from the patch alone
	double confidence;
	double changed;        // mean change of brightness about it since it was measured
	int seen;              // measured in this frame, or as it was
};

/* What the neighbours say of a point. */
struct skin_field {
	struct patch_warp warp;
	double spread;         // px: how far they agree
	int n;                 // how many were asked; 0: no one knows
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

/* Brings all points to t->frame. follow.c */
void skin_track_follow(struct skin_track *t);

/* still.c */
/* Factor by which the frame before must be multiplied to be as bright as this one; 0 where their windows differ. */
double skin_track_gain(const struct skin_track *t);
/* Mean change of brightness about a place since the frame before, after t->gain; INFINITY where that is not known. */
double skin_track_changed(const struct skin_track *t, const double at[2]);
/* True when the frame differs from the last one worked on by less than conf.still: slow changes add up until they are seen. */
bool skin_track_stands_still(const struct skin_track *t);

/* Fills t->field from the points that are seen. field.c */
void skin_track_ask(struct skin_track *t);

#endif
