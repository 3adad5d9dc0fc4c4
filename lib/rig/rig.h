/* rig: a character that can be driven by gaze, apertures and action units (skin paper, sections 3.6 to 3.8). rig_make makes one
 * (rig/make/make.h), deform_pose evaluates it (rig/deform/deform.h).
 *
 * Frame    the target's: the character's own axes, mm. px are those of the modelling camera, in which skin moves: u = mean + U~ e.
 * Inputs   g~ (the order of model/model.h; apertures normalised to 0 closed .. 1 open). e = W [g~; 1], RIG_COMPONENTS numbers.
 * At rest  (e = rest_e) every vertex is exactly where the character's mesh has it, unless that is inside a globe.
 */
#ifndef RIG_RIG_H
#define RIG_RIG_H
#include <stdint.h>

#include "base/err.h"
#include "model/express.h"
#include "model/known.h"
#include "model/own_low.h"
#include "rig/globe_map.h"
#include "rig/skull_map.h"

/* Numbers of components: the paper's of the skin; further ones of the lids' motion that those do not explain
 * (rig/make/motion_lids.c); coordinates of U~ a vertex. */
enum { RIG_SKIN_COMPONENTS = 4, RIG_LID_COMPONENTS = 4, RIG_COMPONENTS = RIG_SKIN_COMPONENTS + RIG_LID_COMPONENTS,
	   RIG_BASIS = 2 * RIG_COMPONENTS };

/* What a vertex belongs to. RIG_NEAR_EYE: separate pieces beside an eyeball (lashes, tear film), which follow the skin. RIG_LINING: what the
 * character's mesh has not (rig/make/lining.c): a lining of its lids, caruncles and plicae; its vertices and faces are the last. */
enum rig_part { RIG_SKIN, RIG_GLOBE_LEFT, RIG_GLOBE_RIGHT, RIG_NEAR_EYE, RIG_LINING, RIG_PARTS };

static inline bool rig_is_globe(uint8_t part)
{
	return part == RIG_GLOBE_LEFT || part == RIG_GLOBE_RIGHT;
}

/* Where a vertex's motion comes from: barycentrically from tracked points (eq. 3.4), or from its neighbours (eq. 3.5). */
enum rig_source { RIG_TRACKED, RIG_EXTRAPOLATED };

struct rig_globe {
	double center[3];        // in the target's frame, mm
	double radius;           // of the sphere that fits it best, mm
	bool own;                // from the character's own mesh; else a sphere with a cornea
	struct globe_map map;    // D, in the head's axes about the centre
};

/* The modelling camera: px = project(from_target [x; 1]). */
struct rig_camera {
	double from_target[3][4];
	double focal_px[2], center_px[2];
	int width, height;
};

/* B+ (eq. 3.5), a sparse matrix of vertices by vertices: the identity for those that are not extrapolated; rows sum to 1. Row i has
 * the entries start[i] .. start[i + 1] - 1. */
struct rig_weights {
	int32_t *start, *column;
	float *weight;
};

/* Arrays are by vertex unless their shape says otherwise, and owned; rig_free. */
struct rig {
	int n, n_faces, n_inputs;
	int32_t (*faces)[3];
	double *W;                       // [RIG_COMPONENTS][n_inputs + 1]
	double rest_e[RIG_COMPONENTS];
	double head_from_target[3][3];   // rotation: x to the person's left, y up, z out of the face
	double rest_aperture[4];         // g~ of g4, g5, g9, g10 at rest
	double baseline[4][3];           // A: g~[4,5,9,10] = A [horizontal, vertical, 1] (deg), eq. 3.11
	struct known known;              // gazes at which lids are known
	double (*expression)[EXPRESS_LIDS];  // [n_inputs - 10] what each expression in full does to lids (model/express.h), controls g~
	double aperture_px[EXPRESS_LIDS];    // of each aperture from 0 to 1
	struct own_low own_low;              // how high the person's own lower lids stand
	float (*rest)[3], (*normal)[3];  // the character's mesh, mm; unit normals
	float (*home)[2];                // where the modelling camera sees the vertices at rest, px
	float (*basis)[RIG_BASIS];       // U~, px: x, then y
	float *fade;                     // factor of an extrapolated vertex's motion, falling with the distance from tracked skin, 0..1
	struct rig_weights bplus;
	float *thickness;                // t: least distance from the globe, mm
	float *gap;                      // delta0 + t: distance from the globe at rest, mm
	float *glue;                     // 0..1: share to which a vertex keeps that distance as the globe turns
	uint8_t *part, *source, *side;   // enum rig_part; enum rig_source; the nearer globe, 0 left, 1 right
	struct skull_map skull;
	struct rig_globe globe[2];       // left, right
	struct rig_camera camera;
};

void rig_free(struct rig *rig);

/* How many of its vertices and faces are the character's own: those before the lining. */
int rig_own_vertices(const struct rig *rig);
int rig_own_faces(const struct rig *rig);

/* e = W [g~; 1], out. inputs[n_inputs]: g~; beyond the known gazes lids are as at the nearest (known_hold). */
void rig_components(double e[RIG_COMPONENTS], const struct rig *rig, const double *inputs);

/* Rotation of a globe, from its own axes (the head's at rest) to the target's, for a gaze in Fick's order: horizontal, vertical,
 * torsion, radians. */
void rig_globe_rotation(double target_from_globe[3][3], const struct rig *rig, const double gaze[3]);

/* The rotations of both globes, left and right, for controls g~[n_inputs] (gaze in degrees). */
void rig_globes_turned(double target_from_globe[2][3][3], const struct rig *rig, const double *controls);

/* Signed distance |r| - D of a point from a globe that is turned so, mm; below 0 inside. side: 0 left, 1 right; x: in the target's
 * frame. */
double rig_globe_distance(const struct rig *rig, int side, const double target_from_globe[3][3], const float x[3]);

/* Write and read rig.npz. made_by: JSON text or null. rig_load overwrites rig, rig_free. Both return false, err set; load also when an
 * array has another type or shape, or an index points nowhere, and the rig is empty then. */
bool rig_save(const struct rig *rig, const char *path, const char *made_by, struct err *err);
bool rig_load(struct rig *rig, const char *path, struct err *err);

/* Radii of the left and the right globe alone, mm, without reading the rest. Returns false, err set, as rig_load. */
bool rig_sockets(double radius[2], const char *path, struct err *err);

#endif
