/* scene_march: single scattering along rays of sight; between scene_meet.c, scene_light.c, scene_march.c, scene_shadow.c. */
#ifndef EYE_SCENE_MARCH_H
#define EYE_SCENE_MARCH_H
#include "eye/scene_impl.h"

enum { PART = 64 };  // rays that march together: what is known of all their nodes stays in the first cache

/* What the loops read of the maps. */
struct ground {
	const float *relief;
	int size;
	float per_mm, z_plane, z_high, z_low, abl;
};
struct ground ground_of(const struct scene *scene, const struct scene_level *level);

/* Fills near and span: down to the epithelium, which lies the layers' thickness below the relief. */
void scene_spans(struct iris_batch *r, const struct ground *g);

/* A node of the quadrature, on every ray of a part, whatever the light: its place between the ray's ends (0..1), slope of
 * the relief there, tissue above it and towards the beholder (mm, of each layer), and the length it stands for. */
struct march_node {
	float u[PART], gx[PART], gy[PART], above[TISSUE_LAYERS][PART], seen[TISSUE_LAYERS][PART], length[PART];
};

/* One light at both ends of every ray: direction towards it (scene_beam.c), irradiance of a plane that faces it; fall: what of
 * it falls on the iris plane (scene_light_at alone). */
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
};
void scene_body_make(struct march_body *body, const struct iris_batch *rays, const struct march_tile *tile);

/* The light on a tile's rays: the table's at the corners of their body, linear between these; dimmed by the relief's
 * shadow. False: none comes here. */
bool scene_light_tile(struct march_light *light, const struct march_body *body, const struct scene *scene, const struct scene_beam *beam);

/* The rays of sight that begin at a tile's texels, on maps of pairs: fills pz, near and span; a node of the quadrature on them. */
void scene_tile_ground(struct iris_batch *r, const struct march_tile *tile, const struct scene *scene, const struct scene_level *level);
void scene_tile_node(struct march_node *node, const struct iris_batch *r, const struct scene *scene, const struct scene_level *level, int layer, int k);

/* Fills pz, near, span and rgb of the 64 rays that begin at a tile's texels. */
void scene_scatter_tile(struct iris_batch *r, const struct march_tile *tile, const struct scene *scene,
                        const struct scene_level *level, const struct scene_beams *beams);

/* Without a march: the model's mean colour at n <= PART points, lit. */
void scene_flat_at(float *const rgb[3], int n, const float *x, const float *y, const float *z, const struct scene *scene, const struct scene_beams *beams);

/* Horizons of a level's tiles. free(). */
struct march_horizon *scene_horizons(const struct scene *scene, const struct scene_level *level);

/* Dims the light by the share of it that the relief between it and the points hides. */
void scene_shadow(struct march_light *light, int n, const float *x, const float *y, const float *z,
                  const struct ground *ground, int steps);

#endif
