/* eye_track_opts: settings of eye_track, and their rows of a stage's option table. */
#ifndef TRACK_EYE_EYE_TRACK_OPTS_H
#define TRACK_EYE_EYE_TRACK_OPTS_H
#include "base/opt.h"

struct eye_track_conf {
	int limbus_arcs;        // edges measured round the limbus
	int lid_columns;        // profiles measured across a lid's margin
	int lid_points;         // control points of a margin
	double lid_wet;         // mm: width of the tear meniscus between a lid's margin and the visible eye
	int torsion_rays;       // directions of the iris pattern compared; 0: no torsion
	double evidence_px;     // irises of a smaller radius are looked for in the evidence of the pixels (limbus/evidence.h) instead of in brightness and colours
	double still;           // mean change of brightness, of 255, below which a frame counts as unchanged
	double center_sigma;    // mm: eyeball centre off its prior, each way
	double radius_sigma;    // mm: eyeball radius off its prior
	double limbus_sigma;    // mm: limbus radius off eye.limbus_radius_mm
	double free_radius[2];  // mm: radius of people's eyeballs and its standard deviation, where there is no mesh
	double alike_radius;    // mm: radii of a person's two eyeballs differ by, where there is no mesh
	double edge_sigma;      // share of the limbus' radius by which its edges err with the gaze, where there is no mesh
	double edge_px;         // px by which they do at least
	double saccade_speed;   // degrees/s above which the eye is in a saccade
	double saccade_size;    // degrees: smaller ones cannot be distinguished from noise
	double apart[2];        // degrees, horizontally and vertically: eyes further apart than mostly were not both followed
	double poor;            // share of an eye's usual confidence below which its gaze is then forgotten, too
	double blink_depth;     // share of the opening that must shut to count as a blink
};

#define EYE_TRACK_OPTS(c) \
	OPT_INT("limbus_arcs", &(c)->limbus_arcs, 16, 360, "", "edges measured round the limbus"), \
	OPT_INT("lid_columns", &(c)->lid_columns, 16, 96, "", "profiles measured across a lid's margin"), \
	OPT_INT("lid_points", &(c)->lid_points, 17, 22, "", "control points of a lid's margin"), \
	OPT_REAL("lid_wet_mm", &(c)->lid_wet, 0, 1, "mm", "tears between a lid's margin and what is seen of the eye"), \
	OPT_INT("torsion_rays", &(c)->torsion_rays, 0, 720, "", "directions of the iris compared; 0: no torsion"), \
	OPT_REAL("evidence_px", &(c)->evidence_px, 0, 1000, "px", "irises of a smaller radius, and their lids, are told by the evidence of the pixels"), \
	OPT_REAL("still", &(c)->still, 0, 20, "", "mean change of brightness (of 255) of a frame that stands still"), \
	OPT_REAL("eye_center_sigma_mm", &(c)->center_sigma, 0.01, 20, "mm", "eyeball centre off its prior, each way"), \
	OPT_REAL("eye_radius_sigma_mm", &(c)->radius_sigma, 0.01, 5, "mm", "eyeball radius off its prior"), \
	OPT_REAL("limbus_sigma_mm", &(c)->limbus_sigma, 0.01, 2, "mm", "limbus radius off eye.limbus_radius_mm"), \
	OPT_REALS("free_radius_mm", (c)->free_radius, 2, 0.01, 20, "mm", "eyeball radius and its standard deviation among people, without a mesh"), \
	OPT_REAL("alike_radius_sigma_mm", &(c)->alike_radius, 0.01, 5, "mm", "radii of a person's two eyeballs off each other, without a mesh"), \
	OPT_REAL("limbus_edge_sigma", &(c)->edge_sigma, 0, 0.2, "", "of the limbus' radius: its edges err so far with the gaze, without a mesh"), \
	OPT_REAL("limbus_edge_px", &(c)->edge_px, 0, 10, "px", "and at least so far"), \
	OPT_REAL("saccade_speed", &(c)->saccade_speed, 5, 200, "degrees/s", "speed above which the eye is in a saccade"), \
	OPT_REAL("saccade_size", &(c)->saccade_size, 0.1, 10, "degrees", "saccades smaller than this are not reported"), \
	OPT_REALS("apart_deg", (c)->apart, 2, 0.1, 90, "degrees", "gaze of the two eyes further apart than mostly, h and v, is doubted"), \
	OPT_REAL("apart_poor", &(c)->poor, 0, 1, "", "of its usual confidence: less, and that eye's gaze is then forgotten too"), \
	OPT_REAL("blink_depth", &(c)->blink_depth, 0.05, 0.9, "", "share of the opening that shuts in a blink")

#endif
