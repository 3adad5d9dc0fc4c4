/* rig_make: from a model of one person's skin and a character registered on that person's mesh to a rig of the
 * character (skin paper, sections 3.6 to 3.8).
 */
#ifndef RIG_MAKE_MAKE_H
#define RIG_MAKE_MAKE_H
#include "mesh/mesh.h"
#include "model/model.h"
#include "rig/rig.h"

/* How the skin moves, from skin_model: everything folded to RIG_COMPONENTS numbers e. px of the modelling camera. */
struct rig_motion {
	int n_inputs;
	double *W;                            // [RIG_COMPONENTS][n_inputs + 1]
	double rest_e[RIG_COMPONENTS], rest_aperture[4], baseline[4][3];
	int n;                                // tracked rows of the subject mesh
	int *vertex;
	double (*basis)[RIG_BASIS];
	double (*rest_px)[2];                 // where the model has them at rest
	int n_points;                         // control points of a lid
	double (*lid)[2];                     // [4 n_points] where they are at rest; NAN: not learnt
	double (*lid_basis)[RIG_BASIS];
	double lid_error_skin, lid_error;     // px, rms: what the skin's part of e leaves of the lids; what all of it does
	struct skin_camera camera;
};

/* The lids are regressed on the skin's components over the gazes, blinks and action units the model has seen; what that
 * leaves of them are components of their own. model: at least one component. rig_motion_free. */
void rig_motion_of_model(struct rig_motion *motion, const struct skin_model *model);
void rig_motion_free(struct rig_motion *motion);

/* A character. Lengths mm. */
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
	int neighbours;                       // of an extrapolated vertex
	double fade[2];                       // mm from tracked skin: all motion up to the first, none from the second
	double glue[2];                       // mm from the globe at rest: kept up to the first, free from the second
	double thickness, least;              // mm: t of skin that rests further away; and at least
	double lid;                           // mm from the lid's margin over which skin follows its spline; 0: never
	double seal;                          // mm that closed lids overlap; < 0: they close as far as they were learnt to
	double min_confidence;
	double map_step;                      // px of the modelling camera
	int globe_cells;
	double cornea_bulge;                  // apex over radius below which a globe gets a cornea; 0: never
};

/* What was found, for the log. */
struct rig_report {
	int tracked, lid, extrapolated, still, inside_at_rest;
	double off_chart;                     // px, median: what the model has at rest against where the mesh is seen
	double deepest;                       // mm inside a globe at rest
	double open_before[2], open_after[2]; // mm left open of closed eyes, before and after they were sealed
	bool cornea_added[2];
};

bool rig_make(struct rig *rig, struct rig_report *report, const struct rig_motion *motion, const struct rig_character *character,
              const struct rig_conf *conf, struct err *err);

#endif
