/* What the files of subsurface share: the levels of the pyramid, scratch memory, and one line of a Gaussian. */
#ifndef IMAGE_SUBSURFACE_IMPL_H
#define IMAGE_SUBSURFACE_IMPL_H
#include <stdbool.h>

#include "image/subsurface/subsurface.h"

enum { SUBSURFACE_LEVELS = 7, SUBSURFACE_RADIUS = 40, SUBSURFACE_PART = 32, SUBSURFACE_ROUNDING = 16 };

/* One Gaussian at its level: taps -radius .. radius with weights w that sum to 1, stored as root = w^1/4 and fall = w^1/4 / 8v,
 * v its variance in mm²; weight: its share in each of the first `channels` channels. */
struct subsurface_gauss {
	int radius, channels;
	float root[2 * SUBSURFACE_RADIUS + 1], fall[2 * SUBSURFACE_RADIUS + 1], weight[3];
};

/* One line: for each of n texels out = gain times the weighted mean of the taps [from, to], `step` apart; added to out where
 * `adds`. n is a multiple of SUBSURFACE_ROUNDING; what is beyond the picture has depth 0. */
struct subsurface_line {
	const float *in[3], *z;
	float *out[3], gain[3];
	int n, step, z_step, from, to, channels;
	bool adds;
};
void subsurface_line(const struct subsurface_line *line, const struct subsurface_gauss *gauss);

/* One level: the picture halved so many times, and the Gaussians that are applied there. Planes have `stride` numbers a row; where
 * the level has Gaussians, `side` empty texels border each row on either side. */
struct subsurface_level {
	int width, height, stride, side;
	double texels_per_mm;
	const float *in[4];   // irradiance; depth of the skin nearest to the camera, mm, 0: none. The first texel of the first row
	float *own[4];        // the same to write; null at a top without Gaussians, which is the caller's picture
	unsigned char *even;  // [height][parts] 1: what SUBSURFACE_PART texels of a row were made of is one surface; null at the top
	int parts;
	float plain[3];  // share of each channel that the level adds without blur
	int n;
	struct subsurface_gauss gauss[SUBSURFACE_MAX];
};

/* Makes a Gaussian of that variance (texels²) at a level of that resolution. */
void subsurface_gauss_make(struct subsurface_gauss *gauss, double variance, double texels_per_mm, const double weight[3]);

/* Sets width, height, stride, side and parts of a level whose Gaussians are made. Returns how many numbers its planes take. */
size_t subsurface_level_size(struct subsurface_level *level, int width, int height, bool top);

/* Gives planes to level[0 .. deepest] out of the room and copies the picture into level 0 where that has Gaussians; without them
 * level 0 reads the caller's picture. subsurface_level_halve fills the others. */
void subsurface_level_fill(struct subsurface_level *level, int deepest, const struct subsurface_picture *picture, struct subsurface_room *room);

/* Fills levels 1 .. deepest: each texel is the mean of the frontmost of four above it. */
void subsurface_level_halve(const struct subsurface_level *level, int deepest);

/* Clears the borders of row y. */
void subsurface_level_sides(const struct subsurface_level *level, int y);

/* n rounded up to whole vectors. */
static inline size_t subsurface_rounded(size_t n)
{
	return (n + SUBSURFACE_ROUNDING - 1) / SUBSURFACE_ROUNDING * SUBSURFACE_ROUNDING;
}

/* Prefetches n numbers. */
static inline void subsurface_ahead(const float *px, int n)
{
	for (int i = 0; i < n; i += 16)
		__builtin_prefetch(px + i);
}

/* Makes room for at least n numbers, and frees all of it for subsurface_room_take. */
void subsurface_room_make(struct subsurface_room *room, size_t n);

/* The next n numbers of the room: multiples of 16 apart. */
float *subsurface_room_take(struct subsurface_room *room, size_t n);

/* Writes the picture: the unblurred share `stays`, and every level's Gaussians, interpolated up from level to level.
 * room: with subsurface_sum_size() numbers left for each thread. */
void subsurface_sum(const struct subsurface_level *level, int deepest, const struct subsurface_picture *picture, const double stays[3],
                    struct subsurface_room *room);
size_t subsurface_sum_size(const struct subsurface_level *level, int deepest);

/* One row: out[c] = keep[c] out[c] + the sum of the level below, interpolated, where there is skin. below: its two rows
 * nearest to y, the nearer one first, r, g, b, depth. flat: of subsurface_join_look(). mean: room for 3 rows of the level below. */
void subsurface_join(float *const out[3], const float keep[3], const struct subsurface_level *level, const struct subsurface_level *lower,
                     int y, const float *const below[2][4], const unsigned char *flat, float *mean);

/* Which parts of a row between rows y[0] and y[1] of the level below need no depth weights. flat: [lower->parts + 1]. */
void subsurface_join_look(unsigned char *flat, const struct subsurface_level *level, const struct subsurface_level *lower, const int y[2]);

#endif
