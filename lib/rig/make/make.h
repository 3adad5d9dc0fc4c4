/* rig_make: makes the rig of a character from the model of one person's skin and the character's registration on that person's mesh
 * (skin paper, sections 3.6 to 3.8).
 */
#ifndef RIG_MAKE_MAKE_H
#define RIG_MAKE_MAKE_H
#include "mesh/mesh.h"
#include "model/model.h"
#include "rig/rig.h"

/* The motion of skin and lids as linear functions of RIG_COMPONENTS numbers e, from a skin_model. px of the modelling camera. Owned. */
struct rig_motion {
	int n_inputs;
	double *W;                            // [RIG_COMPONENTS][n_inputs + 1]
	double rest_e[RIG_COMPONENTS], rest_aperture[4], baseline[4][3];
	struct known known;
	struct own_low own_low;
	double (*expression)[EXPRESS_LIDS], aperture_px[EXPRESS_LIDS];  // as a rig's
	int n;                                // tracked rows of the subject mesh
	int *vertex;
	double (*basis)[RIG_BASIS];
	double (*rest_px)[2];                 // their places at rest by the model
	int n_points;                         // control points of a lid
	double (*lid)[2];                     // [4 n_points] their places at rest; NAN: not learnt
	double (*lid_basis)[RIG_BASIS];       // [4 n_points]
	double lid_error_skin, lid_error;     // px rms: the lids' motion that the skin's components leave unexplained; that all leave
	struct skin_camera camera;
};

/* Takes the motion from a model of at least one component. The lids are regressed on the skin's components over the gazes, blinks and
 * action units that the model has seen; the principal components of the residual are the lids' own. rig_motion_free. */
void rig_motion_of_model(struct rig_motion *motion, const struct skin_model *model);
void rig_motion_free(struct rig_motion *motion);

/* A registered character. Lengths mm; everything is the caller's. */
struct rig_character {
	const struct mesh *mesh;              // in its own axes
	const float (*registered)[3];         // its vertices on the subject, in the subject's axes
	const int32_t *b_start, *b_column;    // B, compressed rows: rows of the mesh, columns vertices of the subject
	const double *b_weight;
	const float *confidence;              // of each row, 0..1; null: all 1
	double subject_from_target[4][4];     // similarity
	double eye_center[2][3], eye_radius;  // left, right, in the subject's axes; NAN where unknown
};

struct rig_conf {
	int neighbours;                       // tracked vertices that an extrapolated one follows
	double fade[2];                       // mm from tracked skin: all motion up to the first, none from the second
	double glue[2];                       // mm from the globe at rest: distance kept up to the first, free from the second
	double thickness, least;              // mm: t, the least distance of skin from the globe; the same of skin that rests on it
	double lid;                           // mm from the lid's margin over which skin follows its spline; 0: nowhere
	double lid_gap;                       // mm from a globe of 12 mm up to which skin is a lid
	double within[2], beyond[2];          // mm from the ends of what is seen of the eyeball, inner and outer: where margins leave their
	                                      // arcs, within; where the corners lie, beyond
	double breadth[2];                    // mm: of a lid's margin as the front sees it, and of half the hollow at a corner, at most; closed eyes
	                                      // show none of it
	double tarsus[2];                     // mm above the upper margin of an eye of 12 mm: what was not learnt of closing moves skin up to
	                                      // the first as far as the margin, from the second not at all
	double seal;                          // mm that closed lids overlap; < 0: lids are not sealed
	double lining;                        // mm of an eye of 12 mm that the lining goes on below lids whose mesh ends at their edges; 0: none
	double caruncle;                      // the same: width of caruncle and plica on what is seen of the eyeball; 0: none
	double min_confidence;                // of the registration, below which a vertex counts as untracked
	double map_step;                      // texel of the skull map, px of the modelling camera
	int globe_cells;                      // cells across the globe map
	double cornea_bulge;                  // apex over radius below which a globe gets a cornea; 0: never
};

/* Figures for the log. Counts are of vertices. */
struct rig_report {
	int tracked, lid, extrapolated, still, inside_at_rest;
	double off_chart;                     // median distance of tracked points at rest by the model from the projected mesh, px
	double deepest;                       // depth of a vertex inside a globe at rest, mm
	double open_before[2], open_after[2]; // gap of closed eyes, left and right, before and after sealing, mm
	bool cornea_added[2];
};

/* Makes the rig.
 * rig, report  overwritten; rig_free
 * Returns false, err set, when an eyeball is missing and not given, or no vertex of the character lies on tracked skin; the rig is
 * empty then. */
bool rig_make(struct rig *rig, struct rig_report *report, const struct rig_motion *motion, const struct rig_character *character,
              const struct rig_conf *conf, struct err *err);

#endif
