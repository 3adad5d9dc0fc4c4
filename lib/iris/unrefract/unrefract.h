/* unrefract: the texture of an iris from photographs of the eye, as if there were no cornea (iris paper, section 3).
 *
 * A small *survey* of each photograph, in its own eye frame, finds what is not iris (lids, lashes, reflections, the pupil).
 * Surveys of several photographs are registered to one another. The *merge* then samples each photograph at full resolution
 * through the exact light path.
 *
 * Order of calls: unrefract_survey of each photograph, unrefract_align, unrefract_size, unrefract_begin, unrefract_add of each
 * view that is used, unrefract_finish, unrefract_fill. A photograph is read by survey and add alone: it need not stay in memory between them.
 * Maps are square, centred on the optical axis, half-width `extent` mm, row 0 at -y.
 */
#ifndef IRIS_UNREFRACT_UNREFRACT_H
#define IRIS_UNREFRACT_UNREFRACT_H
#include "iris/iris_map.h"
#include "iris/balance.h"
#include "image/photo/photo.h"

struct unrefract_conf {
	struct iris_map_conf map;
	double scale;             // texels a photo pixel at the middle of the iris
	int max_size;             // texels a side, at most
	double extent;            // half-width of the maps over the limbus radius
	int survey_size;          // texels a side of the survey
	double pupil_told, pupil_missed, pupil_step;  // of pupils that were not measured: pupil.c
	double pupil_usual[2], pupil_fellow;  // radius in mm, sigma of its logarithm; of that of both eyes' ratio
	double pupil_margin;      // mm over which the weight rises at the pupil's margin
	double limbus_ramp;       // mm over which the weight falls to 0 at the limbus
	double haze;              // share of the iris' own light that the sclera's may add there
	double lid_z, lid_smooth; // standard score of a lid; stiffness of the lid's edge
	double lid_told, lid_shadow;  // scores for a unit of the evidence's log odds; log contrast of a lid's shadow
	double lid_shade;         // mm: how far at most a lid takes light from the iris below it; 0: that is left as it is
	double glint_z, glint_grow, saturated;  // standard score of a reflection, its margin in mm, share of full scale
	double lash_contrast, lash_width;       // log, mm
	double foreshortening;    // exponent of a foreshortened texel's weight
	double torsion_max_deg;   // torsion searched between photographs, each way
	double correlation_min;   // photographs that correlate less are left out
	bool polarised;           // cross-polarised photographs: without reflections of the cornea
};

enum { UNREFRACT_LIDS = 32 };  // places a side at which texture.json tells what lids leave of the light

struct circle {
	double cx, cy, r;  // iris plane, mm
};

/* How likely each size of a pupil is whose margin was not measured: radii that grow by the same ratio, log likelihoods, about a centre. */
enum { PUPIL_SIZES = 40 };
struct pupil_curve { bool known; double cx, cy, log_p[PUPIL_SIZES]; };

/* The survey of one photograph. Planes are [size][size] of its own eye frame, half-width `extent`; owned by the view. */
struct unrefract_survey {
	int size;
	double extent;  // mm
	float *rgb;     // [size][size][3], linear
	float *weight;  // 0..1: share that is iris and well seen
	float *shade;   // [3][size][size] logarithm of what lids leave of the light on it, red, green, blue, taken off rgb; null: all of it
	float *detail;  // local contrast, zero mean, unit variance; null where there is one photograph alone
	float *sharp;   // local energy of the finest structure seen; likewise
	double lid_share, glint_share;  // of the iris
	double lid_shade;               // share of the light on what is seen of it that lids take
};

