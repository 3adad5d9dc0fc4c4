/* heightfield: coarse thickness of the iris stroma (iris paper, section 4, figs. 5-6): a generic radial profile times local detail
 * of the photograph, where lighter is taken as thicker.
 * Maps   square, [size][size], centred on the optical axis, half-width `extent` mm, row 0 at -y.
 */
#ifndef IRIS_HEIGHTFIELD_HEIGHTFIELD_H
#define IRIS_HEIGHTFIELD_HEIGHTFIELD_H
#include "image/image.h"

struct pupil {
	double x, y, r;  // in the iris plane, mm
};

/* Reads the key "pupil" {cx, cy, r} of IRIS/texture.json. Where none was found: centred, radius `fallback` mm.
 * False, err set, when the file cannot be read. */
bool pupil_load(struct pupil *pupil, const char *texture_json, double fallback, struct err *err);

/* The radial coordinate of a point (mm): 0 at the pupil's margin, 1 at the iris root, constant on circles between the two;
 * negative in the pupil, above 1 outside the root. root: radius, mm. */
double iris_share(const struct pupil *pupil, double root, double x, double y);

struct profile_conf {
	double id[3], id_sigma[3];  // ID1 (root), ID2, ID3 (pupil), mm
	double id1_from_spur, id2_from_root, id3_from_margin;  // mm
	double margin_share, root_share;  // thickness at the very edges over ID3, ID1
	double root_beyond_limbus;        // mm
};

enum { PROFILE_KNOTS = 5 };

/* Thickness (mm) and its sigma over iris_share(), as monotone cubic splines. */
struct profile {
	int n;
	double share[PROFILE_KNOTS], mm[PROFILE_KNOTS], sigma[PROFILE_KNOTS];
	double slope[PROFILE_KNOTS], sigma_slope[PROFILE_KNOTS];
};

/* Makes the profile of an iris that is `width` mm wide from the pupil's margin to the root. ID2 is left out where a wide pupil
 * leaves no place for it. */
void profile_make(struct profile *profile, const struct profile_conf *conf, double width);

/* Thickness, mm, at a share; constant beyond the knots at either end. sigma: out, mm; may be null. */
double profile_at(const struct profile *profile, double share, double *sigma);

struct heightfield_conf {
	struct profile_conf profile;
	double gain;        // ln thickness per ln luminance
	double fine, coarse;  // detail lies between these Gaussians, mm
	double limit;       // largest factor
	double reach;       // how far detail is carried into texels that no photograph saw, mm
};

struct heightfield_result {
	struct image map;      // 2 channels: thickness mm, its sigma mm; image_free
	double root;           // mm
	double seen;           // share of the iris' texels with weight
	double mean, low, high;  // thickness over the iris: mean, 5 %, 95 %
	double detail_rms;     // of ln thickness
};

/* Computes the thickness map.
 * out     overwritten; image_free its map
 * clean   R, G, B (linear), W (weight): the texture without freckles
 * limbus  radius, mm
 * False, err set, when clean is not square or the pupil leaves less than 0.5 mm of iris. */
bool heightfield_run(struct heightfield_result *out, const struct image *clean, double extent, const struct pupil *pupil,
                     double limbus, const struct heightfield_conf *conf, struct err *err);

#endif
