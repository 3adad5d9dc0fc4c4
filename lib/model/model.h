/* model: a linear model of how a person's lids and skin move with gaze, lid aperture and expression (skin paper, section 3.5,
 * equations 3.2 to 3.11). model/train/train.h fits it.
 *
 * Inputs   g[n_inputs], in the units of gaze.csv: g1 g2 g3 (Fick horizontal, vertical, torsion; degrees) g4 g5 (px) of the
 *          left eye, g6..g10 of the right, then n_au action units, 0..1. g4: the upper lid's middle ABOVE the plane of the
 *          closed lid; g5: the lower lid's middle BELOW it: both grow as the eye opens, g4 + g5 is its opening (eq. 3.6
 *          as corrected in tests/ERRATA.md).
 * Controls c[n_inputs], the paper's g~: the same with g4 g5 g9 g10 in 0 (closed) .. 1 (wide open), equation 3.7.
 * Lids     l[n_lid] px of the modelling camera, [lid][control point][x y]; lids: left upper, left lower, right upper,
 *          right lower; inner canthus first.
 * Skin     u[2 n_vertices] px of the modelling camera (x y of each), which is fixed to the head.
 *
 *     l = l0 + K L [g; 1]         u = u0 + J e, e = M [l; au; 1] = W [c; 1]
 *
 * K and J are principal components, L and M linear regressions on them; W is both regressions folded into one.
 * What the clip did not show (an eye out of the picture, a vertex hardly seen) is not modelled: NAN in l0, l, u0 and u,
 * zeros in K, M and J.
 * Each fitted number has a standard error in the array of the same name with _sigma: delete-a-block jackknife over time, so that
 * neighbouring frames do not count as independent. Standard errors do not cover extrapolation to inputs that the clip does not
 * show: skin_model_leverage measures that. All arrays are row-major and owned by the model.
 */
#ifndef MODEL_MODEL_H
#define MODEL_MODEL_H
#include "base/err.h"
#include "model/express.h"
#include "model/known.h"

enum { SKIN_EYE_INPUTS = 10, SKIN_LIDS = 4 };

/* The modelling camera: the video's, fixed to the head, as it stood at the reference frame. Pinhole with OpenCV's distortion
 * k1 k2 p1 p2 k3. Without a subject mesh, cam_from_head is the identity. */
struct skin_camera {
	int width, height;            // px of the video
	double focal_px, center_px[2], distortion[5];
	double cam_from_head[4][4];   // at the reference frame, mm
};

/* The person's eyeballs in the head, mm: left, right. limbus: radius of the circle in which the white ends. NAN: not known. */
struct skin_eyes {
	double center[2][3], radius[2], limbus[2];
};

struct skin_model {
	int n_au, n_inputs;           // n_inputs = SKIN_EYE_INPUTS + n_au
	int n_points, n_lid;          // control points a lid; n_lid = SKIN_LIDS * n_points * 2
	int n_vertices;               // 0: no skin was followed, the lids alone are modelled
	int n_lid_pc, n_skin_pc;      // principal components kept; of no skin 0
	char **au_names;              // [n_au]
	int *vertices;                // [n_vertices] rows of the subject mesh
	int reference_frame;
	struct skin_camera camera;
	struct skin_eyes eyes;

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
	double *rest_controls;        // [n_inputs] c at the reference frame, in which the subject's mesh matches the picture
	double *rest_e;               // [n_skin_pc] e there, as measured: J^T (u - u0)

	/* Factors for the leverage of inputs (regress_reach): of each eye's own five inputs for its lids, of all inputs for the
	 * skin. NAN: not modelled. */
	double *lid_reach;            // [2][5][6]
	double *skin_reach;           // [n_inputs][n_inputs + 1]

	double *low, *high, *mean;    // [n_inputs] range and mean of the clip's inputs; NAN: input never measured
	struct known known;           // gazes at which the clip shows lids; skin_model_alloc: all
	double closed[SKIN_EYE_INPUTS], open[SKIN_EYE_INPUTS];  // px, g_closed and g_open of the apertures; 0 for other inputs
	double aperture_sigma;        // px, of closed and open
	double baseline[2][2][3], baseline_sigma[2][2][3];  // A, eq. 3.11: [left, right][upper, lower][g1, g2, 1] degrees

