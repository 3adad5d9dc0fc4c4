/* One level of subsurface.c's pyramid: the picture, halved so many times, and the sum of what was blurred there. */
#ifndef IMAGE_SUBSURFACE_LEVEL_H
#define IMAGE_SUBSURFACE_LEVEL_H
#include "image/subsurface.h"

enum { SUBSURFACE_LANES = 8 };
typedef float subsurface_lanes __attribute__((vector_size(32), aligned(4)));
enum { SUBSURFACE_LEVELS = 7, SUBSURFACE_RADIUS = 40, SUBSURFACE_PART = 32 };

struct subsurface_level {
	int width, height, stride;
	float *rgb[3];     // irradiance; the caller's at the top
	const float *z;    // depth of the skin nearest to the camera, mm; 0: none
	unsigned char *even;  // [height][parts] 1: what SUBSURFACE_PART texels of a row were made of is one surface; null at the top
	int parts;
	float *sum[3];     // of weighted Gaussians; null until there is one
};

/* Weights of the taps -radius .. radius; their sum is 1. */
struct subsurface_taps {
	int radius;
	float weight[2 * SUBSURFACE_RADIUS + 1];
};

void subsurface_taps_gauss(struct subsurface_taps *taps, double variance);

/* The picture itself; the level below another, each of its texels the mean of the frontmost of four. */
void subsurface_level_top(struct subsurface_level *level, const struct subsurface_picture *picture);
void subsurface_level_halve(struct subsurface_level *level, const struct subsurface_level *above, double texels_per_mm,
                            struct subsurface_room *room);

/* Room for at least so many, all of it free. */
void subsurface_room_make(struct subsurface_room *room, size_t n);

/* The next n numbers of the room: multiples of 16 apart, valid until room->used is set back. */
float *subsurface_room_take(struct subsurface_room *room, size_t n);

/* What subsurface_blur() takes of the room for each thread at a level so wide, and gives back. */
size_t subsurface_band_size(int width);

/* Adds weight times the blurred picture to the sum, along x and then along y. variance: of the fall-off in depth, mm². */
void subsurface_blur(struct subsurface_level *level, const struct subsurface_taps *taps, double variance, const double weight[3],
                     struct subsurface_room *room);

/* Adds the sum of the level below, interpolated, to this one's; at the top (stays: null elsewhere) to what stays where it
 * is, with its own sum, in the picture. */
void subsurface_level_join(struct subsurface_level *level, const struct subsurface_level *below, double texels_per_mm,
                           const double stays[3], struct subsurface_room *room);

/* The top with no level below: what stays where it is, and the sum. */
void subsurface_level_give(struct subsurface_level *top, const double stays[3]);

#endif
