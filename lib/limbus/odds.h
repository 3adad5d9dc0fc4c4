/* odds: how likely a measured ellipse is the limbus, to within any tolerance: the distribution of its error, from the evidence of the pixels in and
 * round it, the steps along it, the strip and the pupil in it. An ordinal regression by a small network on drawn and synthetic eyes
 * (tests/evidence/odds.py writes config/odds.onnx).
 */
#ifndef LIMBUS_ODDS_H
#define LIMBUS_ODDS_H
#include "limbus/region.h"
#include "limbus/rim.h"
#include "limbus/strip.h"

/* What is looked at. Means over places where not said otherwise; chances are the evidence's. */
enum odds_trait {
	ODDS_ONE,             // 1: the prior
	ODDS_SCATTER,         // log of the edge's scatter over the semi-axis
	ODDS_COVERAGE,        // share of the ring that shows a step
	ODDS_SIGMA,           // log of the largest sigma over the semi-axis
	ODDS_CONTRAST,        // log of the step's Weber contrast
	ODDS_BLUR,            // width of the step over the semi-axis
	ODDS_SCLERA_OUTSIDE,  // chance of sclera outside of the arcs used
	ODDS_IRIS_INSIDE,     // chance of iris inside of them
	ODDS_IRIS_OUTSIDE,    // chance of iris outside, all arcs
	ODDS_SCLERA_INSIDE,   // chance of sclera inside, all arcs
	ODDS_EYE,             // chance of iris, pupil or reflection in the ellipse
	ODDS_SCLERA,          // chance of sclera in it
	ODDS_AROUND,          // chance of sclera round it
	ODDS_BEHIND,          // how far its evidence is behind that of the best ellipse near it
	ODDS_OFF,             // how far that ellipse is, in semi-axes
	ODDS_PUPIL,           // 1 where a pupil was measured
	ODDS_PUPIL_OFF,       // how far its centre is off the ellipse's, semi-axes
	ODDS_PUPIL_LARGE,     // its size beyond half of the ellipse's
	ODDS_CUT,             // share of the ring beyond the photograph
	ODDS_ROUND,           // log b / a
	ODDS_IRIS_EVEN,       // log of how the brightness inside varies along the ring, in steps: painted irises are even
	ODDS_SCLERA_EVEN,     // the same outside
	ODDS_STRIP_SEEN,      // share of the rays of the strip where the limbus is seen
	ODDS_STRIP_ON,        // of what is seen of it, the share on the ellipse
	ODDS_STRIP_OFF,       // the share well off it
	ODDS_STRIP_WORTH,     // log likelihood of the ellipse
	ODDS_STRIP_BEHIND,    // how far that is behind the strip's own ellipse
	ODDS_STRIP_SCATTER,   // log of the scatter of the rays' places over the semi-axis
	ODDS_STRIP_APART,     // log of how far the strip's own ellipse is, semi-axes; of one that soft edges hardly move, from where they would move it
	ODDS_STRIP_SIGMA,     // log of the largest sigma of the strip's own ellipse, semi-axes
	ODDS_STRIP_MOVED,     // log of how far the last reading of the strip, with its mirror image, moved it, semi-axes
	ODDS_STRIP_BLIND,     // the same where the evidence of the pixels was kept from it: by the picture alone
	ODDS_STRIP_END,       // chance that the limbus is seen at the end of the diameter where it is seen least, the better of both ends
	ODDS_SIZE,            // log of the semi-axis, px
	ODDS_BY_STRIP,        // 1 where the strip's ellipse was the edge's prior, 2 one that soft edges hardly move: they do not agree by themselves
	ODDS_BY_VOTES,        // 1 where it came of edges' votes
	ODDS_TRAITS
};

/* What an ellipse is looked at with: evidence of the window round it, the map of that, and the strip with its own likeliest ellipse and
 * how far its last reading moved that, and where a reading without the evidence has it, px. */
struct odds_view { const struct evidence *evidence; const struct region_map *map; const struct strip *strip; const struct ellipse_prior *told; double moved, blind; int by_strip; bool by_votes; int width, height; };

#define LIMBUS_RIGHT 0.02  // semi-axes: centre or a semi-axis farther off is a gross error, if not said otherwise

/* pupil: null where none was measured. */
void odds_traits(double x[ODDS_TRAITS], const struct rim *rim, const struct rim *pupil, const struct odds_view *view);

/* The largest sigma of centre and semi-axes, semi-axes. */
double odds_sigma(const struct rim *rim);

#endif
