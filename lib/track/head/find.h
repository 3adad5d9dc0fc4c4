/* find: coarse head pose in a picture, from the openings of its eyes: sclera, iris and pupil differ in colour from the skin around them,
 * in any person.
 * Head frame  the subject mesh's axes, mm.  Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_HEAD_FIND_H
#define TRACK_HEAD_FIND_H
#include "base/opt.h"
#include "track/eye/opening.h"
#include "track/head/pose.h"

struct head_find_conf {
	double width[2];       // of an opening, as a share of the picture's: least, most
	double roll;           // degrees: largest roll searched
	double turn_sigma, yaw_sigma;  // degrees: standard deviations of the face's turn from the camera, up and down and aside
	double min_score;      // below it no eyes are reported
	double edge;           // px at a width of 1280: search range of the refinement
};

#define HEAD_FIND_OPTS(c) \
	OPT_REALS("eye_width", (c)->width, 2, 0.01, 1, "", "least and most of an eye's opening, of the picture's width"), \
	OPT_REAL("roll_deg", &(c)->roll, 0, 80, "degrees", "heads leaning more are not looked for"), \
	OPT_REAL("turn_sigma_deg", &(c)->turn_sigma, 0.1, 45, "degrees", "how far the face is turned from the camera up or down, 1 sigma"), \
	OPT_REAL("yaw_sigma_deg", &(c)->yaw_sigma, 0.1, 45, "degrees", "and aside"), \
	OPT_REAL("min_score", &(c)->min_score, 0, 10, "", "contrast of eyes against skin below which there are none"), \
	OPT_REAL("edge_px", &(c)->edge, 1, 200, "px", "how far off an outline may begin, at 1280 px")

struct head_found {
	double cam_from_head[4][4];
	bool seen[2];          // openings visible in the picture, left and right
	double score;          // contrast of openings against skin, in units of its spread
	double edge_px;        // rms of the outlines found against the mesh's; NAN: not refined
};

/* Slides the outlines of the openings, in a range of sizes and rolls, over a reduced picture, and takes the pose of best
 * contrast. rgb[height][3 width]. opening[2]: left, right; at least one open. camera->focal_px must be known. upside_down:
 * searches for an inverted head instead of an upright one; openings alone hardly distinguish the two. found: overwritten.
 * Returns false when no eyes are found. */
bool head_find(struct head_found *found, const uint8_t *rgb, int width, int height, const struct camera *camera,
               const struct eye_opening opening[2], bool upside_down, const struct head_find_conf *conf);

/* Pose of a head that faces the camera, from the pixels of the left and the right eye (a detector's). found: overwritten.
 * Returns false when the subject has not two open eyes. */
bool head_find_from_eyes(struct head_found *found, const double eye[2][2], const struct camera *camera, const struct eye_opening opening[2]);

#endif
