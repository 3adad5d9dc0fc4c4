/* unrefract: photographs of one eye into the texture of its iris, as if there were no cornea.
 *
 * A small *survey* of each photograph, in its own eye frame, finds what must not be taken for iris (lids, lashes,
 * glints, the pupil). Where there are several, the surveys tell how they lie against one another. The *merge* then
 * samples each at full resolution through the exact light path.
 */
#ifndef IRIS_UNREFRACT_UNREFRACT_H
#define IRIS_UNREFRACT_UNREFRACT_H
#include "iris/iris_map.h"
#include "image/photo/photo.h"

struct unrefract_conf {
	struct iris_map_conf map;
	double scale;             // texels a photo pixel at the middle of the iris
	int max_size;             // texels a side, at most
	double extent;            // half-width over the limbus radius
	int survey_size;          // texels a side of the survey
	double pupil_margin;      // mm
	double limbus_ramp;       // mm over which the weight falls to nothing at the limbus
	double lid_z, lid_smooth; // outlier level, and stiffness of the lid's edge
	double glint_z, glint_grow, saturated;  // outlier level, mm, share of full scale
	double lash_contrast, lash_width;       // log, mm
	double foreshortening;    // exponent of a foreshortened texel's weight
	double torsion_max_deg;   // range searched between photographs
	double correlation_min;   // photographs that agree less are left out
	bool polarised;
};

struct circle {
	double cx, cy, r;  // iris plane, mm
};

/* What is known of one photograph. Planes are [size][size] of its own eye frame, half-width `extent`. */
struct unrefract_survey {
	int size;
	double extent;
	float *rgb;     // [size][size][3]
	float *weight;  // 0..1: share that is iris and well seen
	float *detail;  // local contrast, zero mean, unit variance; where there are several photographs
	float *sharp;   // local energy of the finest structure seen; likewise
	double lid_share, glint_share;  // of the iris
};

struct unrefract_view {
	const char *name;
	const struct fit *fit;
	struct iris_view iris;
	struct unrefract_survey survey;
	struct circle pupil;      // this photograph's own frame; r = 0: not found
	double rotation;          // of the map against this photograph's frame, radians
	double correlation;       // with the first photograph used; 1 for itself
	float gain[3];            // that brings its colour to the first photograph's
	bool used;
	char note[160];           // why not used
};

/* An iris map with what it is. rgbw: R, G, B, W. */
struct unrefract_texture {
	struct image rgbw;
	double extent;
	struct circle pupil;
	double seen;              // share of the iris' texels with weight
	long texels;              // sampled
};

/* Looks at one photograph. view: zeroed but for name. unrefract_view_free. */
bool unrefract_survey(struct unrefract_view *view, const struct photo *photo, const struct fit *fit,
                      const struct eye *eye, const struct unrefract_conf *conf, struct err *err);
void unrefract_view_free(struct unrefract_view *view);

/* Lays the views over the best one: rotation, shift and stretch of each, its colour gain, and weights where they
 * disagree or one is sharper. Those that do not match are not `used`. Returns the index of the best. */
int unrefract_align(int n, struct unrefract_view views[], const struct unrefract_conf *conf);

/* Resolution of the merged texture, texels a side. */
int unrefract_size(int n, const struct unrefract_view views[], const struct eye *eye,
                   const struct unrefract_conf *conf);

/* An empty sum; then unrefract_add for each used view; then unrefract_finish. */
struct unrefract_texture unrefract_begin(int size, const struct eye *eye, const struct circle *pupil,
                                         const struct unrefract_conf *conf);
void unrefract_add(struct unrefract_texture *texture, const struct unrefract_view *view, const struct photo *photo,
                   const struct eye *eye, const struct unrefract_conf *conf);
void unrefract_finish(struct unrefract_texture *texture, const struct eye *eye);

/* texture.json. names of the views, what to photograph better. */
bool unrefract_save_json(const char *path, const struct unrefract_texture *texture, int n,
                         const struct unrefract_view views[], const char *made_by, struct err *err);

#endif