	/* What each expression in full does to lids (model/express.h), beyond A at the gaze. Where the clip does not tell: 0 of sigma NAN. */
	double (*expression)[EXPRESS_LIDS], (*expression_sigma)[EXPRESS_LIDS];  // [n_au] controls
};

/* Eyes of which nothing is known. */
struct skin_eyes skin_eyes_unknown(void);

/* Allocates every array, zeroed, for the counts set in *model (n_au, n_points, n_vertices, n_lid_pc, n_skin_pc); sets n_inputs and
 * n_lid from them. skin_model_free accepts an empty model. */
void skin_model_alloc(struct skin_model *model);
void skin_model_free(struct skin_model *model);

/* Writes and reads dir/model.json and dir/model_*.npy; dir is a capture's work/skin. made_by: JSON text or null.
 * skin_model_load fills an empty model, skin_model_free. Both return false, err set; load also when the shapes of the matrices do
 * not match the counts in model.json, and the model is empty then. */
bool skin_model_save(const struct skin_model *model, const char *dir, const char *made_by, struct err *err);
bool skin_model_load(struct skin_model *model, const char *dir, struct err *err);

/* Names of the files that skin_model_save writes, relative to dir ("model.json" first); null-terminated. */
extern const char *const skin_model_files[];

/* Inputs from controls and controls from inputs: equation 3.7 and its inverse. Both arrays have n_inputs numbers and may be the
 * same. Apertures of an eye that was not learnt are 0. */
void skin_model_inputs(double *g, const struct skin_model *model, const double *controls);
void skin_model_controls(double *controls, const struct skin_model *model, const double *g);

/* Lids from inputs, equation 3.2. l[n_lid] px, g[n_inputs]. */
void skin_model_lids(double *l, const struct skin_model *model, const double *g);

/* Skin from lids (measured or predicted) and action units, equation 3.3.
 * u   [2 n_vertices] px, out
 * e   [n_skin_pc] the components' scores, out; may be null
 * l   [n_lid] px
 * au  [n_au] 0..1 */
void skin_model_skin(double *u, double *e, const struct skin_model *model, const double *l, const double *au);

/* Skin from controls by equations 3.7, 3.2 and 3.3 one after the other, without folding them. u[2 n_vertices] px, out; l[n_lid] px,
 * out, may be null; controls[n_inputs]. */
void skin_model_predict(double *u, double *l, const struct skin_model *model, const double *controls);

/* Folds both regressions into one matrix, equation 3.10: W[n_skin_pc][n_inputs + 1], homogeneous, out, so that
 * u = u0 + J W [c; 1]. U~ of the subject mesh is J with the mean u0; of a character, B+ J with the mean B+ u0. */
void skin_model_fold(double *W, const struct skin_model *model);

/* Leverage h of inputs g[n_inputs] for the left lids, the right lids and the skin (TRAIN_PARTS' order): the variance of the
 * prediction that the fitted slopes contribute, over the variance of one frame. Above SKIN_REACH less than one frame of the clip
 * supports the prediction: it is an extrapolation. NAN: not modelled, or g is not known. */
#define SKIN_REACH 1.1  // 1 and the rounding of squares
void skin_model_leverage(double h[3], const struct skin_model *model, const double *g);

/* The usual aperture at a gaze, equation 3.11: controls of the upper and the lower lid of one eye (0 left, 1 right) that looks at
 * g1 (horizontal), g2 (vertical), degrees; multiplied by c >= 0. Beyond the known gazes: as at the nearest (known_hold). */
void skin_model_baseline(double control[2], const struct skin_model *model, int eye, double c, double g1, double g2);

/* Adds what expressions do to lids to controls[n_inputs], whose apertures are of an eye open by c[left, right]: express_eye by the model's own numbers. */
void skin_model_express(double *controls, const struct skin_model *model, const double c[2]);
/* What the apertures g4 g5 g9 g10 are from closed to open, px; of an eye that was not learnt 0. */
void skin_model_range(double px[EXPRESS_LIDS], const struct skin_model *model);

#endif
