/* scene: a fitted eye ready to be looked at. Geometry and maps are made once; views and lights come and go.
 *
 * Frame    eye (DESIGN section 4): origin at the corneal apex, z into the eye, mm.
 * Surface  the cornea's conic inside the limbus, the scleral sphere outside; both meet in the limbus circle, and
 *          normal, colour and opacity pass from one to the other over the width of the limbus.
 * Iris     z = iris_depth - height(x, y); below it the anterior border layer, the stroma of thickness(x, y), and an
 *          epithelium that absorbs everything (tissue.h).
 * Colour   linear Rec. 709. A white plane that faces the camera under an environment of envmap_normalise has value 1.
 */
#ifndef DRAW_EYE_SCENE_H
#define DRAW_EYE_SCENE_H
#include <stdint.h>

#include "anatomy/eye.h"
#include "anatomy/fit.h"
#include "tissue/tissue.h"
#include "image/envmap/envmap.h"
#include "image/image.h"
#include "optics/refraction/refraction.h"

enum { SCENE_LEVELS = 6, SCENE_GRID = 48, SCENE_NODES_MAX = 256 };

enum scene_quadrature { SCENE_GAUSS, SCENE_MIDPOINT, SCENE_EXPONENTIAL };
enum scene_shading { SCENE_RAYS, SCENE_TEXELS };       // the march: along every ray of sight, or from the map's texels once a view
enum scene_path { SCENE_PATH_GRID, SCENE_PATH_ENDS };  // the light's way to a point: see draw/eye/march/light.c

struct scene_conf {
	int map_size;                 // texels across of the finest map, at most
	int search, shadow;           // steps of the search for the relief; of the shadow ray
	int steps;                    // of the march
	int quadrature, path;         // enum scene_quadrature, enum scene_path
	int shading, apart;           // enum scene_shading; texels: the march is at every so many texels (1, 2, 4 or 8; 0: 2)
	int bands;                    // wavelengths, 3..TISSUE_BANDS_MAX
	double detail;                // 0: the fitted model alone; 1: times all of what the photograph shows beyond it
	double limbus_width;          // mm, over which sclera becomes cornea
	double sclera_radius;         // mm
	double sclera_rgb[3];         // of a healthy sclera
	double vein_density;          // 1: about forty vessels
	int veins_px, seed;
};

/* A square map for quick pictures: [n][stride][4] of which three count, in multiples of step. Rows are a line of the cache
 * longer than a power of two, or a tile's rows would push each other out of it. */
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
	int *bottom;                  // the same of half the height of the epithelium below; null: the level is not marched from
	float *colour;                // [n][n][4]: the photograph's, and 1 where a photograph saw it
	float *model;                 // [n][n][4]: what the model showed in the photograph's light and view
	float *per_model;             // [tiles of it][3][64]: 1 over that; null: no model, or the level is not marched from
	struct march_horizon *horizon;  // of its tiles (draw/eye/march/march.h); null: level is not marched from
	struct scene_texels shown, bare;  // colour (to the power of detail) with the pupil cut out; the same without the
	                                  // photograph's light; empty: SCENE_RAYS
};

struct scene {
	struct eye eye;
	struct cornea cornea;         // its rim a little outside the limbus, so that the blend has something to see
	struct scene_conf conf;
	double limbus[2], limbus_depth, sclera_z;  // half-widths across and upwards; depth of its plane; centre of the sphere
	double pupil[3];              // x, y, radius in the iris plane
	double extent;                // half-width of the maps
	float height_min, height_max, thickness_max;
	int n_levels;
	struct scene_level level[SCENE_LEVELS];
	struct image veins;           // azimuthal about the axis: albedo RGB
	struct scene_texels white;    // the same
	struct image film;            // the same: slopes of the tear film's ripples
	struct tissue tissue;
	struct tissue_optics optics;
	struct scene_paths *paths;    // the light's ways, for beams of several lights (draw/eye/march/paths.h); owned; null: solved for each
	struct refraction refraction; // of the artifact; zero: solved from the closed-form start
	int n_nodes[2];               // of the march, in each layer
	double node[2][SCENE_NODES_MAX], weight[2][SCENE_NODES_MAX];  // on 0..1
	float flat[3];                // the model's mean reflectance, where it is seen without a march
	float gain;                   // photograph over model: what the exposure leaves
	double explained;             // share of the colour's variance (log) that the model accounts for by itself
	long not_finite;              // values of the maps that were no numbers, and became 0
	double odd_pupil;             // radius of a pupil that cannot be, for which a usual one stands; 0: it could be
};

