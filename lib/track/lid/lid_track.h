/* lid_track: the lids of one eye from frame to frame.
 */
#ifndef TRACK_LID_LID_TRACK_H
#define TRACK_LID_LID_TRACK_H
#include "track/lid/colour.h"
#include "track/lid/margin.h"
#include "track/lid/strip.h"

enum { LID_TRACK_POINTS = 22 };

struct lid_track {
	int columns, points;
	bool known;                // colours have been learnt
	long frames;
	int every;                 // one frame in so many is learnt from
	struct lid_colour colour;
	struct lid_chart chart;    // of the last frame
	struct lid_strip strip[2]; // what the lids look like along `curves`
	struct lid_curves curves;  // lines on the lids that are found again in every frame, near the margins
	double offset[2][LID_COLS_MAX];  // rows from them to the margins, outwards
	double wet_mm, wet;        // mm and rows that a margin is thought to be outside of the edge seen
	struct lid_corner corner[2];
	double at[2][2];           // the corners now: column, row
	struct lid_curves margins; // of the last frame
	struct lid_match match;    // scratch
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
	double clear[2];           // how well each lid is seen, 0..1
	double misfit[2];          // of its strip: mean cost of a cell
	double corner[2][2];       // px
	double p[2][LID_TRACK_POINTS][2];
};

/* A frame's lines as they were followed, for when the clip has shown how far from them the margins are. */
struct lid_kept {
	double origin[2], du[2], dv[2], width;
	float row[2][LID_COLS_MAX], at[2][2];
};

/* wet_mm: the tear meniscus between a margin and what is seen of the eye. fps: frames of a second that will be pushed. */
void lid_track_start(struct lid_track *lids, int columns, int points, double wet_mm, double fps);

/* False: nothing is known yet of this eye's colours and it cannot be learnt here (no iris, or corners too near). */
bool lid_track_push(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture,
                    const struct lid_look *look);

void lid_track_keep(struct lid_kept *kept, const struct lid_track *lids);

/* To be called once after the last frame, before lid_track_again(): how far the margins are from the lines. */
void lid_track_end(struct lid_track *lids);

/* Opening and points of a kept frame with what is known now; sense, clear and misfit stay. */
void lid_track_again(struct lid_found *found, struct lid_track *lids, const struct lid_kept *kept);

/* Whether px lies in the opening found last, by at least `inside` px from either margin. */
bool lid_track_inside(const struct lid_track *lids, const double px[2], double inside);

#endif
