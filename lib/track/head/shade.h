/* shade: what the shading of a face tells of its head's pose. The mesh says where skin faces and how much of its surroundings the head itself hides from
 * it. In any light that is smooth over the directions its brightness is then known but for nine numbers (spherical harmonics to order 2: Ramamoorthi and
 * Hanrahan 2001; hidden ones left out: Sloan, Kautz and Snyder 2002), and it lies where the mesh lies: brow, nose and the sockets of the eyes stand up to
 * 30 mm before the eyes and behind them, which tells how a head at rest is turned.
 * Head frame  the mesh's axes, mm.  Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_HEAD_SHADE_H
#define TRACK_HEAD_SHADE_H
#include "base/opt.h"
#include "mesh/mesh.h"
#include "track/head/pose.h"

struct head_shade_conf {
	double reach;      // mm: skin as near to the middle between the eyes
	double away;       // mm: and no nearer to an eyeball's centre: lashes and lids move
	double blur;       // mm: what is finer (pores, hairs) is smoothed away
	double patch;      // mm: over so much skin, blotches and what nine numbers do not tell of the light err together; 0: shading is not looked at
};

#define HEAD_SHADE_OPTS(c) \
	OPT_REAL("shade_reach_mm", &(c)->reach, 20, 500, "mm", "shading is looked at so far from the eyes"), \
	OPT_REAL("shade_away_mm", &(c)->away, 0, 100, "mm", "and no nearer to an eyeball's centre"), \
	OPT_REAL("shade_blur_mm", &(c)->blur, 0.05, 20, "mm", "smoothed by so much, one standard deviation"), \
	OPT_REAL("shade_patch_mm", &(c)->patch, 0, 200, "mm", "skin that errs together in it; 0: shading is not looked at")

struct head_shape;

/* Points spread evenly over the skin about the eyes, and what each sees of light from all sides. eye[2]: eyeballs' centres, NAN: not known.
 * Returns null where there is no skin. head_shape_free, which accepts null. */
struct head_shape *head_shape_new(const struct mesh *mesh, const double eye[2][3], const struct head_shade_conf *conf);
void head_shape_free(struct head_shape *shape);

/* A picture's brightness for head_shade: the logarithm of its red light, in which skin varies least, smoothed. */
struct head_picture {
	int width, height;
	double scale;      // px of the picture in one of these
	float *ln;         // [height][width]
};

/* rgb[height][3 width]; blur in px. Returns false where it cannot be smoothed. free(ln). */
bool head_picture_make(struct head_picture *out, const uint8_t *rgb, int width, int height, double blur_px);

/* The shading's likelihood of poses near cam_from_head, one Gauss-Newton step: light is fitted robustly under this one and left free.
 * Returns false, out unchanged, where too little skin is in sight, or its brightness tells no pose. */
bool head_shade(struct head_form *out, const struct head_shape *shape, const struct head_picture *picture, const struct camera *camera,
                const double cam_from_head[4][4], const struct head_shade_conf *conf);

/* How many patches of skin, each with an error of its own, a form was told from. */
double head_shade_patches(const struct head_form *form, const struct head_shape *shape, const struct head_shade_conf *conf);

#endif
