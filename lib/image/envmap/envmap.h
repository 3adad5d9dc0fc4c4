/* envmap: an environment map (light from all directions, latitude-longitude), with fast lookups, irradiance by spherical
 * harmonics and a set of directional lights.
 * Frame  the camera's: x right, y down, z forward. The middle of the map lies at -z, behind the camera, where an eye that
 *        looks into the camera looks; the map's right is -x, its top -y.
 * Values linear radiance, three channels, no negatives.
 */
#ifndef IMAGE_ENVMAP_ENVMAP_H
#define IMAGE_ENVMAP_ENVMAP_H
#include "image/image.h"

enum { ENVMAP_BLOCK = 8, ENVMAP_WET = 18 };

struct envmap {
	struct image map;    // [height][2 height][3]; owned
	struct image sharp, rough;  // the same on the octahedron unfolded about -z, for lookups; rough: blurred by 6 degrees;
	                            // four channels, the last empty
	struct image bend;   // greatest second difference in sharp, summed over channels, by blocks of ENVMAP_BLOCK px
	double sh[9][3];     // irradiance over pi, spherical harmonics to degree 2 (cosine lobe folded in)
	float quadric[9][3]; // the same as a polynomial in x, y, z: 1 x y z xy yz zz xz xx-yy
	float wet[ENVMAP_WET][3];  // irradiance over pi below a film of water: envmap_wet
};

/* A rectangular source: direction of its middle (unit), half-widths across and upwards, radiance. */
struct envmap_box {
	double dir[3];
	double half[2];      // radians
	double rgb[3];       // its mean
	double hot;          // 0: even .. 1: brightest in the middle, as a lamp behind a cloth is: 2.3 times the mean, half of it in the middle of an edge
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

/* Light that comes back out of a white of the eye with that unit normal, over what comes back where light is the same from everywhere, by the normal of where it
 * went in. Of light with the cosine c the tear film (index 1.336) lets c (1 - F(c)) in, and of what is bent to c' more comes back the more it slants:
 * as 3 - c' (photons in a shell of 0.6 mm before the dark of the choroid: tests/peers/sclera_photons.h). It spreads by half a millimetre, of the 12 that the eye is in
 * radius: that is left out. Expanded to degree 4: off by at most 0.06 of what a lamp gives where it stands overhead. */
void envmap_wet(float rgb[3], const struct envmap *env, const float normal[3]);

/* Its lobe: light whose direction has the cosine c with the normal counts lobe[0] + lobe[1] c + lobe[2] c^2 + lobe[3] c^4. */
extern const double envmap_wet_lobe[4];

/* The polynomial env->wet at a normal, by one channel's coefficients, `stride` apart: x y z xxxx xxxy xxxz xxyy xxyz xxzz xyyy xyyz xyzz xzzz yyyy yyyz yyzz
 * yzzz zzzz. */
static inline float envmap_wet_at(const float *p, int stride, float x, float y, float z)
{
#define P(k) p[(k) * stride]
	float xx = x * x, yy = y * y, zz = z * z, yz = y * z;
	float quartic = xx * (xx * P(3) + x * (y * P(4) + z * P(5)) + yy * P(6) + yz * P(7) + zz * P(8)) + x * (yy * (y * P(9) + z * P(10)) + zz * (y * P(11) + z * P(12)))
	                + yy * (yy * P(13) + yz * P(14) + zz * P(15)) + zz * (yz * P(16) + zz * P(17));
	float light = x * P(0) + y * P(1) + z * P(2) + quartic;
#undef P
	return light > 0 ? light : 0;
}

/* Directional lights by median cut (Debevec 2005): n = 2^k regions of equal energy, each as one light; together they carry all of
 * the map's energy. lights: [n], n <= ENVMAP_LIGHTS_MAX. Returns how many: black regions are left out. */
int envmap_lights(struct envmap_light lights[], int n, const struct envmap *env);

/* The same with regions of about equal energy times solid angle: an even sky is cut finely, a lamp is one region. */
int envmap_lights_spread(struct envmap_light lights[], int n, const struct envmap *env);

/* The same as envmap_lights, with each direction drawn at random in its region by importance sampling: the mean over many seeds
 * is the environment itself, so that lights of an area cast soft shadows. */
int envmap_lights_drawn(struct envmap_light lights[], int n, const struct envmap *env, uint64_t seed);

#endif
