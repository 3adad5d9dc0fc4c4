/* lid_track: the lids of one eye from frame to frame.
 */
#ifndef SKIN_LID_TRACK_H
#define SKIN_LID_TRACK_H
#include "skin/lid_colour.h"
#include "skin/lid_margin.h"

enum { LID_TRACK_POINTS = 22 };

struct lid_track {
	int columns, points;
	bool known;                // colours have been learnt
	int poor;                  // frames in a row that made no sense
	long frames;
	struct lid_colour colour;
	struct lid_chart chart;    // of the last frame
	struct lid_curves curves;  // the same, its margins
	struct lid_curves open;    // margins of the last frame that was well open
};

struct lid_look {
	double inner[2], outer[2], down[2];  // corners of the eye where the head says, px; direction
	double mm;                 // px
	double iris[2], iris_px;   // limbus: centre and radius, px; NAN where not known
};

struct lid_found {
	bool open;                 // there is an opening
	int first, last;           // its columns on the chart
	double gap;                // px at the widest
	double area;               // px²
	double sense;              // how unlike inside and outside are, in log odds; < 0: nonsense
	double clear[2];           // share of columns that show an edge
	double corner[2][2];       // px
	double p[2][LID_TRACK_POINTS][2];
};

void lid_track_start(struct lid_track *lids, int columns, int points);

/* False: nothing is known yet of this eye's colours and it cannot be learnt here (no iris, or corners too near). */
bool lid_track_push(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture,
                    const struct lid_look *look);

/* Whether px lies in the opening found last, by at least `inside` px from either margin. */
bool lid_track_inside(const struct lid_track *lids, const double px[2], double inside);

#endif
