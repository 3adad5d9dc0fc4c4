/* vessels: a tree of vessels in the white of the eye, all of it connected to the roots it grew from. It grows by space colonisation (Runions, Lane and
 * Prusinkiewicz 2007) on the sphere: points that want blood draw the nearest twig towards them until one is there. Widths follow Murray's law (1926): the cube
 * of a parent's is the sum of its children's. */
#ifndef DRAW_EYE_VESSELS_H
#define DRAW_EYE_VESSELS_H
#include "image/image.h"

/* How a layer's vessels grow; lengths mm. */
struct vessel_habit {
	int points;               // that want blood
	int roots;
	double limbus, radius;    // angle of the limbus from the eye's axis, rad; radius of the sphere
	double step, reach, near; // of a twig; how far a point draws; how near it is content
	double width;             // of a twig's end
	const struct image *seen; // vessels of a photograph (draw/photo/vessels.h), [n][n][2]; null: none. Where it shows the white nothing wants blood; vessels grow to where its own
	double seen_reach;        // end there; angle at its edge, rad
	double sway, wave;        // how far a vessel winds to either side, and how long its windings are
};

struct vessel_node {
	double at[3];    // unit, from the sphere's centre; -z: the axis
	int parent;      // -1: a root
	double width;    // mm
	double shown;    // 0..1: how much of it the tissue before it lets through
};

/* Nodes come after their parents. vessels_free. */
struct vessels {
	int n;
	struct vessel_node *node;
};

struct vessels vessels_grow(const struct vessel_habit *habit, uint64_t seed);
void vessels_free(struct vessels *vessels);

/* Adds their cover, 0..1, to a map of one channel, azimuthal equidistant about the axis, whose edge is `reach` from it (rad). What is narrower than a texel covers
 * its share of it. */
void vessels_draw(struct image *cover, const struct vessels *vessels, double reach, double radius);

#endif
