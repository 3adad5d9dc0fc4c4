/* scene_impl: what the files of the scene share among themselves. Rays come in batches, one array for each
 * coordinate, so that the loops over them become vector code. */
#ifndef DRAW_EYE_IMPL_H
#define DRAW_EYE_IMPL_H
#include "draw/eye/scene.h"
#include "draw/eye/look.h"
#include "math/simd.h"

enum { BATCH = 256 };

/* Rays of sight inside the eye, and what they meet. */
struct iris_batch {
	int n;
	float fx[BATCH], fy[BATCH], fz[BATCH];  // where the ray starts behind the cornea
	float vx[BATCH], vy[BATCH], vz[BATCH];  // its unit direction
	float px[BATCH], py[BATCH], pz[BATCH];  // where it meets the relief
	float near[BATCH], span[BATCH];         // length in the anterior border layer; in both layers
	float rgb[3][BATCH];                    // scattered towards the beholder; a white plane = 1
};

/* One light in the eye's frame, or several neighbours (draw/eye/march/beam.c), with its own refraction function over the iris, on planes
 * at the depths z[0] and z[1]: direction towards it, irradiance of a plane that faces it, where on the cornea its light
 * came in (1: at the limbus), and what of the irradiance falls on the iris plane. */
enum { SCENE_PATH_STEPS = 4 };  // Newton's, from the closed-form start: 2e-5 mm at worst
enum { SCENE_WAY = 8 };  // six, and room for a whole vector
enum { SCENE_FLAT = 64 };  // texels of flat light, across
enum { SCENE_COARSE = 24 };  // several lights together are smooth: a coarser grid, and cubics (Catmull and Rom's) between
struct scene_beam {
	float dir[3], rgb[3];
	float z[2];
	float way[2][SCENE_GRID][SCENE_GRID][SCENE_WAY];
};

struct scene_beams {
	int n;
	struct scene_beam *beam;  // owned
};

/* Limbus, sclera and cornea of s->eye. */
void scene_geometry(struct scene *scene);

/* Where nothing was fitted: the stroma's thickness, mm, and a tissue; the march's steps. */
extern const double scene_plain_stroma;
void scene_plain_tissue(struct scene *scene);

/* Depths of the planes between which all of the iris lies, mm. */
void scene_planes(double z[2], const struct scene *scene);

/* The lights that reach the iris, for one view. free(beams.beam). */
struct scene_beams scene_beams(const struct scene *scene, const struct scene_lighting *light,
                               const double eye_from_cam[3][3]);

/* Fills px..pz: the first crossing of the relief. */
void scene_meet(struct iris_batch *b, const struct scene *scene, const struct scene_level *level);

/* Fills near, span and rgb. */
void scene_scatter(struct iris_batch *b, const struct scene *scene, const struct scene_level *level,
                   const struct scene_beams *beams);

/* The alternative to scatter: the mean colour of the model, lit, without a march. */
void scene_flat(struct iris_batch *b, const struct scene *scene, const struct scene_beams *beams);

/* What is seen of the iris' colour at a point near the pupil's margin: none inside, less on the ruff. soft: half a pixel, mm. */
void scene_pupil(float cover[3], const struct scene *scene, float x, float y, float soft);

/* Heights in a level's pairs are multiples of that, mm. marched: with its bottom. */
#define SCENE_PAIR_MM (1.0f / 32768)
#define SCENE_PAIR_STRIDE(n) ((n) + 16)
void scene_pairs_make(struct scene_level *level, bool marched);

/* Packs [n][n][4]; negatives become 0. Frees what *out had. */
void scene_texels_make(struct scene_texels *out, const float *rgba, int n);

/* Fills a level's shown and bare. */
void scene_shown_make(struct scene_level *level, const struct scene *scene);

/* The way from points of the iris out to a camera at C, as if it were a light. free(). */
struct scene_beam *scene_sight(const struct scene *scene, const double C[3]);

/* The iris as one view shows it: detail times light, both bilinear. */
struct scene_shade {
	int light_n, light_stride;
	float per_mm, light_per_mm;  // texels in a mm: of detail, of light
	const struct scene_texels *detail;  // of the scene's: what a photograph shows and the march does not
	float *light;                // [light_n][light_stride][4]: the march from these texels; owned
	bool even;                   // light is that of a flat iris: smooth
};

/* Levels finer than that are not marched from. */
int scene_marched(const struct scene *scene);

/* For a camera at C whose pixels are about as large as the texels of `level`: the march from every second texel. free(shade.light). */
struct scene_shade scene_shade_make(const struct scene *scene, const struct scene_level *level, const double C[3], const struct scene_beams *beams);

