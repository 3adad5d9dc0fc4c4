/* own_low: how much of the iris a person's lower lids cover, by the gaze: what a character's are held to (rig/deform/along.h). */
#ifndef MODEL_OWN_LOW_H
#define MODEL_OWN_LOW_H
struct skin_model;

enum { OWN_LOW_H = 5, OWN_LOW_V = 6 };

/* share [left, right][vertical][horizontal] of the limbus' disc that lies under the lower lid, 0..1; 1 where it is not known: that asks nothing of others. Gazes
 * are OWN_LOW_STEP degrees apart: horizontal about 0, vertical from 0 down. */
#define OWN_LOW_STEP_H 10.0
#define OWN_LOW_STEP_V 5.0
struct own_low {
	float share[2][OWN_LOW_V][OWN_LOW_H];
};

/* Of what a model has learnt, lids as open as they mostly are at that gaze; not known without eyes. */
struct own_low own_low_of(const struct skin_model *model);

/* At a gaze, degrees, which is taken into the range. */
double own_low_at(const struct own_low *low, int side, double h, double v);

#endif
