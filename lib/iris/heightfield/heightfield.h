/* heightfield: coarse thickness of the iris stroma (iris paper section 4, figs. 5-6): a generic radial profile times local
 * detail from the photograph, where lighter is taken for thicker.
 * Maps: square, [size][size], centred on the optical axis, half-width extent mm, row 0 at -y.
 */
#ifndef IRIS_HEIGHTFIELD_HEIGHTFIELD_H
#define IRIS_HEIGHTFIELD_HEIGHTFIELD_H
#include "image/image.h"

struct pupil {
	double x, y, r;  // in the iris plane, mm
};

/* From IRIS/texture.json, key "pupil" {cx, cy, r}. No pupil there: centred, `fallback` mm. */
bool pupil_load(struct pupil *pupil, const char *texture_json, double fallback, struct err *err);

/* How far from the pupil's margin (0) to the iris root (1) a point lies, along circles that go over from one into the
 * other; negative in the pupil, above 1 outside the root. */
double iris_share(const struct pupil *pupil, double root, double x, double y);

struct profile_conf {
	double id[3], id_sigma[3];  // ID1 (root), ID2, ID3 (pupil), mm
	double id1_from_spur, id2_from_root, id3_from_margin;  // mm
	double margin_share, root_share;  // thickness at the very edges over ID3, ID1
	double root_beyond_limbus;        // mm
};

enum { PROFILE_KNOTS = 5 };

/* Thickness over iris_share(): monotone between its knots. */
struct profile {
	int n;
	double share[PROFILE_KNOTS], mm[PROFILE_KNOTS], sigma[PROFILE_KNOTS];
	double slope[PROFILE_KNOTS], sigma_slope[PROFILE_KNOTS];
};

/* width: from the pupil's margin to the root, mm. ID2 is left out where a wide pupil leaves it no place. */
void profile_make(struct profile *profile, const struct profile_conf *conf, double width);

/* Thickness and its sigma, mm; held constant beyond the edges. sigma may be null. */
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

/* clean: R, G, B, W. limbus: radius mm. */
bool heightfield_run(struct heightfield_result *out, const struct image *clean, double extent, const struct pupil *pupil,
                     double limbus, const struct heightfield_conf *conf, struct err *err);

#endif