/* The artifacts of one eye; a null path (or a file that is not there) is done without. */
struct scene_files {
	const char *texture, *texture_json, *relief, *pigment, *refraction;
};

/* The maps, the tissue, the pupil; then scene_fit_colour. sclera_rgb in conf. scene_free. */
bool scene_load(struct scene *scene, const struct scene_files *files, const struct eye *eye,
                const struct scene_conf *conf, struct err *err);
/* An eye nobody photographed: an iris of about that colour (linear), its fibres from a seed. scene_fit_colour, scene_free. */
void scene_plain(struct scene *scene, const struct eye *eye, const struct scene_conf *conf, const double rgb[3], uint64_t seed);
void scene_free(struct scene *scene);

/* Light as one view sees it: the environment stands in the camera's frame. */
struct scene_lighting {
	const struct envmap *env;
	const struct envmap *mirror;  // what cornea and tear film mirror: usually env; null: nothing
	int n, each;                  // each: so many neighbours go into the eye as one beam; 0 as 1
	struct envmap_light light[ENVMAP_LIGHTS_MAX];  // in the camera's frame
};
/* lights: beams; each of up to eight directions. */
/* each: so many. */
struct scene_lighting scene_lighting_of(const struct envmap *env, const struct envmap *mirror, int lights, int each);
struct scene_lighting scene_lighting(const struct envmap *env, const struct envmap *mirror, int lights);

struct scene_view {
	struct camera camera;
	double cam_from_eye[4][4];
	double slip[2][3];            // iris maps are looked up at (x, y) + slip (x, y, 1): what registration of several
	                              // photographs found beyond the pose; zero: nothing
	double x0, y0, scale;         // camera px of the picture's corner, and of one of its pixels
	int width, height;            // px
	int samples;                  // samples^2 rays where the picture has edges, at most
	bool textured;                // the photograph's colour alone, without scattering: the cheap alternative
	const unsigned char *visible; // [height][width] 1, or 0: something stands before the eye there, and it is left out; null: all
	struct scene_hits *hits;      // what rays meet is kept there and not sought again while only light changes; null: not
};

/* View of an eye turned by yaw and pitch (radians) in front of a camera that frames `field` mm at distance mm. */
struct scene_view scene_view_turned(const struct scene *scene, double yaw, double pitch, double field, int size);

/* The view of the photograph itself: a window of it (photo px) at `scale` photo px a pixel. */
struct scene_view scene_view_photo(const struct fit *fit, const double window[4], double scale);

struct scene_count {
	long rays, iris;              // traced; of them scattered in the iris
	long kept, hidden;            // first rays not traced: kept from the picture before; behind something (whole tiles)
};

/* What the rays of one view met, for a camera and an eye that stand still while lights move: about 14 bytes a pixel. Quick pictures
 * alone use it. One scene, one picture at a time. */
struct scene_hits *scene_hits_new(void);
void scene_hits_free(struct scene_hits *hits);

/* RGB and A: colour times cover, and the share of the pixel that the eye covers. image_free. The same bytes for any number of
 * threads. */
struct image scene_render(const struct scene *scene, const struct scene_view *view,
                          const struct scene_lighting *light, struct scene_count *count);

/* The converging picture: the mean of `passes`, each with the environment's `lights` directions drawn anew within their
 * regions (so that areas light as areas) and its rays drawn anew within their pixels. env stands in the camera's frame; mirror
 * as in the lighting. *error: mean relative standard error of the luminance of what is not black; null: not wanted. image_free. */
struct image scene_converge(const struct scene *scene, const struct scene_view *view, const struct envmap *env,
                            const struct envmap *mirror, int lights, int passes, double *error, struct scene_count *count);

/* Depth of the eye's outside along the camera's axis (mm; INFINITY beside the eye) and its unit normal in the camera's frame
 * (without the film's ripples). image_free. */
struct image scene_surface(const struct scene *scene, const struct scene_view *view);

/* The albedo step: fills level[].model as seen in this view, so that there the rendering shows what the photograph
 * shows (colour.c). conf.detail is its strength. Call once, after scene_load. */
void scene_fit_colour(struct scene *scene, const struct scene_view *view, const struct scene_lighting *light);

#endif