/* The alternative: light on the photograph's colours alone, without beams. The scene has paths. */
struct scene_shade scene_shade_flat(const struct scene *scene, const struct scene_level *level, const struct scene_lighting *light, const double eye_from_cam[3][3]);

/* Fills the model of a level with the march from its own texels, times through: what a later march from them is compared with. */
void scene_shade_model(struct scene_level *level, const struct scene *scene, const double C[3], const struct scene_beams *beams, float through);

#define SCENE_DARK 1e-4f  // colours are at least that, so that their ratios are numbers

/* The level whose texels are about as large as a pixel of `mm`. */
const struct scene_level *scene_level_for(const struct scene *scene, double mm);

/* The model's colour at a point of the iris (in) made the photograph's (out). */
void scene_colour(float rgb[3], const struct scene *scene, const struct scene_level *level, float x, float y);

/* What that is without the photograph's colour, at n points. per_model: 1 over what the model showed there, by channel. */
void scene_colour_ratio(int n, float rgb[3][BATCH], const struct scene *scene, const float *const per_model[3]);

/* Where the march's steps lie and what they weigh, for this tissue and thickness. */
void scene_nodes_make(struct scene *scene);

/* Gauss's rule of n points, at most SCENE_EXPONENTIAL_MAX, on 0..1 for what fades as exp(-c x), c at most SCENE_FADE_MAX; one
 * in SCENE_SHARE of the steps goes to the anterior layer. */
enum { SCENE_EXPONENTIAL_MAX = 12, SCENE_FADE_MAX = 40, SCENE_SHARE = 4 };
void scene_exponential(int n, double c, double node[], double weight[]);

/* Mean thickness of a layer, mm. */
double scene_thickness(const struct scene *scene, int layer);

/* Levels below level 0, and the range of heights. */
void scene_levels_make(struct scene *scene);

/* RGB [n][n][4] with weight in A (0: no photograph saw it): what is missing is continued round the axis from what was
 * seen at the same radius, so that fibres go on. pupil: x, y, radius. */
void scene_fill(float *rgba, int n, double extent, const double pupil[3]);

#define SCENE_FILM_INDEX ((float)LOOK_FILM_INDEX)

/* Maps of the sclera are azimuthal and equidistant about the axis: angle at the sphere's centre at their edge. */
#define SCENE_SCLERA_REACH (110 * M_PI / 180)
void scene_veins_make(struct scene *scene);

/* What a vessel that lies so deep in the tissue leaves of its light: of what comes back from beyond that depth (diffusion without
 * absorption: 1 / (1 + 3/4 mu_s' depth)) its blood takes what it absorbs on two ways through a cylinder. mm; oxygen 0..1. */
void scene_vessel(float left[3], double depth, double width, double oxygen);

/* Albedo of the sclera and the ripple of its film at a point of it. */
void scene_sclera(float albedo[3], float normal[3], const struct scene *scene, const float point[3]);

/* Bilinear: value and gradient (per mm) of the height, and the thickness, clamped to the map. */
SIMD_INLINE float relief_at(const float *map, int n, float per_mm, float x, float y, float *gx, float *gy)
{
	float h = 0.5f * (float)n - 0.5f, top = (float)n - 1.001f;
	float u = x * per_mm + h, v = y * per_mm + h;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v, at = 2 * (iv * n + iu);
	u -= (float)iu;
	v -= (float)iv;
	float a = map[at], b = map[at + 2], c = map[at + 2 * n], d = map[at + 2 * n + 2];
	*gx = ((1 - v) * (b - a) + v * (d - c)) * per_mm;
	*gy = ((1 - u) * (c - a) + u * (d - b)) * per_mm;
	return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

SIMD_INLINE float channel_at(const float *map, int n, float per_mm, float x, float y, int channels, int channel)
{
	float h = 0.5f * (float)n - 0.5f, top = (float)n - 1.001f;
	float u = x * per_mm + h, v = y * per_mm + h;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v, at = channels * (iv * n + iu) + channel;
	u -= (float)iu;
	v -= (float)iv;
	return (1 - v) * ((1 - u) * map[at] + u * map[at + channels])
	       + v * ((1 - u) * map[at + channels * n] + u * map[at + channels * n + channels]);
}

static inline float smooth(float lo, float hi, float x)
{
	float t = (x - lo) / (hi - lo);
	t = t > 0 ? t < 1 ? t : 1 : 0;
	return t * t * (3 - 2 * t);
}

#endif
