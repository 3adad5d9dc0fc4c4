/* envmap: light from all round, as a latitude-longitude map, and what a renderer needs of it.
 * Frame  the camera's: x right, y down, z forward. The middle of the map lies at -z, behind the camera: what an
 *        eye that looks into the camera sees before it; the map's right is -x, its top -y.
 * Values linear radiance, three channels, no negatives.
 */
#ifndef IMAGE_ENVMAP_ENVMAP_H
#define IMAGE_ENVMAP_ENVMAP_H
#include "image/image.h"

enum { ENVMAP_BLOCK = 8 };

struct envmap {
	struct image map;    // [height][2 height][3]; owned
	struct image sharp, rough;  // the same on the octahedron unfolded about -z, for lookups; rough: blurred by 6 degrees;
	                            // four channels, the last empty
	struct image bend;   // of sharp, by blocks of ENVMAP_BLOCK px: greatest second difference, channels summed
	double sh[9][3];     // irradiance over pi, spherical harmonics to degree 2 (cosine lobe folded in)
	float quadric[9][3]; // the same as a polynomial in x, y, z: 1 x y z xy yz zz xz xx-yy
};

/* A rectangular source: direction of its middle (unit), half-widths across and upwards, radiance. */
struct envmap_box {
	double dir[3];
	double half[2];      // radians
	double rgb[3];
};

/* Light of one direction: what a region of the map gives a plane facing it. */
struct envmap_light {
	float dir[3];        // unit, towards the light
	float rgb[3];        // irradiance, over pi: a white plane facing it has this radiance
};

enum { ENVMAP_LIGHTS_MAX = 256 };

/* A room: ceiling to floor gradient, darker towards what lies behind the eye (back: share of light left there), with the
 * boxes in it. height rows. envmap_free. */
struct envmap envmap_room(int height, const double ceiling[3], const double floor[3], double back, int n,
                          const struct envmap_box boxes[]);

/* Of a latitude-longitude picture, which it takes over: three channels; negatives and what is not finite become 0.
 * name: for errors. envmap_free. */
bool envmap_take(struct envmap *env, struct image *map, const char *name, struct err *err);
void envmap_free(struct envmap *env);

/* Radiance of a white plane that faces the camera (normal -z), mean of the channels. */
double envmap_level(const struct envmap *env);

/* Scales the map so that this level is 1. */
void envmap_normalise(struct envmap *env);

/* Radiance from a unit direction, bilinear; rough 0..1: between the map and its blurred copy. */
void envmap_at(float rgb[3], const struct envmap *env, const float dir[3], float rough);

/* Irradiance over pi of a plane with that unit normal. */
void envmap_irradiance(float rgb[3], const struct envmap *env, const float normal[3]);

/* Median cut (Debevec 2005): the map in n = 2^k regions of equal energy, each as one light; returns how many (dark
 * regions are left out). Together they carry all of the map's energy. */
int envmap_lights(struct envmap_light lights[], int n, const struct envmap *env);

/* The same with regions of about equal energy times solid angle: where the light is even they are small, and a lamp is one. */
int envmap_lights_spread(struct envmap_light lights[], int n, const struct envmap *env);

/* The same with each region's direction drawn by its light: the mean over many seeds is the environment itself, areas and
 * all. */
int envmap_lights_drawn(struct envmap_light lights[], int n, const struct envmap *env, uint64_t seed);

#endif
