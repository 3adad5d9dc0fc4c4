/* skin_track_impl: what the files of skin_track share. */
#ifndef TRACK_POINTS_TRACK_IMPL_H
#define TRACK_POINTS_TRACK_IMPL_H
#include "track/points/track.h"

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

/* Mean change of brightness about a place since the frame before; INFINITY where that is not known. track.c */
double skin_track_changed(const struct skin_track *t, const double at[2]);

/* Fills t->field from the points that are seen. field.c */
void skin_track_ask(struct skin_track *t);

#endif
