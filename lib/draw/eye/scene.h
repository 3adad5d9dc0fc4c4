/* scene: a fitted eye that is ready to be rendered. Geometry and maps are made once; views and lights come and go.
 *
 * Frame    eye (lib/README.md): origin at the corneal apex, z into the eye, mm.
 * Surface  the cornea's conic inside the limbus, the scleral sphere outside; both meet in the limbus circle. Normal, colour
 *          and opacity are blended over the width of the limbus.
 * Iris     z = iris_depth - height(x, y). Below it lie the anterior border layer, the stroma of thickness(x, y), and an
 *          epithelium that absorbs everything (tissue/tissue.h).
 * Colour   linear Rec. 709. A white plane that faces the camera under an environment of envmap_normalise has value 1.
 *
 * Pictures: render.h (quick or exact), converge.h (Monte Carlo reference), surface.h (depth and normals).
 */
#ifndef DRAW_EYE_SCENE_H
#define DRAW_EYE_SCENE_H
#include <stdint.h>

#include "anatomy/eye.h"
#include "image/envmap/envmap.h"
#include "image/image.h"
#include "optics/refraction/refraction.h"
#include "tissue/light/rim_shadow.h"
#include "tissue/tissue.h"

enum { SCENE_LEVELS = 6, SCENE_GRID = 48, SCENE_NODES_MAX = 256 };

enum scene_quadrature { SCENE_GAUSS, SCENE_MIDPOINT, SCENE_EXPONENTIAL };
enum scene_shading { SCENE_RAYS, SCENE_TEXELS };       // march along every ray of sight (exact), or once a view from the map's texels (quick)
enum scene_path { SCENE_PATH_GRID, SCENE_PATH_ENDS };  // the light's path to a point: from a table, or solved at both ends of a ray (march/light.c)

struct scene_lighting;
struct scene_view;

struct scene_conf {
	int map_size;                 // texels across the finest map, at most
	int search, shadow;           // steps of the search for the relief along a ray of sight; of a shadow ray
	int steps;                    // of the march
	int quadrature, path;         // enum scene_quadrature, enum scene_path
	int shading, apart;           // enum scene_shading; the march is done at every so many texels (1, 2, 4 or 8; 0: 2)
	int bands;                    // wavelengths, 3..TISSUE_BANDS_MAX
	double detail;                // 0: the fitted model alone, its map of melanin in it; 1: times all of what the photograph shows beyond it
	double albedo_mm, albedo_most;  // what of photograph over model is finer than that is the iris' albedo, within that factor (own_light.h); 0: all is
	double own_width;             // sigma of the mean direction of a light over which own_light fades (own_light.h)
	double ratio_most, ratio_chroma;  // most that a texel brightens over the photograph, and that its channels differ from their mean (colour.h)
	double limbus_width;          // mm, over which sclera becomes cornea
	double sclera_radius;         // mm
	double sclera_rgb[3];         // albedo of a healthy sclera
	double vein_density;          // 1: as many vessels as a healthy eye has
	const struct image *vessels;  // of a photograph, vessels_of_photo, read while the scene is made; null: none
	int veins_px, seed;
};

/* A square map for quick pictures: [n][stride][4] of which three count, in multiples of step. Rows are a cache line longer
 * than a power of two, or the rows of a tile would evict each other from the cache. */
struct scene_texels {
	int n, stride;
	float step;
	uint16_t *px;
};

/* One resolution of the iris maps; each level has half the texels of the one before. Square, row 0 is -y. */
struct scene_level {
	int n;
	float per_mm;                 // texels in a mm
	float *relief;                // [n][n][2]: height mm, + towards the cornea; stroma mm
	int *pairs;                   // [n][SCENE_PAIR_STRIDE(n)]: heights of a texel and of the next one to the right, 16 bits each; null: SCENE_RAYS
	int *bottom;                  // the same of half the height of the epithelium below; null: no march starts from this level
	float *colour;                // [n][n][4]: the photograph's, and 1 where a photograph saw it
	float *model;                 // [n][n][4]: what the model showed in the photograph's light and view
	float *per_model;             // [tiles of it][3][64]: 1 over that; null: no model, or no march starts from this level
	struct march_horizon *horizon;  // of its tiles (march/march.h); null: no march starts from this level
	struct scene_texels shown, bare;  // colour (to the power of detail) with the pupil cut out; the same without the
	                                  // photograph's light; empty: SCENE_RAYS
};

