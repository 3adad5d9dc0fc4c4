/* envmap: an environment map (light from all directions, latitude-longitude), with fast lookups, irradiance by spherical
 * harmonics and a set of directional lights.
 * Frame  the camera's: x right, y down, z forward. The middle of the map lies at -z, behind the camera, where an eye that
 *        looks into the camera looks; the map's right is -x, its top -y.
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
	struct image bend;   // greatest second difference in sharp, summed over channels, by blocks of ENVMAP_BLOCK px
	double sh[9][3];     // irradiance over pi, spherical harmonics to degree 2 (cosine lobe folded in)
	float quadric[9][3]; // the same as a polynomial in x, y, z: 1 x y z xy yz zz xz xx-yy
};

/* A rectangular source: direction of its middle (unit), half-widths across and upwards, radiance. */
struct envmap_box {
	double dir[3];
	double half[2];      // radians
	double rgb[3];
};

/* A directional light that stands for a region of the map. */
struct envmap_light {
	float dir[3];        // unit, towards the light
	float rgb[3];        // irradiance, over pi: a white plane facing it has this radiance
};

enum { ENVMAP_LIGHTS_MAX = 256 };

/* A synthetic room: a gradient from ceiling to floor radiance, with n boxes painted in.
 * height  rows of the map
 * back    share of the light that is left in the direction behind the eye (+z)
 * envmap_free. */
struct envmap envmap_room(int height, const double ceiling[3], const double floor[3], double back, int n,
                          const struct envmap_box boxes[]);

/* An environment from a latitude-longitude picture of three channels.
 * env   overwritten; envmap_free
 * map   taken over, also on failure; negatives and values that are not finite become 0
 * name  of the file, for errors
 * False, err set, for a map that is not twice as wide as high, smaller than 16 x 8, or black. */
bool envmap_take(struct envmap *env, struct image *map, const char *name, struct err *err);
void envmap_free(struct envmap *env);

/* Radiance of a white diffuse plane that faces the camera (normal -z), mean of the channels. */
double envmap_level(const struct envmap *env);

/* Multiplies all radiances by k. */
void envmap_scale(struct envmap *env, double k);

/* A copy of which each channel is multiplied by its own factor. envmap_free. */
struct envmap envmap_tinted(const struct envmap *env, const double k[3]);

/* Scales the map so that this level is 1. */
void envmap_normalise(struct envmap *env);

/* Radiance from a unit direction, bilinear. rough: 0 the map .. 1 its blurred copy. */
void envmap_at(float rgb[3], const struct envmap *env, const float dir[3], float rough);

/* Irradiance over pi of a plane with that unit normal, from the spherical harmonics (Ramamoorthi and Hanrahan 2001). */
void envmap_irradiance(float rgb[3], const struct envmap *env, const float normal[3]);

/* Directional lights by median cut (Debevec 2005): n = 2^k regions of equal energy, each as one light; together they carry all of
 * the map's energy. lights: [n], n <= ENVMAP_LIGHTS_MAX. Returns how many: black regions are left out. */
int envmap_lights(struct envmap_light lights[], int n, const struct envmap *env);

/* The same with regions of about equal energy times solid angle: an even sky is cut finely, a lamp is one region. */
int envmap_lights_spread(struct envmap_light lights[], int n, const struct envmap *env);

/* The same as envmap_lights, with each direction drawn at random in its region by importance sampling: the mean over many seeds
 * is the environment itself, so that lights of an area cast soft shadows. */
int envmap_lights_drawn(struct envmap_light lights[], int n, const struct envmap *env, uint64_t seed);

#endif
