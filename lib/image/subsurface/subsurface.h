/* subsurface: light that enters skin and leaves it some way off, spread on the screen (after Jimenez et al. 2015, whose
 * separable kernel is the comparison): each channel's diffusion profile as a sum of Gaussians (d'Eon and Luebke 2007), every
 * Gaussian at the level of a pyramid where a few taps do. Light crosses no gap in depth: with distance d in the picture and
 * dz in depth a Gaussian of variance v weighs exp(-(d² + dz²) / 2v), which on a slanted plane is the distance along it.
 */
#ifndef IMAGE_SUBSURFACE_SUBSURFACE_H
#define IMAGE_SUBSURFACE_SUBSURFACE_H
#include <stddef.h>

enum { SUBSURFACE_MAX = 8 };

/* Radially symmetric profile: of each channel sum of weight times a normalised Gaussian; weights sum to 1. */
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
	const float *depth;  // mm; 0 where there is no skin: it gives and takes nothing
	double px_per_mm;
};

/* Room to work in, kept from frame to frame: { 0 } at first. */
struct subsurface_room {
	float *px;
	size_t n, used;
};
void subsurface_room_free(struct subsurface_room *room);

/* Spreads the light in place. The same bits on any number of threads. */
void subsurface_spread(const struct subsurface_picture *picture, const struct subsurface_profile *profile, struct subsurface_room *room);

#endif
