/* rig_make_impl: the steps of rig_make, by file. Those that return false have set err. */
#ifndef RIG_MAKE_MAKE_IMPL_H
#define RIG_MAKE_MAKE_IMPL_H
#include "rig/make/make.h"

/* components.c: e = W [c; 1], out; controls[n_inputs]. */
void rig_motion_components(double e[RIG_COMPONENTS], const struct rig_motion *motion, const double *controls);
/* motion_lids.c: the lids' part of a motion, and the components of their own. rest: controls [n_inputs] of the reference frame. */
void rig_motion_take_lids(struct rig_motion *motion, const struct skin_model *model, const double *rest);

/* chart.c: projects a point x of the subject into the modelling camera. px: out; cam: out, the point in the camera's frame, mm. */
void rig_project(double px[2], double cam[3], const struct skin_camera *camera, const float x[3]);
/* Where the modelling camera sees the registered vertices: home. */
void rig_take_homes(struct rig *rig, const struct rig_motion *motion, const struct rig_character *character);
/* The skull map, from the vertices that the camera sees at rest. step: texel, px; smooth: over which it is a mean, px. */
bool rig_take_skull(struct rig *rig, const struct rig_motion *motion, const struct rig_character *character, double step,
                    double smooth, struct err *err);

/* globe.c: expects the character's eyeballs where the registration moves the subject's, by the skin around them. center (left, right)
 * and radius: out, in the target's frame, mm. Centres are NAN where the subject's are unknown; its radius is then 12 mm. */
void rig_expect_globes(double center[2][3], double *radius, const struct rig *rig, const struct rig_character *character);

/* fissure.c: the modelling camera's view of one eye in a pose. */
struct rig_fissure {
	int x0, y0, width, height;  // of the window, px
	uint8_t *cover;             // [height][width] 1: skin before the globe
	float (*at)[2];             // of every vertex, px
	float *top, *bottom;        // of the open part of a column, px; where none is, both the middle of the nearest column's that has one
};
/* A window round the learnt lids at rest and rim px beyond them (x, y; below 0: within). False: the lids were not learnt. rig_fissure_free. */
bool rig_fissure_new(struct rig_fissure *f, const struct rig *rig, const struct rig_motion *motion, int side, const double rim[2]);
/* Renders the pose de (components from rest): cover, at, top, bottom. */
void rig_fissure_look(struct rig_fissure *f, const struct rig *rig, int side, const double de[RIG_COMPONENTS]);
void rig_fissure_free(struct rig_fissure *f);

/* margins.c: makes the character's own lid margins move as smooth arcs between corners that both lids share: each component moves a
 * margin by a share of the opening at rest, so that arcs stay arcs at every gaze. In closed poses they meet along their whole length
 * and conf->seal more, their outer edges too, by up to conf->breadth; conf->seal below 0: as was learnt. Fades over conf->lid; what closed
 * poses lacked, above the upper margin, over conf->tarsus. Over that, too, lids keep their distance from the eyeball: the least that glue will be. conf->lid = 0: nothing is done. */
void rig_arc_margins(struct rig *rig, const struct rig_motion *motion, double px_per_mm, const struct rig_conf *conf);

/* lids.c: makes skin at the lid margins move as the margins' splines do, fading over reach_mm. */
void rig_follow_lids(struct rig *rig, const struct rig_motion *motion, double px_per_mm, double reach_mm, struct rig_report *report);

/* lining.c: adds what the mesh has not: a lining where it ends at its lids' edges, caruncles and plicae. Last: the rig is whole before. */
void rig_line_lids(struct rig *rig, const struct rig_conf *conf);

/* closing.c: a linear form that measures how far an eye is closed: out . (e - rest_e). side: 0 left, 1 right. It is 1 in the pose `closed`
 * (components from rest, both eyes closed straight ahead) and, in the least-squares sense, 1 with that eye closed and 0 with it open,
 * whatever the other does, for all gazes and expressions. Sealing the lids in proportion to it leaves a gaze downwards, in which lids
 * close halfway, as it was learnt, and a wink to the eye that winks. */
void rig_closing_direction(double out[RIG_COMPONENTS], const struct rig *rig, int side, const double closed[RIG_COMPONENTS]);
/* The pose itself, straight ahead with both eyes closed: components from rest. */
void rig_closed_pose(double closed[RIG_COMPONENTS], const struct rig *rig);

/* lids.c: lowers the upper lids in closed poses until no gap is left, and by seal_mm more. */
void rig_seal_lids(struct rig *rig, const struct rig_motion *motion, double px_per_mm, double seal_mm, struct rig_report *report);

/* unfold.c: keeps skin off the margins from turning over as eyes close, beside their corners, in expressions, too: it moves, in proportion to how far they are closed, by what leaves each
 * face a quarter of its breadth as the front sees it (widen.c). The skull is there. */
void rig_unfold_lids(struct rig *rig, const struct rig_motion *motion, double px_per_mm);

/* globe.c: finds the eyeballs: closed, round connected pieces about the expected centres (of rig_expect_globes); marks part[], fills
 * globe[]. Where none is found, a sphere with a cornea takes the expected place; an error where that is NAN. */
bool rig_find_globes(struct rig *rig, const double center[2][3], double radius, const struct rig_conf *conf,
                     struct rig_report *report, struct err *err);

/* spread.c: B+ and fade of every vertex whose source is RIG_EXTRAPOLATED, by distances along the character's skin. */
void rig_spread(struct rig *rig, const struct rig_conf *conf);

#endif
