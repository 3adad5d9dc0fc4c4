/* lid_track: both lid margins of one eye, from frame to frame.
 * Lines on the lids near the margins (curves) are tracked by the strips' appearance; the offset from them to the margins is learnt over the clip.
 * Image  px, centre of the first pixel (0.5, 0.5). Index 0: upper lid, inner corner; 1: lower lid, outer corner.
 */
#ifndef TRACK_LID_LID_TRACK_H
#define TRACK_LID_LID_TRACK_H
#include "limbus/evidence.h"
#include "track/lid/colour.h"
#include "track/lid/margin.h"
#include "track/lid/strip.h"

enum { LID_TRACK_POINTS = 22 };

struct lid_track {
	int columns, points;
	bool known;                // colours have been learnt
	long frames;
	int every;                 // one frame in so many updates the strips
	struct lid_colour colour;
	struct lid_chart chart;    // of the last frame
	struct lid_strip strip[2]; // appearance of the lids along `curves`
	struct lid_curves curves;  // tracked lines on the lids, near the margins
	double offset[2][LID_COLS_MAX];  // rows from them to the margins, outwards
	double wet_mm, wet;        // tear meniscus: mm and rows from the visible edge out to the margin
	struct lid_corner corner[2];
	double at[2][2];           // the corners now: column, row
	struct lid_curves margins; // of the last frame
	struct lid_match match;    // scratch
};

struct lid_look {
	double inner[2], outer[2], down[2];  // corners of the eye by the head's pose, px; direction to the chin
	double mm;                 // px in a millimetre
	double iris[2], iris_px;   // limbus: centre and radius, px; NAN where not known
	const struct evidence *evidence;  // of the pixels round the eye: tells eye from lid; null: the clip's own colours do
};

struct lid_found {
	bool open;                 // there is an opening
	int first, last;           // its columns on the chart
	double gap;                // px at the widest
	double area;               // px²
	double sense;              // separation of inside and outside, in log odds; < 0: implausible
	double clear[2];           // how clearly each margin is seen, 0..1
	double misfit[2];          // of its strip: mean cost of a cell
	double corner[2][2];       // px
	double p[2][LID_TRACK_POINTS][2];
};

/* A frame's tracked lines, kept until the whole clip has shown the offset to the margins. */
struct lid_kept {
	double origin[2], du[2], dv[2], width;
	float row[2][LID_COLS_MAX], at[2][2];
};

/* columns: of the chart between the corners; points: control points of a margin; wet_mm: width of the tear meniscus; fps:
 * frames a second that will be pushed. lids: overwritten; owns no memory. */
void lid_track_start(struct lid_track *lids, int columns, int points, double wet_mm, double fps);

/* Finds the lids in the next frame. found: overwritten; open is false where the eye is shut. Returns false when the corners are
 * nearer than 8 px, or the eye's colours are not known yet and cannot be learnt here, for want of an iris. */
bool lid_track_push(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture,
                    const struct lid_look *look);

/* Copies the lines of the last frame. */
void lid_track_keep(struct lid_kept *kept, const struct lid_track *lids);

/* Estimates the offset from lines to margins from the whole clip: once after the last frame, before lid_track_again(). */
void lid_track_end(struct lid_track *lids);

/* Recomputes opening and points of a kept frame with the final offset; sense, clear and misfit stay. */
void lid_track_again(struct lid_found *found, struct lid_track *lids, const struct lid_kept *kept);

/* px as rows of the last frame's chart. */
double lid_track_rows(const struct lid_track *lids, double px);

/* True when px lies in the last opening, at least `rows` of its chart from either margin. */
bool lid_track_inside(const struct lid_track *lids, const double px[2], double rows);

#endif