struct unrefract_view {
	const char *name;         // of the photograph; the caller's
	const struct fit *fit;    // the caller's, must outlive the view
	struct balance white;     // of the photograph: what a reflection's colour is near; the caller's (balance.h)
	const struct occlusion *occlusion;  // of the photograph, beside the evidence (limbus/occlusion.h); the caller's, for the survey alone; null: none
	struct iris_view iris;
	struct unrefract_survey survey;
	struct circle pupil;      // this photograph's own frame
	double pupil_sigma;       // of the logarithm of its radius where it is the likeliest; 0: its margin was measured
	double rotation;          // of the map against this photograph's frame, radians
	double correlation;       // with the photograph that the others are registered to; 1 for itself
	double haze;              // mm inwards of the limbus over which the sclera's light spoils the iris' colour
	float gain[3];            // factors that bring its colour to that photograph's
	bool grey;                // the photograph has no colour
	bool used;
	char note[160];           // why not used
};

/* The merged iris map. */
struct unrefract_texture {
	struct image rgbw;        // R, G, B (linear), W (weight 0..1); image_free
	double extent;            // half-width, mm
	struct circle pupil;
	double pupil_sigma;       // as unrefract_view's
	double seen;              // share of the iris' texels with weight
	long texels;              // sampled, of all photographs
};

/* Surveys one photograph.
 * view      zeroed but for name, white and occlusion; unrefract_view_free
 * evidence  of this photograph, in a window round the limbus (limbus/evidence.h), or null: lids and reflections by brightness and hue
 *           of the rings alone
 * fellow    what the other eye in the photograph tells of a pupil that was not measured here; null: nothing
 * False, err set, when the iris lies outside the photograph. */
bool unrefract_survey(struct unrefract_view *view, const struct photo *photo, const struct fit *fit, const struct evidence *evidence,
                      const struct pupil_curve *fellow, const struct eye *eye, const struct unrefract_conf *conf, struct err *err);
/* What one eye of a photograph tells of the other's pupil; occlusion as of a view. False, err set, as above; out tells nothing then. */
bool unrefract_pupil(struct pupil_curve *out, const struct photo *photo, const struct fit *fit, const struct evidence *evidence, const struct occlusion *occlusion, const struct eye *eye,
                     const struct unrefract_conf *conf, struct err *err);
void unrefract_view_free(struct unrefract_view *view);

/* Registers the views to the best of them (most iris, seen largest): rotation, shift and stretch of each, its colour gain; and
 * lowers weights where a view is brighter than the others (a missed reflection) or less sharp. Views that do not match are no
 * longer `used`, nor are grey ones where others have colour; their note says why. Returns the index of the best view. */
int unrefract_align(int n, struct unrefract_view views[], const struct unrefract_conf *conf);

/* Resolution of the merged texture, texels a side: conf->scale times the finest view's, at most conf->max_size. */
int unrefract_size(int n, const struct unrefract_view views[], const struct eye *eye,
                   const struct unrefract_conf *conf);

/* An empty weighted sum of size x size texels with the pupil of the best view; image_free its rgbw. */
struct unrefract_texture unrefract_begin(int size, const struct eye *eye, const struct unrefract_view *best,
                                         const struct unrefract_conf *conf);

/* Adds one used view, sampled from its photograph. */
void unrefract_add(struct unrefract_texture *texture, const struct unrefract_view *view, const struct photo *photo,
                   const struct eye *eye, const struct unrefract_conf *conf);

/* Divides by the weights and fills `seen`. */
void unrefract_finish(struct unrefract_texture *texture, const struct eye *eye);

/* Fills between pupil and limbus what was not seen, or hardly: colour alone, the weight stays what it is and marks it. Nothing is filled
 * where nothing was seen at all. */
void unrefract_fill(struct unrefract_texture *texture, const struct eye *eye);

/* Writes texture.json: pupil, share seen, whether it has colour, each photograph's white, each view's alignment, and advice on what to photograph better.
 * made_by: stage_made_by(). False, err set, when it cannot be written. */
bool unrefract_save_json(const char *path, const struct unrefract_texture *texture, int n,
                         const struct unrefract_view views[], const char *made_by, struct err *err);

#endif
