/* quick: a picture whose march has been done already (march/shade.h): geometry in vectors, colours looked up. */
#ifndef DRAW_EYE_QUICK_QUICK_H
#define DRAW_EYE_QUICK_QUICK_H
#include "draw/eye/march/shade.h"
#include "draw/eye/quick/map.h"
#include "draw/eye/view.h"

/* Rays that start a little before the eye, where float is precise enough for a texel. Eye's frame. */
struct quick_rays {
	int n;
	float ox[BATCH], oy[BATCH], oz[BATCH];  // mm
	float dx[BATCH], dy[BATCH], dz[BATCH];  // unit
};

/* Where rays meet the outside of the eye, and how they go on behind the cornea. */
struct quick_spots {
	float hit[BATCH];                              // 1 or 0
	float nx[BATCH], ny[BATCH], nz[BATCH];         // unit normal
	float rho[BATCH], lid[BATCH];                  // rho: 1 on the limbus; lid: share of the sclera, 1 white
	float su[BATCH], sv[BATCH];                    // place in the maps of the sclera, -0.5..0.5
	float fx[BATCH], fy[BATCH], fz[BATCH], vx[BATCH], vy[BATCH], vz[BATCH];  // behind the cornea
	float iu[BATCH], iv[BATCH];                    // place on the iris, mm
	float mirror[BATCH], rough[BATCH], eu[BATCH], ev[BATCH];  // Fresnel; place on the environment's octahedron, -1..1
	float sky[3][BATCH];                           // irradiance over pi, as the sclera has it
};

struct quick_quadric {
	float R, p, apex, m2;  // m2: squared ratio of the indices, less 1
};

/* What all rays of a view share. */
struct quick_look {
	const struct scene *scene;
	const struct scene_lighting *light;
	const struct scene_shade *shade;
	const struct scene_level *level;  // of the relief
	const struct scene_level *smooth; // of the relief about as coarse as nodes
	struct quick_quadric front, back;
	bool two;
	float rim2, index;
	float sphere_z, sphere_r, limbus[2], lid_width;
	float cam_from_eye[3][3], slip[2][3];
};
struct quick_look quick_look(const struct scene *scene, const struct scene_view *view, const struct scene_lighting *light, const struct scene_shade *shade, const struct scene_level *level);

/* What a tile shows. In tiles that are not mixed only maps vary fast: those of the iris, the sclera, or both. */
enum quick_kind { QUICK_MIXED, QUICK_CORNEA, QUICK_SCLERA, QUICK_LIMBUS };

/* A tile's nodes: every eighth pixel of its 16 x 16 and of the next ones, three by three. */
enum { QUICK_TILE = 16, NODE_STEP = 8, NODE_SIDE = 3, NODES_IN_TILE = 9, NODE_LANES = 16 };

/* A tile that is not mixed: at its nodes as in quick_spots; place: where its pixels look on the iris, mm. */
struct quick_nodes {
	float nx[NODE_LANES], ny[NODE_LANES], nz[NODE_LANES], rho[NODE_LANES], mirror[NODE_LANES], rough[NODE_LANES];
	float eu[NODE_LANES], ev[NODE_LANES], iu[NODE_LANES], iv[NODE_LANES], wu[NODE_LANES], wv[NODE_LANES];
	float place[2][BATCH];
};

/* Channels that are interpolated between nodes: where rays behind the cornea cross the iris plane, how far aside they go in a mm of
 * depth, and the height of the relief there. */
enum { NODE_U, NODE_V, NODE_ASIDE, NODE_ACROSS, NODE_HEIGHT, NODE_CHANNELS };

/* What the rays of a tile meet: geometry alone, found once; colours are read from it. */
struct quick_found {
	enum quick_kind kind;
	int seen, hit, white;      // rays that see the iris, anything, the sclera
	struct quick_nodes nodes;
	struct quick_spots spots;  // mixed: normals before the film has bent them
	float bent[3][BATCH];      // and after
	float between[NODE_CHANNELS][NODE_LANES];  // of a tile's iris: input of quick_grid_pixels
};

