/* distance_impl: what the two passes of the distance field in the band share. */
#ifndef IMAGE_DISTANCE_IMPL_H
#define IMAGE_DISTANCE_IMPL_H
#include <stddef.h>

#include "image/distance.h"

enum { DISTANCE_LANES = 16, DISTANCE_GROUP = 8 };  // texels of a block; blocks of a group: a word of bytes
static const float DISTANCE_FAR = 1e6f;  // px; its square and a little more are still numbers

/* What a block of a row holds. */
enum { DISTANCE_HAS_GLOBE = 1, DISTANCE_HAS_SKIN = 2, DISTANCE_ALL_SKIN = 4, DISTANCE_ALL_GLOBE = 8 };
#define DISTANCE_EACH UINT64_C(0x0101010101010101)  // a byte in each block of a group

struct distance_field {
	const struct distance_scene *scene;
	int groups;             // in a row of the screen, the last one cut
	uint64_t *has;          // [screen's height][groups] bytes, of each block
	int from, to;           // groups of the window: those that hold globe
	int first, last;        // the same widened by what the band reaches into
	int y0, rows, band;     // the window's rows, widened by the band; px
	int globe_y0, globe_y1; // rows that hold globe
	float *v;               // [last - first][rows][GROUP][LANES] distance to the nearest edge in the column, + downwards
	uint64_t *edge;         // [last - first][rows] bytes, 1 where a block's v is set: an edge lies within the band in its columns
};

static inline uint64_t distance_has(const struct distance_field *f, int group, int y)
{
	return f->has[(size_t)y * (size_t)f->groups + (size_t)group];
}

static inline size_t distance_at(const struct distance_field *f, int group, int y)
{
	return (size_t)(group - f->first) * (size_t)f->rows + (size_t)(y - f->y0);
}

/* Where the edge runs between four texels of a line, the middle two of which are skin and not: distance from the third
 * one's centre towards skin. A straight edge that leaves the outer two whole lies where their sum says, whatever its
 * slope; a steeper one is a long ramp, and lies where one half is crossed. */
__attribute__((always_inline)) static inline float distance_crossing(float beyond, float skin, float other, float behind)
{
	float drop = skin - other, ramp = (0.5f - other) / (drop > 1e-6f ? drop : 1);
	float t = beyond > 0.99f && behind < 0.01f ? 2.5f - (beyond + skin + other + behind) : ramp;
	return t < 0 ? 0 : t > 1 ? 1 : t;
}

/* distance_columns.c: v and edge of a group's columns. Returns the texture reads. */
double distance_columns(struct distance_field *field, int group);

/* distance_rows.c: every texel of a row that has an edge near it. nearest: null, or as distance_band()'s. Returns the
 * texture reads. */
double distance_row(const struct distance_field *field, int y, double reach, float *out, float (*nearest)[2]);

/* distance_world.c: world distance between texel (x, y) and the skin at `off` px from it, d2 px squared away (eq. 4.21). */
float distance_in_world(const struct distance_scene *scene, int x, int y, const float off[2], float d2);

#endif