struct scene {
	struct eye eye;
	struct cornea cornea;         // its rim a little outside the limbus: the blend needs cornea there
	struct scene_conf conf;
	double limbus[2], limbus_depth, sclera_z;  // half-widths across and upwards; depth of its plane; centre of the sphere
	double pupil[3];              // x, y, radius in the iris plane
	double extent;                // half-width of the maps
	float height_min, height_max;
	float tissue_range[2];        // between pupil and limbus: the epithelium's lowest and the surface's highest place, mm from the iris plane towards the cornea
	int n_levels;
	struct scene_level level[SCENE_LEVELS];
	struct image veins;           // map of the sclera (sclera.h): albedo RGB; share of green that vessels take
	struct scene_texels white;    // the same
	struct image tint;            // [n][n][3] over the maps' square: what melanin's map and white's error change the model's colour by; empty: nothing
	struct image own_light;       // [n][n] over the maps' square: ln of what the photograph's own light did beyond the model (own_light.h); empty: nothing
	float own_mean[3];            // mean direction of that light, eye's frame
	struct image film;            // map of the sclera: slopes of the tear film's ripples
	struct tissue tissue;
	struct tissue_optics optics;
	struct rim_shadow rim;               // how light ends at the limbus
	float spread[3];              // of light in the tissue next to it, by channel, mm (tissue/spread.h)
	struct scene_paths *paths;    // paths of light into the eye, for beams of several lights (march/paths.h); owned; null: solved for each
	struct refraction refraction; // of the artifact; zero: solved from the closed-form start
	int n_nodes[2];               // of the march's quadrature, in each layer
	double node[2][SCENE_NODES_MAX], weight[2][SCENE_NODES_MAX];  // on 0..1
	float flat[3];                // the model's mean reflectance, for pictures without a march
	double photo_white[3];        // white in the photographs (tint.h): colours here are over it, as in light without colour, of level 1; pictures in the photograph's own
	                              // light are multiplied by it
	float gain;                   // geometric mean of photograph over model: what the exposure leaves
	double explained;             // share of the variance of ln colour that the model explains by itself
	bool plain, filmed;           // nobody photographed it; but its pupil is that of a film
	long not_finite;              // map values that were not finite, and became 0
	double odd_pupil;             // radius of a recorded pupil that is impossible, replaced by a usual one; 0: it was possible
};

/* Paths of the artifacts of one eye; of all but the texture, a null path or a missing file is done without. */
struct scene_files {
	const char *texture, *texture_json, *relief, *pigment, *refraction;
};

/* Loads maps, tissue and pupil. Call scene_fit_colour next; scene_free at the end.
 * scene  overwritten
 * conf   copied, with sclera_rgb filled in, over the photographs' white
 * Returns false, err set, scene empty, when a file cannot be read or the maps do not fit each other. */
bool scene_load(struct scene *scene, const struct scene_files *files, const struct eye *eye,
                const struct scene_conf *conf, struct err *err);
/* An eye that nobody photographed: an iris of about the colour rgb (linear), with fibres from a seed. seen: what a film shows of it, which is
 * completed by those fibres, and its pupil; null: nothing. scene_fit_colour next; scene_free at the end. */
struct scene_seen;
void scene_plain(struct scene *scene, const struct eye *eye, const struct scene_conf *conf, const double rgb[3], uint64_t seed, struct scene_seen *seen);
void scene_free(struct scene *scene);

/* The albedo step: fills level[].model with what the model shows in this view and light, those of the reference photograph, so
 * that a rendering of them shows what the photograph shows (fit_colour.c). conf.detail is its strength. Call once, after
 * scene_load or scene_plain. */
void scene_fit_colour(struct scene *scene, const struct scene_view *view, const struct scene_lighting *light);

/* Shows the same eye with another strength of the photograph's detail: conf.detail. After scene_fit_colour. */
void scene_set_detail(struct scene *scene, double detail);

#endif
