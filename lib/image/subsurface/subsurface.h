/* subsurface: screen-space subsurface scattering: the irradiance of drawn skin blurred by its diffusion profile. Each channel's
 * profile is a sum of Gaussians (d'Eon and Luebke 2007); each Gaussian is applied at the pyramid level where a few taps suffice.
 * Light crosses no gap in depth: with distance d in the picture and dz in depth a Gaussian of variance v has the weight
 * exp(-(d² + dz²) / 2v), which on a slanted plane is the distance along it. The comparison, the separable kernel of Jimenez et
 * al. 2015, is in tests/peers.
 */
#ifndef IMAGE_SUBSURFACE_SUBSURFACE_H
#define IMAGE_SUBSURFACE_SUBSURFACE_H
#include <stddef.h>

enum { SUBSURFACE_MAX = 8 };

/* A radially symmetric diffusion profile: for each channel a sum of weighted normalised Gaussians; the weights sum to 1. */
struct subsurface_profile {
	int n;
	double variance[SUBSURFACE_MAX];  // mm², along one axis, ascending
	double weight[SUBSURFACE_MAX][3];
};

/* Skin as measured (d'Eon and Luebke 2007, table of GPU Gems 3, chapter 14), lengths scaled so that the root mean square
 * distance of red is red_mm; 1.67 mm as measured. */
struct subsurface_profile subsurface_skin(double red_mm);

/* A picture of irradiance in planes, [height][width] each. */
struct subsurface_picture {
	int width, height;
	float *rgb[3];
	const float *depth;  // mm; 0 where there is no skin: such pixels neither give nor take light
	double px_per_mm;
};

/* Scratch memory, kept from frame to frame: { 0 } at first; owned by the caller. */
struct subsurface_room {
	float *px;
	size_t n, used;
};
void subsurface_room_free(struct subsurface_room *room);

/* Blurs picture->rgb in place. The result is the same to the bit on any number of threads. */
void subsurface_spread(const struct subsurface_picture *picture, const struct subsurface_profile *profile, struct subsurface_room *room);

#endif
