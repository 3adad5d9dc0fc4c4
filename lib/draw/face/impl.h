/* portrait_impl: what the files of the portrait share. */
#ifndef DRAW_FACE_IMPL_H
#define DRAW_FACE_IMPL_H
#include "draw/face/parts.h"

/* What a sample of the picture shows. */
struct portrait_spot {
	int face;      // of the mesh; -1: nothing, -2 and -3: the left and right eye
	float depth;   // along the camera's axis, mm
};

/* raster.c: the nearest triangle at the middle of every cell of a grid samples times finer than the view;
 * [height samples][width samples]. free(). */
struct portrait_spot *portrait_raster(const struct portrait *portrait, const struct portrait_view *view, int samples);

/* Smooth noise in -1..1 at a point of the skin at rest, of cells so many to a mm. */
float portrait_noise(const float p[3], float per_mm);

/* shade.c: colour of a point of a face seen along dir (camera, unit). */
struct portrait_sky {
	int n;
	float detail;  // 0..1: how much of pores a pixel of the view resolves
	float rig_from_cam[3][3];
	struct envmap_light light[ENVMAP_LIGHTS_MAX];  // in the rig's axes
};
/* light: irradiance there; null: the vertices'. */
void portrait_shade(float rgb[3], const struct portrait *portrait, const struct portrait_sky *sky, int face,
                    const float origin[3], const float dir[3], const float *light);

/* Unit normal of such a point, without folds and pores; of a hair, its flat side's. */
void portrait_normal(float normal[3], const struct portrait *portrait, int face, const float origin[3], const float dir[3]);

/* Irradiance of such a point, before skin spreads it. */
void portrait_bare_light(float rgb[3], const struct portrait *portrait, int face, const float origin[3], const float dir[3]);
struct portrait_sky portrait_sky_of(const struct portrait *portrait, const struct portrait_view *view);

/* glow.c: irradiance of the skin at every pixel's middle, spread beneath it. */
struct portrait_glow {
	int width, height;
	float *rgb[3], *depth;  // [height][width]; depth (mm of the rig) 0: no skin there. Owned
	float scale;            // the camera's unit in one of the rig's
};
struct portrait_glow portrait_glow_of(const struct portrait *portrait, const struct portrait_view *view, const struct portrait_spot *spots,
                                      int samples);
/* Of a point of the picture (px) on skin so deep (the camera's unit), from the pixels round it that show that skin and no other
 * behind or before it. False: none does. */
bool portrait_glow_at(float rgb[3], const struct portrait_glow *glow, double x, double y, float depth);
void portrait_glow_free(struct portrait_glow *glow);

/* wrinkle.c: strengths for a pose; what a fold does to the normal of a point of a face (weights w) and to its light.
 * False: none there. */
void portrait_fold_pose(struct portrait *portrait, const double *controls);
bool portrait_fold(float normal[3], float light[3], const struct portrait *portrait, const struct portrait_sky *sky, int face,
                   const float w[3]);

/* eye.c: both eyes' colours where the grid shows them, [height][width][4] each; null px where not in view. */
void portrait_eyes(struct image out[2], int at[2][2], const struct portrait *portrait, const struct portrait_view *view,
                   const struct portrait_spot *spots, int samples);

/* tear.c: tear line and the dark under the lids' edges, into those pictures. */
void portrait_tears(struct image out[2], int at[2][2], const struct portrait *portrait, const struct portrait_view *view,
                    const struct portrait_spot *spots, int samples);

/* wet.c: finds the inner corners, once, and wets the skin there. */
void portrait_wet_make(struct portrait *portrait);

/* Height of the meniscus on a point of a globe: the lake at the inner corner is wider. */
float portrait_lake_height(const struct portrait *portrait, int side, const float at[3]);

/* Depth of a meniscus of that height at distance d from the lid: a quarter of a circle. */
float portrait_lake_depth(float d, float height);

/* What so deep a lake lets pass of the light that comes from all round, is thrown back below it and leaves under that cosine
 * (Beer and Lambert); absorb: 1/mm. */
void portrait_lake_light(float through[3], float depth, float cos_i, const double absorb[3]);

/* Fresnel reflectance of the film of tears, unpolarised. */
float portrait_film_share(float cos_i);

/* What a film on skin with that normal mirrors, over its colour; open: share of the room that is seen from there. */
void portrait_wet_shade(float rgb[3], const struct portrait *portrait, const float rig_from_cam[3][3], const float normal[3], const float dir[3],
                        float wet, float open);

/* enum distance_material of a pixel for the eye of that side, and how much of it is skin: from its samples, rows apart. */
uint8_t portrait_material(float *cover, const struct portrait *portrait, const struct portrait_spot *spots, long row, int samples,
                          int side);

/* Unit normal of a meniscus of that height at distance d from the lid: between the globe's normal and `away`, the unit
 * direction from the lid in the globe's tangent plane. */
void portrait_meniscus(float normal[3], const float globe[3], const float away[3], float d, float height);

/* Distance to the eye along a ray of the rig's frame; INFINITY: missed. */
float portrait_eye_hit(const struct portrait *portrait, int side, const float origin[3], const float dir[3]);

/* The camera in the rig's frame, and a pixel's ray there (dir: unit; scale: its length along the camera's axis). */
struct portrait_rays {
	float origin[3];
	double rig_from_cam[3][3];
	const struct portrait_view *view;
};
struct portrait_rays portrait_rays_of(const struct portrait_view *view);
float portrait_ray(float dir[3], const struct portrait_rays *rays, double x, double y);

#endif
