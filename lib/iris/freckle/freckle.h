/* freckle: detects spots of pigment on the iris and fills them in (iris paper, section 4).
 *
 * A crypt is dark because little light comes back from it: all colours fall alike. Melanin absorbs blue and green before red: in a
 * freckle the log ratio of red to green rises against the surrounding iris while the spot darkens. A brown iris has the colour of
 * melanin everywhere; there a freckle is a flat dark patch that hides the fibres.
 * Maps are square iris maps with half-width `extent` mm; places are mm in the iris plane.
 */
#ifndef IRIS_FRECKLE_FRECKLE_H
#define IRIS_FRECKLE_FRECKLE_H
#include "iris/unrefract/unrefract.h"

struct freckle_conf {
	int max_size;           // texels a side of the map searched
	double blur;            // mm
	double ratio, ratio_z;  // least rise of log(red/green) over the surroundings; the same in their spread
	double darker;          // least fall of log(green)
	double red_share;       // most that red may fall, as a share of green's fall
	double edge;            // share of a spot's own level at which it ends
	double min_area;        // mm²
	double brown;           // median log(red/green) from which an iris is brown: its freckles are found by flatness
	double flat_area;       // mm², least there
	double flat_spread;     // most spread of brightness inside, as a share of that around it
	double flat_darker;     // least fall of log(green) there
	double flat_long;       // most length over width
	double limbus_margin;   // mm of the iris next to the limbus left out
	double search_deg;      // how far round the iris the fill looks for its pattern
	double band;            // mm of surroundings that the pattern has to continue
	int candidates;         // patterns tried on either side
};

struct freckle {
	double x, y;        // centre, mm
	double area;        // mm²
	double confidence;  // 0..1
};

struct freckles {
	int n;
	struct freckle *items;  // largest first
	int size;
	float *opacity;         // [size][size] 0..1 over the same extent; 0.5 at a spot's edge
};

/* Detects the freckles of an iris map.
 * rgbw    R, G, B (linear), W (weight)
 * extent  half-width, mm
 * limbus  radius, mm
 * freckles_free. */
struct freckles freckles_find(const struct image *rgbw, double extent, const struct circle *pupil, double limbus,
                              const struct freckle_conf *conf);
void freckles_free(struct freckles *freckles);

/* Fills every texel of rgbw with mask set. Each connected region takes the piece of iris at the same radii, some angle away, whose
 * surroundings fit best, blended in by Poisson editing (Perez, Gangnet and Blake 2003) of log colour. Texels without weight are
 * never copied.
 * mask  [size][size], 0 or 1; channels of rgbw beyond three are left as they are
 * Returns the number of regions filled. */
int freckle_fill(struct image *rgbw, const uint8_t *mask, double extent, const struct circle *pupil, double limbus,
                 const struct freckle_conf *conf);

/* The mask for freckle_fill: the spots and the blur of their edges (blur: mm). [size][size]; free(). */
uint8_t *freckle_mask(const struct freckles *freckles, double extent, double blur);

#endif
