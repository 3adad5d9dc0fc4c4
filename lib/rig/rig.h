/* rig: a character ready to be driven: what `extrapolate` makes and `render` evaluates (skin paper, sections 3.6 to 3.8).
 *
 * Frame    the character's own axes, mm. "px" are those of the modelling camera, in which skin moves: u = mean + U~ e.
 * Inputs   g~ (model.h's order; apertures normalised to 0 closed .. 1 open). e = W [g~; 1], RIG_COMPONENTS numbers.
 * At rest  (e = rest_e) every vertex stands exactly where the character's mesh has it, unless that is inside a globe.
 */
#ifndef RIG_RIG_H
#define RIG_RIG_H
#include <stdint.h>

#include "base/err.h"
#include "rig/globe_map.h"
#include "rig/skull_map.h"

/* Of the skin, as the paper has them; then of what the lids do beyond those (rig/make/motion_lids.c). */
enum { RIG_SKIN_COMPONENTS = 4, RIG_LID_COMPONENTS = 4, RIG_COMPONENTS = RIG_SKIN_COMPONENTS + RIG_LID_COMPONENTS,
	   RIG_BASIS = 2 * RIG_COMPONENTS };

/* What a vertex belongs to. Near an eye: pieces of their own there (lashes, tear film): they follow the skin. */
enum rig_part { RIG_SKIN, RIG_GLOBE_LEFT, RIG_GLOBE_RIGHT, RIG_NEAR_EYE, RIG_PARTS };

static inline bool rig_is_globe(uint8_t part)
{
	return part == RIG_GLOBE_LEFT || part == RIG_GLOBE_RIGHT;
}

/* How the rig came to know how a vertex moves: barycentrically from tracked points (eq. 3.4), or from its
 * neighbours (eq. 3.5). */
enum rig_source { RIG_TRACKED, RIG_EXTRAPOLATED };

struct rig_globe {
	double center[3];        // mm
	double radius;           // mm, of the sphere that fits it best
	bool own;                // the character's own mesh; else a sphere with a cornea
	struct globe_map map;    // D; its frame is head_from_target's, about the centre
};

/* The view of the input video: px = project(camera_from_target x). */
struct rig_camera {
	double from_target[3][4];
	double focal_px[2], center_px[2];
	int width, height;
};

/* B+ (eq. 3.5), rows and columns vertices: the identity for those that are not extrapolated; rows sum to 1. Compressed
 * rows: row i has the entries start[i] .. start[i + 1] - 1. */
struct rig_weights {
	int32_t *start, *column;
	float *weight;
};

struct rig {
	int n, n_faces, n_inputs;
	int32_t (*faces)[3];
	double *W;                       // [RIG_COMPONENTS][n_inputs + 1]
	double rest_e[RIG_COMPONENTS];
	double head_from_target[3][3];   // rotation: x to the person's left, y up, z out of the face
	double rest_aperture[4];         // g~ of g4, g5, g9, g10 at rest
	double baseline[4][3];           // A: g~[4,5,9,10] = A [horizontal, vertical, 1] (deg), eq. 3.11
	float (*rest)[3], (*normal)[3];  // the character's mesh, mm; unit normals
	float (*home)[2];                // where its vertices are seen at rest, px
	float (*basis)[RIG_BASIS];       // U~, px: x, then y
	float *fade;                     // what distance from the tracked skin leaves of an extrapolated vertex's motion, 0..1
	struct rig_weights bplus;
	float *thickness;                // t: least distance from the globe, mm
	float *gap;                      // delta0 + t: distance from the globe at rest, mm; of glued vertices
	float *glue;                     // 0..1: how far a vertex keeps that distance whatever the globe does
	uint8_t *part, *source, *side;   // enum rig_part, enum rig_source; the nearer globe: 0 left, 1 right
	struct skull_map skull;
	struct rig_globe globe[2];       // left, right
	struct rig_camera camera;
};

void rig_free(struct rig *rig);

/* e = W [g~; 1]. */
void rig_components(double e[RIG_COMPONENTS], const struct rig *rig, const double *inputs);

/* Rotation of a globe in the character's axes for a gaze in Fick's order (rad): horizontal, vertical, torsion. */
void rig_globe_rotation(double target_from_globe[3][3], const struct rig *rig, const double gaze[3]);

/* Of both globes, left and right, as controls g~ (deg) turn them. */
void rig_globes_turned(double target_from_globe[2][3][3], const struct rig *rig, const double *controls);

/* Signed distance of a point from that globe turned so: |r| - D; < 0 inside. mm. */
double rig_globe_distance(const struct rig *rig, int side, const double target_from_globe[3][3], const float x[3]);

/* rig.npz; made_by: JSON text or null. */
bool rig_save(const struct rig *rig, const char *path, const char *made_by, struct err *err);
bool rig_load(struct rig *rig, const char *path, struct err *err);

#endif
