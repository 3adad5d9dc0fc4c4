/* impl: what the files of a portrait share. Samples of a picture are a grid `samples` times finer than its pixels. */
#ifndef DRAW_FACE_IMPL_H
#define DRAW_FACE_IMPL_H
#include "draw/face/parts.h"

/* The surface that a sample of the picture shows. */
struct portrait_spot {
	int face;      // of the mesh; -1: nothing, -2 and -3: the left and right eye
	float depth;   // along the camera's axis, mm
};

/* raster.c: the nearest surface at every sample, hairs left out: [height samples][width samples]. free(). */
struct portrait_spot *portrait_raster(const struct portrait *portrait, const struct portrait_view *view, int samples);

/* Hairs before a sample's surface: the nearest one's face (-1: none), its depth, and the share of the light from behind that they let through. */
struct portrait_veil {
	int face;
	float depth, through;
};
struct portrait_veils {
	long *at;                    // [height][width] where a pixel's samples are, -1: no hair is in it. Owned
	struct portrait_veil *veil;  // [...][samples][samples]. Owned
};
struct portrait_veils portrait_veils_of(const struct portrait *portrait, const struct portrait_view *view, struct portrait_spot *spots, int samples);
void portrait_veils_free(struct portrait_veils *veils);

/* Value noise in -1..1 at a point p of the skin at rest (mm); per_mm: cells in a mm. */
float portrait_noise(const float p[3], float per_mm);

/* light.c: the environment by at most n directions, in the rig's axes; returns how many. */
struct portrait_rays;
int portrait_lights(struct envmap_light light[], int n, const struct portrait *portrait, const struct portrait_rays *rays);

/* The environment's directions in the rig's axes. */
struct portrait_sky {
	int n;
	float detail;  // 0..1: how far pixels of the view resolve pores
	float pixel_mm;  // width of a pixel of the view at the character's distance
	float rig_from_cam[3][3];
	struct envmap_light light[ENVMAP_LIGHTS_MAX];  // in the rig's axes
};
/* Light that skin sends from where a ray meets it between from and to (mm), over pi: its albedo times light [rig.n], in the shade of hairs. False: there is none. */
bool portrait_skin_light(float rgb[3], const struct portrait *portrait, const float (*light)[3], const float at[3], const float dir[3], float from, float to);

/* shade.c: colour of the point of a face that the ray from origin along dir (unit) meets. light: irradiance there; null:
 * interpolated from the vertices. */
void portrait_shade(float rgb[3], const struct portrait *portrait, const struct portrait_sky *sky, int face,
                    const float origin[3], const float dir[3], const float *light);

/* cut.c: texture coordinates of the point of a dressed face with those barycentric weights. */
void portrait_uv_at(float uv[2], const struct portrait_mesh *mesh, int face, const float w[3]);

/* Whether the character's textures leave nothing of such a point. */
bool portrait_cut_away(const struct portrait *portrait, int face, const float w[3]);

/* Unit normal of such a point, without folds and pores; of a hair the ribbon's. */
void portrait_normal(float normal[3], const struct portrait *portrait, int face, const float origin[3], const float dir[3]);

/* Irradiance of such a point, in the shade of hairs, before skin spreads it. */
void portrait_bare_light(float rgb[3], const struct portrait *portrait, int face, const float origin[3], const float dir[3]);
struct portrait_sky portrait_sky_of(const struct portrait *portrait, const struct portrait_view *view);

/* glow.c: irradiance of the skin at the middle of every pixel, after subsurface scattering. */
struct portrait_glow {
	int width, height;
	float *rgb[3], *depth;  // [height][width]; depth (mm of the rig) 0: no skin there. Owned
	float scale;            // the camera's unit in one of the rig's
};
struct portrait_glow portrait_glow_of(const struct portrait *portrait, const struct portrait_view *view, const struct portrait_spot *spots,
                                      int samples);
/* Irradiance at a point of the picture (px) on skin at that depth (the camera's unit), interpolated from neighbouring pixels that
 * show the same surface. False: none does. */
bool portrait_glow_at(float rgb[3], const struct portrait_glow *glow, double x, double y, float depth);
void portrait_glow_free(struct portrait_glow *glow);

/* wrinkle.c. portrait_fold_pose: the maps' strengths in a pose. portrait_fold: bends the normal at a point of a face (barycentric
 * weights w) by the maps' slope, and changes its light. False: no fold there. */
void portrait_fold_pose(struct portrait *portrait, const double *controls);
bool portrait_fold(float normal[3], float light[3], const struct portrait *portrait, const struct portrait_sky *sky, int face,
                   const float w[3]);

/* eye.c: pictures of both eyes where samples show them, [height][width][4] each, at[side]: px of their corner; null px: not in
 * view. image_free. */
void portrait_eyes(struct image out[2], int at[2][2], const struct portrait *portrait, const struct portrait_view *view,
                   const struct portrait_spot *spots, int samples);

/* tear.c: draws the tear line into those pictures. */
void portrait_tears(struct image out[2], int at[2][2], const struct portrait *portrait, const struct portrait_view *view,
                    const struct portrait_spot *spots, int samples);

/* wet.c: finds the eyes' inner corners at rest, and makes the skin there moist. */
void portrait_wet_make(struct portrait *portrait);

