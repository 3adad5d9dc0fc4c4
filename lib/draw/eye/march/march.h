/* scene_march: single scattering along rays of sight; between meet.c, light.c, march.c, shadow.c. */
#ifndef DRAW_EYE_MARCH_MARCH_H
#define DRAW_EYE_MARCH_MARCH_H
#include "draw/eye/batch_impl.h"
#include "draw/eye/march/beam.h"

enum { PART = 64 };  // rays that march together: what is known of all their nodes stays in the first cache

/* Fills px..pz: the first crossing of the relief. */
void scene_meet(struct iris_batch *b, const struct scene *scene, const struct scene_level *level);

/* Fills near, span and rgb. */
void scene_scatter(struct iris_batch *b, const struct scene *scene, const struct scene_level *level,
                   const struct scene_beams *beams);

/* The alternative to scatter: the mean colour of the model, lit, without a march. */
void scene_flat(struct iris_batch *b, const struct scene *scene, const struct scene_beams *beams);

/* What the loops read of the maps. */
struct ground {
	const float *relief;
	const int *pairs;
	int size;
	float per_mm, z_plane, z_high, z_low, abl;
};
struct ground ground_of(const struct scene *scene, const struct scene_level *level);

/* Fills near and span: down to the epithelium, which lies the layers' thickness below the relief. */
void scene_spans(struct iris_batch *r, const struct ground *g);

/* What a tissue makes of light, in every band: fade per mm, log2; log2 of what it scatters back per mm; what that adds to a
 * colour. */
struct march_tissue {
	int bands;
	float source[TISSUE_LAYERS][TISSUE_BANDS_MAX], fade[TISSUE_LAYERS][TISSUE_BANDS_MAX], rgb[3][TISSUE_BANDS_MAX];
};
struct march_tissue scene_march_tissue(const struct tissue_optics *optics);

/* A node of the quadrature, on every ray of a part, whatever the light: its place between the ray's ends (u: 0..1) and between
 * where its light is known (q), slope of the relief there, and the length it stands for; log2 of what is left in a band of light
 * that comes from straight above (rise; from aside, that over the cosine), and of what goes to the beholder (seen). */
struct march_node {
	float u[PART], q[PART], gx[PART], gy[PART], length[PART];
	float rise[TISSUE_BANDS_MAX][PART], seen[TISSUE_BANDS_MAX][PART];
};

/* Layer and place (at: 0..1 of it, weight) of the quadrature on n rays from the first on, or on a tile's, read from its maps. */
void scene_node_of_rays(int n, struct march_node *node, const struct iris_batch *r, int first, const struct ground *ground,
                        const struct march_tissue *tissue, int layer, float at, float weight);
struct march_body;
void scene_node_of_tile(struct march_node *node, const struct iris_batch *r, const struct ground *ground, const struct march_tissue *tissue,
                        const struct march_body *body, int layer, float at, float weight);

/* One light on every ray: direction towards it (beam.c) at q = 0 and what it changes by to q = 1, irradiance of a plane that
 * faces it at u = 0 and what it changes by to u = 1. From scene_light_at: at both ends of the ray; fall: what of it falls on the
 * iris plane. */
struct march_light {
	float x[2][PART], y[2][PART], z[2][PART], power[2][PART], fall[2][PART];
};

/* The light at n points, into end `end` (0, 1) of its rays. */
void scene_light_at(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                    const struct scene *scene, const struct scene_beam *beam);

/* The lights of one beam, in the eye's frame. */
struct beam_lights {
	int n;
	float dir[ENVMAP_LIGHTS_MAX][3], rgb[ENVMAP_LIGHTS_MAX][3], share[ENVMAP_LIGHTS_MAX];
};

/* A lighting's directions that come from before the eye. Then split, the widest first, until there are `most` beams; returns
 * their number. */
void scene_lights_turn(struct beam_lights *in, const struct scene_lighting *light, const double eye_from_cam[3][3]);
int scene_lights_split(struct beam_lights *in, int most);

/* All channels of a node as one vector. */
typedef float way_vector __attribute__((vector_size(4 * SCENE_WAY), aligned(4), may_alias));

/* All channels of a beam's table at a point. */
void scene_table_at(float way[SCENE_WAY], const struct scene_beam *beam, const float point[3], float extent);

/* Share of the light that comes in over a horizon which lies `clear` (slope) below it. A shadow is not
 * black: tissue that stands around it in the light fills it in. */
#define SCENE_SOURCE ((float)LOOK_SOURCE)
SIMD_INLINE float scene_shadow_open(float clear)
{
	float t = clear * (1 / SCENE_SOURCE);
	return (float)LOOK_FILL + (float)(1 - LOOK_FILL) * (t > 0 ? t < 1 ? t : 1 : 0);
}

/* Eight by eight texels of a level, as one part: corner, step between texels, mm; which one it is. */
enum { TILE_SIDE = 8, HORIZONS = 16 };
struct march_horizon {
	float steepest[HORIZONS];     // of its texels
	float slope[HORIZONS][PART];  // under which the relief hides the sky, by azimuth
};
struct march_tile {
	float x, y, step;
	int tx, ty;
	const struct march_horizon *horizon;  // null: no shadows
};
_Static_assert(TILE_SIDE * TILE_SIDE == PART, "a tile is a part");

/* The body that a tile's rays go through (span filled): its relief's middle, and sheared by their mean to where they end. */
struct march_body {
	const struct march_tile *tile;
	float z, over[3];  // depth of the near face; from it to the far one
	float q[2][PART];  // where each ray's ends lie between the two
	int node[8];       // of the beams' tables, below each corner: x first, then y, then depth
	float of_near[8][4], of_far[8][4];  // weights of that and the next ones there
};
void scene_body_make(struct march_body *body, const struct iris_batch *rays, const struct march_tile *tile, const struct scene *scene);

/* The light on a tile's rays: the table's at the corners of their body, linear between these; dimmed by the relief's
 * shadow. False: none comes here. */
bool scene_light_tile(struct march_light *light, const struct march_body *body, const struct scene *scene, const struct scene_beam *beam);

/* The rays of sight that begin at a tile's texels, on maps of pairs: fills pz, near and span. */
void scene_tile_ground(struct iris_batch *r, const struct march_tile *tile, const struct scene *scene, const struct scene_level *level);

/* Fills pz, near, span and rgb of the 64 rays that begin at a tile's texels. */
void scene_scatter_tile(struct iris_batch *r, const struct march_tile *tile, const struct scene *scene, const struct scene_level *level,
                        const struct scene_beams *beams, const struct march_tissue *tissue);

/* Horizons of a level's tiles. free(). */
struct march_horizon *scene_horizons(const struct scene *scene, const struct scene_level *level);

/* Dims the light by the share of it that the relief between it and the points hides. */
void scene_shadow(struct march_light *light, int n, const float *x, const float *y, const float *z,
                  const struct ground *ground, int steps);

#endif
