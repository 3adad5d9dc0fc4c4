/* pigment: estimates the melanin of the iris from its texture: the automatic search that the iris paper leaves as future work.
 *
 * The texture is reduced to classes of similar light and radius. Their colours, relative to white on the iris, are fitted by the forward
 * model of tissue/tissue.h: non-linear least squares with Gaussian priors, from several starts. Combinations of unknowns that one
 * photograph does not determine are held by the priors; the covariance and `direction` show them.
 */
#ifndef TISSUE_PIGMENT_PIGMENT_H
#define TISSUE_PIGMENT_PIGMENT_H
#include "iris/heightfield/heightfield.h"
#include "tissue/tissue.h"

/* The unknowns. Concentrations, scale, exposure and gains are natural logarithms. */
enum pigment_unknown {
	PIGMENT_ABL_MELANIN, PIGMENT_ABL_RATIO, PIGMENT_STROMA_MELANIN, PIGMENT_STROMA_RATIO, PIGMENT_SCALE,
	PIGMENT_EXPOSURE,
	PIGMENT_RED, PIGMENT_BLUE,  // ln gain of red and of blue relative to green: error of the white balance
	PIGMENT_VEIL,               // light that the cornea reflects over the iris, white = 1
	PIGMENT_N
};
extern const char *const pigment_names[PIGMENT_N];

struct pigment_class {
	double thickness;         // mm, median; where classes are told apart by light: of its ring
	int ring;                 // with pigment_classes.rings: which; and the standard score of its light there
	double z;
	double share;             // iris_share, mean
	double rgb[3], spread[3]; // reflectance factor (white Lambertian = 1): robust mean, and the scatter of texels about it
	double texels;            // effective number of independent texels
};

enum { PIGMENT_CLASSES_MAX = 64, PIGMENT_RINGS_MAX = 8 };
struct pigment_classes {
	int n;
	int rings;                // of radius, whose levels are told apart by light; 0: thickness is that of the class
	struct pigment_class of[PIGMENT_CLASSES_MAX];
};

struct pigment_classes_conf {
	int rings, levels;             // rings of radius (at most PIGMENT_RINGS_MAX) times levels of light
	double inner, outer;           // iris_share between which tissue is trusted
	double grain;                  // mm: detail below it is not independent
};

/* What the photographs show of an iris; all borrowed. */
struct pigment_texture {
	const struct image *clean;      // R, G, B, W (linear; weight), square, half-width extent mm, without freckles
	const struct image *thickness;  // first channel mm; same grid
	const struct image *light;      // what white on the iris shows against `white`: iris_light_make, of the same extent; R, G, B, cosine
	double extent;
	const struct pupil *pupil;
	double root;                    // radius of the iris' root, mm
	const double *white;            // [3], of white that faces the camera in the same light
};

/* Reduces a texture to classes. Classes with too few texels are left out. Returns false, err set, when fewer than 3 remain. */
bool pigment_classify(struct pigment_classes *out, const struct pigment_texture *texture, const struct pigment_classes_conf *conf,
                      struct err *err);

struct pigment_conf {
	double prior[PIGMENT_N][2];  // mean and sigma, in the unknowns' own units; veil: mean 0
	double abl_thickness;        // mm
	double cos_light, cos_view;
	double light_error, model_error;  // of ln light and of ln colour of a class, 1 sigma
	double floor;                // absolute, of reflectance
	double profile_error, ring_error;  // of ln thickness of the profile: common to all rings, and of each
	double melanin_ring;         // rms of ln melanin of the border layer between rings; 0: the same in all of them
	double prior_spread[2];      // rms of ln thickness inside a ring: mean and sigma of its logarithm
	enum illuminant illuminant;
	int bands, starts;
	bool polarised;              // no veil
	bool multiple;               // all orders of scattering
};

enum { PIGMENT_MINIMA_MAX = 8 };
struct pigment_fit {
	double x[PIGMENT_N], sigma[PIGMENT_N], correlation[PIGMENT_N][PIGMENT_N];
	double residual_rgb[3];  // rms over the classes, reflectance
	double residual;         // rms over classes and channels, relative to their own rms
	double residual_colour, residual_light;  // rms of ln red/green and ln blue/green; of ln green
	double light_error, model_error;  // as used
	double thickness[PIGMENT_CLASSES_MAX];  // mm, of each class
	double varies;           // 0..1: share of melanin_ring that the colours ask for; 0: one melanin explains them
	int rings;
	struct pigment_ring { double share, beyond, melanin, sigma; } ring[PIGMENT_RINGS_MAX];  // iris_share of its middle; ln thickness beyond
	                                                                                       // the profile; ln melanin beyond the iris', sigma
	double cost;             // half the sum of squares, priors in it
	int iterations;          // over all starts
	int starts, minima;      // distinct minima found, within 2 of the lowest cost
	double other[PIGMENT_MINIMA_MAX][PIGMENT_N + 1];  // the others': unknowns, then cost
	int directions;          // eigenvectors of the information matrix that the priors determine rather than the photograph
	double direction[PIGMENT_N][PIGMENT_N], information[PIGMENT_N];  // in units of the priors' sigma; data over prior
};

/* The tissue of these unknowns. */
struct tissue pigment_tissue(const double x[PIGMENT_N], const struct pigment_conf *conf);

/* The same with `beyond` added to ln melanin of the border layer. */
struct tissue pigment_tissue_beyond(const double x[PIGMENT_N], double beyond, const struct pigment_conf *conf);

/* Forward model: reflectance that the photograph shows of stroma of that thickness (mm), with exposure, white error and veil. */
void pigment_model(double rgb[3], const double x[PIGMENT_N], const struct tissue_optics *optics, double stroma,
                   const struct pigment_conf *conf);

/* What a photograph shows of a reflectance: exposure, error of the white, veil. */
void pigment_photograph(double seen[3], const double rgb[3], const double x[PIGMENT_N]);

/* The same of class i of a fit, with its ring's melanin. */
void pigment_class_model(double rgb[3], const struct pigment_fit *fit, const struct pigment_classes *classes, int i,
                         const struct pigment_conf *conf, const struct tissue_bands *bands);

/* Fits the unknowns to the classes. Where the classes differ from the model by more than conf says they do (light_error, model_error), that
 * difference is the error that sigmas are reckoned with.
 * Melanin differs between rings as far as one melanin leaves colours beyond model_error; where it does not, there is one.
 * from  [PIGMENT_N] the one start, or null: conf->starts starts, the first at the priors' means
 * Returns false, err set, when no start converges. */
bool pigment_solve(struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                   const double *from, struct err *err);

/* Writes IRIS/pigment.json. extra: text of a JSON object with further keys, or null. */
bool pigment_save(const struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                  const char *path, const char *made_by, const char *extra, struct err *err);

/* The same for an iris of which no pigments can be told: the file holds the reason ("without"). */
bool pigment_save_none(const char *reason, const char *path, const char *made_by, const char *extra, struct err *err);

/* Reads it back: the unknowns, the white they were found with, and those fields of conf that shape the forward model. Returns false,
 * err set, when the file is damaged. */
bool pigment_load(double x[PIGMENT_N], double white[3], struct pigment_conf *conf, const char *path, struct err *err);

#endif
