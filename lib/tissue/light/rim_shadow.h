/* rim_shadow: light on the iris next to the limbus, where the sclera stops it. Its shadow's edge is as soft as light spreads in the tissue. */
#ifndef TISSUE_LIGHT_RIM_SHADOW_H
#define TISSUE_LIGHT_RIM_SHADOW_H
#include <math.h>

#include "anatomy/eye.h"
#include "math/exp2.h"
#include "math/simd.h"

/* Lengths over the limbus' horizontal radius, but for depth. */
struct rim_shadow {
	float width;         // standard deviation of the edge that the sclera's gradual beginning makes
	float slope, depth;  // of the cornea at the limbus; mm
	float spread;        // of the edge that the tissue makes
	float share;         // of width's square in both
	float edge;          // where it lies: 1 at the limbus
};

/* width: over which the sclera begins; sigma: of light in the tissue (tissue/spread.h); mm. The sclera begins as t^2 (3 - 2 t) does, of the variance
 * 1/20. At the distance d from a straight edge light that diffuses in a layer, and is lost there, leaves exp(-|d| / b) / 2 of what is beyond: its
 * kernel in the plane is K0(r / b), of the variance 2 b^2 along an axis. Most of it stays near where it entered, and some goes far, as from a
 * dipole (Jensen et al. 2001). The edge of both together is taken as both shapes, of the variance of both, by their shares in it. */
static inline struct rim_shadow rim_shadow_of(const struct eye *eye, double width, double sigma)
{
	double r = eye->limbus_radius, depth = eye_limbus_depth(eye), begins = width / sqrt(20);
	return (struct rim_shadow){ (float)(begins / r), (float)(r / (eye->cornea_radius - eye->cornea_asphericity * depth)), (float)depth, (float)(sigma / r),
		                        (float)(begins * begins / (begins * begins + sigma * sigma)), 1 };
}

/* How far a point lies beyond the shadow's edge, in standard deviations; negative: in the light.
 * rho         where its light enters the cornea, 1 at the limbus
 * x, y, z     the point, mm
 * lx, ly, lz  direction towards the light inside the eye
 * A step of 1 on the iris plane towards the light's entry moves that entry by g along the cornea, which slopes away: g = 1 / (1 + slope tan t),
 * t the light's angle in the meridian. So the tissue's spread is g times as wide in rho. render/viewer/march.frag follows this. */
SIMD_INLINE float rim_shadow_at(const struct rim_shadow *rim, float rho, float x, float y, float z, float lx, float ly, float lz)
{
	float down = -lz > 0.05f ? -lz : 0.05f, inv = 1 / down, t = (z - rim->depth) * inv, kx = x + t * lx, ky = y + t * ly;
	float out = (kx * lx + ky * ly) / sqrtf(kx * kx + ky * ky + 1e-6f), soft = rim->spread / (1 + rim->slope * inv * (out > 0 ? out : 0));
	return (rho - rim->edge) / sqrtf(rim->width * rim->width + soft * soft);
}

/* The light that is left there, 0..1; all and none beyond RIM_SHADOW_MOST. */
#define RIM_SHADOW_MOST 3.6f
SIMD_INLINE float rim_shadow_open(const struct rim_shadow *rim, float at)
{
	float t = 0.2236068f * at + 0.5f, d = at < 0 ? -at : at, far = d < RIM_SHADOW_MOST ? 0.5f * exp2_quick(-2.0402785f * d) : 0;  // exp(-sqrt(2) d)
	t = t > 0 ? t < 1 ? t : 1 : 0;
	return rim->share * (1 - t * t * (3 - 2 * t)) + (1 - rim->share) * (at < 0 ? 1 - far : far);
}

#endif