/* Newton's steps for the height h at which a ray that crosses the iris plane at (u, v) meets a level's relief, from a start h. */
SIMD_INLINE float quick_meet(float h, float u, float v, float aside, float across, const struct scene_level *level, float least, float most, int steps)
{
#pragma GCC unroll 3
	for (int j = 0; j < steps; j++) {
		float gx, gy, off = quick_height_at(level->pairs, level->n, level->per_mm, u - h * aside, v - h * across, &gx, &gy) - h;
		float slope = 1 + gx * aside + gy * across;
		h = quick_clamp(h + off / (slope > 0.3f ? slope : 0.3f), least, most);
	}
	return h;
}

/* Steps for a batch of rays, in this order: where they meet the outside; normals bent by the film; places on the iris (if any ray sees
 * it); reflected directions in the camera's frame and Fresnel; those unfolded onto the environment's octahedron (x, y). quick_sclera:
 * diffuse light on the white. */
void quick_outside(struct quick_spots *spots, const struct quick_rays *rays, const struct quick_look *look);
void quick_bend(struct quick_found *found, int n, const struct quick_look *look);
void quick_iris(struct quick_spots *spots, const struct quick_rays *rays, const struct quick_look *look);
void quick_reflect(float *x, float *y, float *z, struct quick_found *found, const struct quick_rays *rays, const struct quick_look *look);
void quick_unfold(int n, float *x, float *y, const float *z);
void quick_sclera(float sky[3][BATCH], int n, const float *nx, const float *ny, const float *nz, const float *rho, const struct quick_look *look);

/* Bilinear interpolation from nodes to all 256 pixels of a tile. */
void quick_lay(float *out, const float node[NODE_LANES]);

/* Neighbouring tiles share the rays at their nodes: three rows of nodes, followed at once. */
enum { STRIP_TILES = 40 };
_Static_assert(NODE_SIDE * (STRIP_TILES * (NODE_SIDE - 1) + 1) <= BATCH, "a strip's nodes are one batch");

enum { NODE_FACES = 1, NODE_IN = 2, NODE_OUT = 4, NODE_THROUGH = 8, NODE_STRAIGHT = 16 };

struct quick_strip {
	int across;                              // nodes in a row
	float far;                               // |dx| + |dy| + |dz| from a tile's first node to its last, mm before the eye
	unsigned char is[BATCH];                 // NODE_... flags: the kinds of tile that each node allows
	struct quick_found found;                // spots and bent, of the nodes
	float between[NODE_CHANNELS][BATCH];     // where a node may see the iris
};

/* Follows the rays at the nodes of 1..STRIP_TILES tiles; x, y: middle of the first tile's first pixel. make: fills rays through points
 * of the picture. */
typedef void quick_make(struct quick_rays *rays, const float *x, const float *y, const void *ctx);
void quick_strip(struct quick_strip *strip, float x, float y, int tiles, quick_make *make, const void *ctx, const struct quick_look *look);

/* Finds a tile of a strip from the rays at its nodes. False: it is mixed, and every ray must be followed (quick_find). */
bool quick_grid(struct quick_found *found, const struct quick_strip *strip, int tile, const struct quick_look *look);

/* Then intersects all its pixels' rays with the relief. */
void quick_grid_pixels(struct quick_found *found, const struct quick_look *look);

/* Prefetches the parts of the maps that a tile will read. */
void quick_ask(const struct quick_found *found, const struct quick_look *look);

/* Finds a tile by every ray. */
void quick_find(struct quick_found *found, const struct quick_rays *rays, const struct quick_look *look);

/* Colours of n rays, premultiplied RGBA. */
void quick_colour(float rgba[][4], struct quick_found *found, int n, const struct quick_look *look);

/* Colours of a tile that is not mixed, into rows `stride` pixels apart. */
void quick_tile_colour(float *out, long stride, struct quick_found *found, const struct quick_look *look);

#endif
