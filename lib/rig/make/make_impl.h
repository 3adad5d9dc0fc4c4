/* rig_make_impl: the steps of rig_make. */
#ifndef RIG_MAKE_MAKE_IMPL_H
#define RIG_MAKE_MAKE_IMPL_H
#include "rig/make/make.h"

/* What follows is rig_make's own. e = W [c; 1]. rest: controls of the reference frame. motion.c, motion_lids.c */
void rig_motion_components(double e[RIG_COMPONENTS], const struct rig_motion *motion, const double *controls);
void rig_motion_take_lids(struct rig_motion *motion, const struct skin_model *model, const double *rest);

/* Where the modelling camera sees a point of the subject; cam: the point in its frame. chart.c */
void rig_project(double px[2], double cam[3], const struct skin_camera *camera, const float x[3]);
void rig_take_homes(struct rig *rig, const struct rig_motion *motion, const struct rig_character *character);
/* The skull map, from what that camera sees of the character at rest. */
bool rig_take_skull(struct rig *rig, const struct rig_motion *motion, const struct rig_character *character, double step,
                    struct err *err);

/* Where the character's eyeballs are to be expected, by what registration did to the skin round them. globe.c */
void rig_expect_globes(double center[2][3], double *radius, const struct rig *rig, const struct rig_character *character);

/* Skin at the lid margins moves as the margins' splines do. lids.c */
void rig_follow_lids(struct rig *rig, const struct rig_motion *motion, double px_per_mm, double reach_mm, struct rig_report *report);

/* The linear form of the components from rest that is 1 with eyes closed straight ahead (closed), and of all such nearest to
 * 1 with eyes closed and to 0 with eyes open, wherever they look, and in the expressions: what seals the lids by it leaves a
 * gaze downwards, which takes the lids halfway, as it was learnt. */
void rig_closing_direction(double out[RIG_COMPONENTS], const struct rig *rig, const double closed[RIG_COMPONENTS]);

/* Upper lids come down as far as it takes to close an eye that is told to close. */
void rig_seal_lids(struct rig *rig, const struct rig_motion *motion, double px_per_mm, double seal_mm, struct rig_report *report);

/* The eyeballs of a mesh: closed, round components about the expected centres; marks part[], fills globe[]. centre, radius:
 * where they are expected, in the mesh's axes, NAN where unknown. globe.c */
bool rig_find_globes(struct rig *rig, const double center[2][3], double radius, const struct rig_conf *conf,
                     struct rig_report *report, struct err *err);

/* B+ and fade of every vertex whose source is RIG_EXTRAPOLATED, distances measured along the character's skin. spread.c */
void rig_spread(struct rig *rig, const struct rig_conf *conf);

#endif