/* Height of the meniscus at a point of a globe, mm: greater in the lacrimal lake at the inner corner. */
float portrait_lake_height(const struct portrait *portrait, int side, const float at[3]);

/* Depth of a meniscus of that height at distance d from the lid: a quarter of a circle. */
float portrait_lake_depth(float d, float height);

/* Transmittance of tear fluid of that depth (mm) for diffuse light that is reflected below it and leaves under the cosine cos_i
 * (Beer-Lambert). absorb: 1/mm. */
void portrait_lake_light(float through[3], float depth, float cos_i, const double absorb[3]);

/* Fresnel reflectance of the film of tears, unpolarised. */
float portrait_film_share(float cos_i);

/* Adds the reflection of a film of tears on moist skin with that normal to its colour. wet: moisture; open: share of the room that
 * is visible from there. */
void portrait_wet_shade(float rgb[3], const struct portrait *portrait, const float rig_from_cam[3][3], const float normal[3], const float dir[3],
                        float wet, float open);

/* enum distance_material of a pixel for the eye of that side, and the share of skin in it. spots: its first sample; row: samples in a
 * row of the picture. */
uint8_t portrait_material(float *cover, const struct portrait_spot *spots, long row, int samples,
                          int side);

/* Unit normal of a meniscus of that height at distance d from the lid: between the globe's normal and `away`, the unit
 * direction from the lid in the globe's tangent plane. */
void portrait_meniscus(float normal[3], const float globe[3], const float away[3], float d, float height);

/* globe.c: an eye as a sphere with a spherical cornea. */
/* Distance to the eye along a ray in the rig's frame, mm; INFINITY: missed. */
float portrait_eye_hit(const struct portrait *portrait, int side, const float origin[3], const float dir[3]);

/* rig_from_eye: columns x, y, z of the eye's frame (lib/README.md: z into the eye, x and y as a camera before it has them), as it is turned. */
void portrait_eye_axes(double axes[3][3], const struct portrait *portrait, int side);

/* mm of the rig in one of the eye's; radius (the eye's mm) of the sphere through the apex and the limbus, which stands for the cornea. */
double portrait_eye_scale(const struct portrait *portrait, int side);
double portrait_eye_cap(const struct scene *scene);

/* A direction d outside (index 1) bent to the inside of a surface with the unit normal n, both away from it: towards the light or the camera. cosine: of d with n.
 * False: d comes from behind. */
bool portrait_eye_bend(double in[3], double *cosine, const double d[3], const double n[3], double index);

/* Where a ray meets an eye: a place of its outside and the unit normal there (the rig's frame, mm). white: share of the sclera in what is seen there;
 * within: if that is not 1, the place of the iris plane that the ray comes to through the cornea (the eye's frame, mm). False: missed. */
struct portrait_eye_spot {
	float at[3], normal[3], white;
	double within[3];
};
bool portrait_eye_meet(struct portrait_eye_spot *spot, const struct portrait *portrait, int side, const float origin[3], const float dir[3]);

/* beneath.c: light on an eye below lids and lashes, in the pose and light of a picture. */
struct portrait_beneath;
struct portrait_beneath *portrait_beneath_new(const struct portrait *portrait, const struct portrait_rays *rays, int side);
void portrait_beneath_free(struct portrait_beneath *beneath);

/* Light that reaches what is seen there, the light that the lids' skin sends included, over what would reach it without lids and lashes. */
void portrait_beneath_light(float share[3], const struct portrait_beneath *beneath, const struct portrait_eye_spot *spot);

/* Skin that the outside mirrors there towards a camera that sees it along dir; returns what is left of the room's image: 0 where skin stands before it. */
float portrait_beneath_mirrored(float rgb[3], const struct portrait_beneath *beneath, const struct portrait_eye_spot *spot, const float dir[3]);

/* fringe.c: what lashes, and brows, leave of light that comes to an eye, and to the skin about it, from each of n directions (the rig's axes). For the
 * mesh's pose. */
struct portrait_fringe;
struct portrait_fringe *portrait_fringe_new(const struct portrait *portrait, int side, bool brows, int n, const struct envmap_light light[]);
void portrait_fringe_free(struct portrait_fringe *fringe);
float portrait_fringe_through(const struct portrait_fringe *fringe, int k, const float at[3]);

/* What hairs leave of all light at a place with that normal, in the light of the last portrait_light; 1 before that. */
float portrait_under_hair(const struct portrait *portrait, const float at[3], const float normal[3]);

/* The camera in the rig's frame, and a pixel's ray there (dir: unit; scale: its length along the camera's axis). */
struct portrait_rays {
	float origin[3];
	double rig_from_cam[3][3];
	const struct portrait_view *view;
};
struct portrait_rays portrait_rays_of(const struct portrait_view *view);
float portrait_ray(float dir[3], const struct portrait_rays *rays, double x, double y);

/* tear.c: depth of a globe along the camera's axis, the camera's unit, at the pixels from + (x, y) of a picture, lids before it or not:
 * depth[size[1]][size[0]], out. away: where there is no globe. */
void portrait_globe_depth(float *depth, const struct portrait *portrait, const struct portrait_rays *rays, int side, const int from[2], const int size[2],
                          float away);

#endif
