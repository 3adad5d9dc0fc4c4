/* march: single scattering in the iris along rays of sight (iris paper, section 5.3). */
#ifndef DRAW_EYE_MARCH_MARCH_H
#define DRAW_EYE_MARCH_MARCH_H
#include "draw/eye/batch_impl.h"
#include "draw/eye/march/beam.h"

enum { PART = 64 };  // rays that march together: the data of all their nodes stays in the first-level cache

/* Finds where the rays first cross the relief: fills px..pz. */
void scene_meet(struct iris_batch *b, const struct scene *scene, const struct scene_level *level);

/* Marches: fills near, span and rgb. */
void scene_scatter(struct iris_batch *b, const struct scene *scene, const struct scene_level *level,
                   const struct scene_beams *beams);

/* The alternative to scene_scatter: the model's mean colour, lit, without a march. */
void scene_flat(struct iris_batch *b, const struct scene *scene, const struct scene_beams *beams);

/* The maps as the loops read them; depths in mm. */
struct ground {
	const float *relief;
	const int *pairs;
	int size;
	float per_mm, z_plane, z_high, z_low, abl;
};
struct ground ground_of(const struct scene *scene, const struct scene_level *level);

/* Fills near and span, the ray's length down to the epithelium, which lies the layers' thickness below the relief. */
void scene_spans(struct iris_batch *r, const struct ground *g);

/* A tissue's optics in every band: log2 of the extinction per mm (fade), log2 of the light scattered back per mm (source), and
 * its weight in linear Rec. 709 (rgb). */
struct march_tissue {
	int bands;
	float source[TISSUE_LAYERS][TISSUE_BANDS_MAX], fade[TISSUE_LAYERS][TISSUE_BANDS_MAX], rgb[3][TISSUE_BANDS_MAX];
};
struct march_tissue scene_march_tissue(const struct tissue_optics *optics);

/* One node of the quadrature on every ray of a part, independent of the light: its place between the ray's ends (u: 0..1) and
 * between the points where the light is tabulated (q), the slope of the relief there, and the length it stands for (mm).
 * In each band log2 of the transmittance of light from straight above (rise; oblique light: that over the cosine) and of the
 * light that leaves towards the camera (seen). */
struct march_node {
	float u[PART], q[PART], gx[PART], gy[PART], length[PART];
	float rise[TISSUE_BANDS_MAX][PART], seen[TISSUE_BANDS_MAX][PART];
};

/* Fills a node on n rays, from the ray `first` on, or on the rays of a tile, which read maps of pairs.
 * layer, at, weight: of the quadrature: the layer, the place in it (0..1), the weight. */
void scene_node_of_rays(int n, struct march_node *node, const struct iris_batch *r, int first, const struct ground *ground,
                        const struct march_tissue *tissue, int layer, float at, float weight);
struct march_body;
void scene_node_of_tile(struct march_node *node, const struct iris_batch *r, const struct ground *ground, const struct march_tissue *tissue,
                        const struct march_body *body, int layer, float at, float weight);

/* One light on every ray: direction towards it (beam.h) at q = 0 and the difference to q = 1; irradiance of a plane that faces it
 * at u = 0 and the difference to u = 1. scene_light_at fills in the values at both ends of the ray instead, and in fall the cosine
 * of incidence on the iris plane. open: what the limbus' shadow leaves at the near ends, of all of the ray: deep tissue is lit from the sides
 * by many scatterings, and the shadow's edge lies where it falls on the surface. */
struct march_light {
	float x[2][PART], y[2][PART], z[2][PART], power[2][PART], fall[2][PART], open[PART];
};

/* Looks up the light at n points, the ends `end` (0, then 1) of the rays. */
void scene_light_at(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                    const struct scene *scene, const struct scene_beam *beam);

/* The lights of one beam, in the eye's frame. */
struct beam_lights {
	int n;
	float dir[ENVMAP_LIGHTS_MAX][3], rgb[ENVMAP_LIGHTS_MAX][3], share[ENVMAP_LIGHTS_MAX];
};

/* scene_lights_turn: those directions of a lighting from which light can enter the eye, in the eye's frame.
 * scene_lights_split: splits in[0] into at most `most` beams, the widest first; returns their number. */
void scene_lights_turn(struct beam_lights *in, const struct scene_lighting *light, const double eye_from_cam[3][3]);
int scene_lights_split(struct beam_lights *in, int most);

/* All channels of a table's node as one vector. */
typedef float way_vector __attribute__((vector_size(4 * SCENE_WAY), aligned(4), may_alias));

/* All channels of a beam's table at a point of the eye, trilinear. */
void scene_table_at(float way[SCENE_WAY], const struct scene_beam *beam, const float point[3], float extent);

/* Share of a light that is seen over a horizon `clear` (slope) below it; the light is LOOK_SOURCE wide. A shadow is not black:
 * lit tissue around it fills it in by LOOK_FILL. */
#define SCENE_SOURCE ((float)LOOK_SOURCE)
SIMD_INLINE float scene_shadow_open(float clear)
{
	float t = clear * (1 / SCENE_SOURCE);
	return (float)LOOK_FILL + (float)(1 - LOOK_FILL) * (t > 0 ? t < 1 ? t : 1 : 0);
}

/* Horizons of 8 x 8 texels, in HORIZONS azimuths. */
enum { TILE_SIDE = 8, HORIZONS = 16 };
struct march_horizon {
	float steepest[HORIZONS];     // of its texels
	float slope[HORIZONS][PART];  // of the relief's horizon, by azimuth
};

/* Eight by eight texels of a level, as one part: corner and step between texels, mm; column and row of the tile. */
struct march_tile {
	float x, y, step;
	int tx, ty;
	const struct march_horizon *horizon;  // null: no shadows
};
_Static_assert(TILE_SIDE * TILE_SIDE == PART, "a tile is a part");

/* The slanted box that a tile's rays pass through (their span is filled): its near face at the mean depth of the relief, its far
 * face displaced by the mean ray. */
struct march_body {
	const struct march_tile *tile;
	float z, over[3];  // depth of the near face; from it to the far one
	float q[2][PART];  // where each ray's ends lie between the two faces
	int node[8];       // node of the beams' tables below each corner; corners by x first, then y, then depth
	float of_near[8][4], of_far[8][4];  // weights of that node and its three neighbours on either plane
};
void scene_body_make(struct march_body *body, const struct iris_batch *rays, const struct march_tile *tile, const struct scene *scene);

/* The light on a tile's rays: read from the table at the corners of their body, linear between these, dimmed by the relief's
 * shadow. Returns false when none reaches the tile. */
bool scene_light_tile(struct march_light *light, const struct march_body *body, const struct scene *scene, const struct scene_beam *beam);

/* For the rays of sight that begin at a tile's texels: fills pz, near and span from maps of pairs. */
void scene_tile_ground(struct iris_batch *r, const struct march_tile *tile, const struct scene *scene, const struct scene_level *level);

/* Marches the 64 rays that begin at a tile's texels: fills pz, near, span and rgb. */
void scene_scatter_tile(struct iris_batch *r, const struct march_tile *tile, const struct scene *scene, const struct scene_level *level,
                        const struct scene_beams *beams, const struct march_tissue *tissue);

/* The horizons of all tiles of a level. free(). */
struct march_horizon *scene_horizons(const struct scene *scene, const struct scene_level *level);

/* Dims the light at n points by the relief that stands before it: the steepest slope at `steps` places towards the light. */
void scene_shadow(struct march_light *light, int n, const float *x, const float *y, const float *z,
                  const struct ground *ground, int steps);

#endif
