/* scene_quick: a picture whose march has been done already (scene_shade_make): geometry in vectors, colours looked up. */
#ifndef EYE_SCENE_QUICK_H
#define EYE_SCENE_QUICK_H
#include <stdint.h>

#include "eye/scene_impl.h"

/* Rays that start a little before the eye, where float has all the digits that a texel needs. */
struct quick_rays {
	int n;
	float ox[BATCH], oy[BATCH], oz[BATCH];  // mm
	float dx[BATCH], dy[BATCH], dz[BATCH];  // unit
};

/* Where they end on the outside of the eye, and how they go on behind the cornea. */
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
	struct quick_quadric front, back;
	bool two;
	float rim2, index;
	float sphere_z, sphere_r, limbus[2], lid_width;
	float cam_from_eye[3][3], slip[2][3];
	float sky[3][9];                  // irradiance as a polynomial of the eye's normal: 1 x y z xy yz zz xz xx-yy
	float even[3];                    // its mean
};
struct quick_look quick_look(const struct scene *scene, const struct scene_view *view, const struct scene_lighting *light, const struct scene_shade *shade, const struct scene_level *level);

/* What a tile shows: everything, or nothing that changes fast within it but maps. */
enum quick_kind { QUICK_MIXED, QUICK_CORNEA, QUICK_SCLERA };

/* Where the rays end, once: what they see is found in it. Cornea, sclera: as of 256 rays, but normals, rho of the nodes. */
struct quick_found {
	struct quick_spots spots;  // normals before the film has bent them
	enum quick_kind kind;
	int seen, hit, white;      // rays that see the iris, anything, the sclera
	float bent[3][BATCH];      // normals after
};

/* Bilinear height from pairs of neighbours in one word. */
SIMD_INLINE float quick_height_at(const int *map, int n, float per_mm, float x, float y, float *gx, float *gy)
{
	float h = 0.5f * (float)n - 0.5f, top = (float)n - 1.001f, u = x * per_mm + h, v = y * per_mm + h;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v, at = iv * n + iu, p = map[at], q = map[at + n];
	u -= (float)iu;
	v -= (float)iv;
	float a = (float)(int16_t)p, b = (float)(p >> 16), c = (float)(int16_t)q, d = (float)(q >> 16);
	float top_row = a + u * (b - a), low_row = c + u * (d - c);
	*gx = ((b - a) + v * ((d - c) - (b - a))) * (per_mm * SCENE_PAIR_MM);
	*gy = (low_row - top_row) * (per_mm * SCENE_PAIR_MM);
	return (top_row + v * (low_row - top_row)) * SCENE_PAIR_MM;
}

/* In this order; quick_iris where something of the iris is seen, sclera where something white is; reflect into the camera's
 * frame, then unfolded (x, y) onto the octahedron. */
void quick_outside(struct quick_spots *spots, const struct quick_rays *rays, const struct quick_look *look);
void quick_bend(struct quick_found *found, int n, const struct quick_look *look);
void quick_iris(struct quick_spots *spots, const struct quick_rays *rays, const struct quick_look *look);
void quick_reflect(float *x, float *y, float *z, struct quick_found *found, const struct quick_rays *rays, const struct quick_look *look);
void quick_unfold(int n, float *x, float *y, const float *z);
void quick_sclera(struct quick_spots *spots, int n, const struct quick_look *look);

/* A tile's nodes: every fourth pixel of its 16 x 16 and of the next ones, in rows of eight of which five count. */
enum { QUICK_TILE = 16, GRID_STEP = 4, GRID_SIDE = 5, GRID_ROW = 8, GRID_NODES = GRID_SIDE * GRID_ROW, GRID_LAST = GRID_NODES - GRID_ROW + GRID_SIDE - 1 };
enum { GRID_U, GRID_V, GRID_RX, GRID_RY, GRID_RZ, GRID_MIRROR, GRID_ASIDE, GRID_ACROSS, GRID_HEIGHT, GRID_ROUGH = GRID_ASIDE, GRID_CHANNELS = GRID_HEIGHT + 1 };

/* The 256 pixels from their nodes. */
void quick_lay(float *out, const float node[GRID_NODES]);

/* Finds a tile by the rays at its nodes. False: something in it wants every ray. */
bool quick_grid(struct quick_found *found, const struct quick_rays *nodes, const struct quick_look *look);

/* Finds it by every ray. */
void quick_find(struct quick_found *found, const struct quick_rays *rays, const struct quick_look *look);

/* Makes hits those of this view: empty, where they were another's. Then one tile's; *kept: it has been found before. */
void scene_hits_for(struct scene_hits *hits, const struct scene *scene, const struct scene_view *view, int tiles);
struct quick_found *scene_hits_tile(struct scene_hits *hits, int tile, bool *kept);

/* Colours of n rays. */
void quick_colour(float rgba[][4], struct quick_found *found, int n, const struct quick_look *look);

#endif
