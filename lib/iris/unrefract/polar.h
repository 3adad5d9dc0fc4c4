/* polar: the ring between pupil and limbus of a merged texture, unrolled. Internal to unrefract.
 * Row k lies at (k + 0.5) / rows of the way from the pupil's margin to the limbus along the ray of column j, whose angle about the pupil's
 * centre is 2 pi (j + 0.5) / columns, from +x towards +y. Columns go round.
 */
#ifndef IRIS_UNREFRACT_POLAR_H
#define IRIS_UNREFRACT_POLAR_H
#include "iris/unrefract/rings.h"

enum { POLAR_HIDDEN, POLAR_SEEN };

struct polar {
	int rows, columns;    // columns: a power of two
	struct sheet sheet;
	float *px;            // [rows][columns][3] logarithm of the colour, less its row's level
	uint8_t *kind;        // [rows][columns]
	float (*level)[3];    // [rows] mean logarithm of what is seen of the row; of the nearest full row where that is too little
	int *full;            // [rows] the nearest row of which enough is seen: itself, another; -1: there is none
};

/* Unrolls the texture at about its own resolution. polar_free. */
struct polar polar_new(const struct unrefract_texture *texture, double limbus);
void polar_free(struct polar *polar);

/* Linear colour at a point (mm), bicubic. False outside of the ring. */
bool polar_colour(float rgb[3], const struct polar *polar, double x, double y);

static inline float *polar_at(const struct polar *p, int row, int column)
{
	return p->px + 3 * ((long)row * p->columns + (column & (p->columns - 1)));
}

static inline uint8_t *polar_kind(const struct polar *p, int row, int column)
{
	return p->kind + (long)row * p->columns + (column & (p->columns - 1));
}

#endif
