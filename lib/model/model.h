/* skin/model: how lids and skin move with the eyes (skin paper, equations 3.2 to 3.11).
 *
 * Inputs   g[n_inputs], in the units of gaze.csv: g1 g2 g3 (Fick horizontal, vertical, torsion; degrees) g4 g5 (px) of the
 *          left eye, g6..g10 of the right, then n_au action units, 0..1. g4: the upper lid's middle ABOVE the plane of the
 *          closed lid; g5: the lower lid's middle BELOW it: both grow as the eye opens, g4 + g5 is its opening (eq. 3.6
 *          as ERRATA has it).
 * Controls c[n_inputs], the paper's g~: the same with g4 g5 g9 g10 in 0 (closed) .. 1 (wide open), equation 3.7.
 * Lids     l[n_lid] px of the modelling camera, [lid][control point][x y]; lids: left upper, left lower, right upper,
 *          right lower; inner canthus first.
 * Skin     u[2 n_vertices] px of the modelling camera (x y of each), which is fixed to the head.
 *
 *     l = l0 + K L [g; 1]         u = u0 + J e, e = M [l; au; 1] = W [c; 1]
 *
 * What the clip did not show (an eye out of the picture, a vertex hardly seen) is not modelled: NAN in l0, l, u0 and u,
 * zeros in K, M and J.
 * Fitted numbers have standard errors beside them (delete-a-block jackknife over time, so that neighbouring frames do
 * not count as independent); they tell nothing of inputs that the clip does not show, skin_model_leverage does. Everything
 * row-major; owned by the model.
 */
#ifndef MODEL_MODEL_H
#define MODEL_MODEL_H
#include "base/err.h"

enum { SKIN_EYE_INPUTS = 10, SKIN_LIDS = 4 };

/* The modelling camera. Without a mesh, cam_from_head is the identity. */
struct skin_camera {
	int width, height;            // px of the video
	double focal_px, center_px[2], distortion[5];
	double cam_from_head[4][4];   // at the reference frame, mm
};

struct skin_model {
	int n_au, n_inputs;           // n_inputs = SKIN_EYE_INPUTS + n_au
	int n_points, n_lid;          // control points a lid; n_lid = SKIN_LIDS * n_points * 2
	int n_vertices;
	int n_lid_pc, n_skin_pc;      // principal components kept
	char **au_names;              // [n_au]
	int *vertices;                // [n_vertices] rows of the subject mesh
	int reference_frame;
	struct skin_camera camera;

	double *l0, *l0_sigma;        // [n_lid] px
	double *K, *K_sigma;          // [n_lid][n_lid_pc], orthonormal columns, each of one eye's lids alone
	double *L, *L_sigma;          // [n_lid_pc][SKIN_EYE_INPUTS + 1], px a unit of the input; last: constant
	double *u0, *u0_sigma;        // [2 n_vertices] px
	double *J, *J_sigma;          // [2 n_vertices][n_skin_pc], orthonormal columns
	double *M, *M_sigma;          // [n_skin_pc][n_lid + n_au + 1]
	double *W_sigma;              // [n_skin_pc][n_inputs + 1], of skin_model_fold's W, J taken as known
	double *lid_pc, *lid_pc_sigma;    // [n_lid_pc] standard deviation along each component, px
	double *skin_pc, *skin_pc_sigma;  // [n_skin_pc]
	double *vertex_rms;           // [n_vertices] px left unexplained in held-out frames; NAN: not modelled
	double *rest_controls;        // [n_inputs] c at the reference frame, in which the subject's mesh lies on the picture
	double *rest_e;               // [n_skin_pc] e there, as measured: J^T (u - u0)

	/* How far inputs lie from those learnt from, as regress_reach has it: of each eye's own five for its lids, of all for
	 * the skin. NAN: not modelled. */
	double *lid_reach;            // [2][5][6]
	double *skin_reach;           // [n_inputs][n_inputs + 1]

	double *low, *high, *mean;    // [n_inputs] range and mean of the clip's inputs; NAN: input never measured
	double closed[SKIN_EYE_INPUTS], open[SKIN_EYE_INPUTS];  // px, g_closed and g_open; apertures alone, else 0
	double aperture_sigma;        // px, of closed and open
	double baseline[2][2][3], baseline_sigma[2][2][3];  // A, eq. 3.11: [left, right][upper, lower][g1, g2, 1] degrees
};

/* Allocates every array, zeroed, for the counts set in *model (n_au, n_points, n_vertices, n_lid_pc, n_skin_pc). */
void skin_model_alloc(struct skin_model *model);
void skin_model_free(struct skin_model *model);

/* dir/model.json and dir/model_*.npy: "my-capture/work/skin". Load refuses matrices that do not fit each other, in one
 * line. */
bool skin_model_save(const struct skin_model *model, const char *dir, const char *made_by, struct err *err);
bool skin_model_load(struct skin_model *model, const char *dir, struct err *err);

/* Every file skin_model_save writes, relative to dir ("model.json" first); null-terminated. */
extern const char *const skin_model_files[];

/* Equation 3.7 and its inverse. Where an eye was not learnt its apertures are 0. May be the same array. */
void skin_model_inputs(double *g, const struct skin_model *model, const double *controls);
void skin_model_controls(double *controls, const struct skin_model *model, const double *g);

/* Equation 3.2: l[n_lid]. */
void skin_model_lids(double *l, const struct skin_model *model, const double *g);

/* Equation 3.3 from measured or predicted lids: u[2 n_vertices]; e[n_skin_pc] may be null. */
void skin_model_skin(double *u, double *e, const struct skin_model *model, const double *l, const double *au);

/* The general path, not folded: controls -> inputs -> lids -> skin. l[n_lid] may be null. */
void skin_model_predict(double *u, double *l, const struct skin_model *model, const double *controls);

/* Equation 3.10: W[n_skin_pc][n_inputs + 1], homogeneous, so that u = u0 + J W [c; 1]. U~ of the subject mesh is J with
 * the mean u0; of a character, B+ J with the mean B+ u0. */
void skin_model_fold(double *W, const struct skin_model *model);

/* What the clip tells of inputs g: the leverage h of the left lids, the right lids and the skin (TRAIN_PARTS' order), the
 * variance that the fitted slopes leave there over that of one frame. Above SKIN_REACH less than one frame tells of them:
 * lids and skin there are a guess. NAN: not modelled, or g is not known. */
#define SKIN_REACH 1.1  // 1 and the rounding of squares
void skin_model_leverage(double h[3], const struct skin_model *model, const double *g);

/* Equation 3.11: upper and lower control of one eye (0 left, 1 right) looking at g1, g2 degrees, scaled by c >= 0. */
void skin_model_baseline(double control[2], const struct skin_model *model, int eye, double c, double g1, double g2);

#endif
