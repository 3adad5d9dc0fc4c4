/* What the two passes of the distance field share. */
#ifndef IMAGE_DISTANCE_IMPL_H
#define IMAGE_DISTANCE_IMPL_H
#include <stddef.h>
#include <string.h>

#include "image/distance/distance.h"

enum { DISTANCE_LANES = 16, DISTANCE_GROUP = 8 };  // texels of a block; blocks of a group: a word of bytes
static const float DISTANCE_FAR = 1e6f;  // px; its square and a little more are still numbers

/* What a block of a row holds. */
enum { DISTANCE_HAS_GLOBE = 1, DISTANCE_HAS_SKIN = 2, DISTANCE_ALL_SKIN = 4, DISTANCE_ALL_GLOBE = 8 };
#define DISTANCE_EACH UINT64_C(0x0101010101010101)  // a byte in each block of a group

struct distance_field {
	const struct distance_scene *scene;
	int blocks;             // in a row of the screen, in whole groups
	uint8_t *has;           // [screen's height][blocks]
	int first, last;        // the window's blocks, in whole groups: those that hold globe, widened by what the band reaches into
	int wide;               // blocks that the band reaches into
	int y0, rows, band;     // the window's rows, widened by the band; px
	int globe_y0, globe_y1; // rows that hold globe
	int pitch;              // blocks in a row of v and edge: the window's, and `wide` more at either end
	float *v;               // [rows][pitch][LANES] distance to the nearest edge in the column, + downwards
	uint8_t *edge;          // [rows][pitch] 1 where a block's v is set: an edge lies within the band in its columns
};

/* Blocks of a row of the screen. */
static inline const uint8_t *distance_has(const struct distance_field *f, int y)
{
	return f->has + (size_t)y * (size_t)f->blocks;
}

/* A group of them as one word; the order of its bytes does not matter. */
static inline uint64_t distance_group(const uint8_t *has)
{
	uint64_t word;
	memcpy(&word, has, sizeof word);
	return word;
}

/* A block of the window in v and edge. */
static inline size_t distance_at(const struct distance_field *f, int block, int y)
{
	return (size_t)(y - f->y0) * (size_t)f->pitch + (size_t)(block - f->first + f->wide);
}

/* Sub-pixel place of the edge among the coverages of four texels of a line; of the middle two the first is skin, the second not.
 * Returns the distance from the third texel's centre towards skin. Where the outer two are wholly skin and wholly not, the sum of
 * the four gives the place of a straight edge of any slope; otherwise the edge is a long ramp, and lies where coverage crosses
 * one half. */
__attribute__((always_inline)) static inline float distance_crossing(float beyond, float skin, float other, float behind)
{
	float drop = skin - other, ramp = (0.5f - other) / (drop > 1e-6f ? drop : 1);
	float whole = 2.5f - (beyond + skin + other + behind), t = ((beyond > 0.99f) & (behind < 0.01f)) ? whole : ramp;
	t = t < 0 ? 0 : t;
	return t > 1 ? 1 : t;
}

/* columns.c: the first pass: v and edge of a group's columns. Returns the texture reads. */
double distance_columns(struct distance_field *field, int group);

/* rows.c: the second pass: every texel of a row that has an edge near it. nearest: null, or as distance_band()'s. Returns the
 * texture reads. */
double distance_row(const struct distance_field *field, int y, double reach, float *out, float (*nearest)[2]);

/* A row on its way, its blocks counted from the window's first. Its arrays hold `wide` blocks more on either side. */
struct distance_span {
	const struct distance_field *f;
	int y, x0;               // px, of block 0
	double reach;            // world units
	float *v;                // distance to the nearest edge in the column
	float *left, *right;     // x of the last edge in the row on either side, as far as it is in the run; coverage only
	const uint8_t *has;      // of each block
	float *out, (*nearest)[2];  // the screen's
};

/* blocks.c: blocks [from, to), each with an edge near it, into the screen. Returns how many columns were looked at on
 * each side, of all blocks. */
int distance_blocks(const struct distance_span *span, int from, int to);

/* Writes INFINITY to those of n texels that are globe, far from all skin. all: every one of them is globe. */
void distance_far(float *out, const uint8_t *material, int n, bool all);

/* world.c: world distance between texel (x, y) and the skin at `off` px from it, d2 px squared away (eq. 4.21). */
float distance_in_world(const struct distance_scene *scene, int x, int y, const float off[2], float d2);

#endif
