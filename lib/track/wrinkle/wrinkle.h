/* wrinkle: wrinkle lines of an expression: found as curves in a video, with their depth, and rendered to a bump map.
 *
 * Chart    the skin as the reference frame shows it, px (centre of the first pixel (0.5, 0.5)); every frame is warped there by the tracked points.
 * Signal   log of the brightness over the neutral frame's: colour, moles and hairs cancel; folds darken.
 * Depth    mm, beyond the neutral frame's: a groove -d exp(-s^2 / 2 w^2) at the distance s across the line, in the light of the neutral face.
 */
#ifndef TRACK_WRINKLE_WRINKLE_H
#define TRACK_WRINKLE_WRINKLE_H
#include "base/opt.h"
#include "image/image.h"
#include "mesh/ray.h"
#include "optics/camera.h"

struct wrinkle_conf {
	double width_mm[2];    // w of the narrowest and the widest searched
	int scales;
	double drop;           // least relative darkening of a line
	double significance;   // threshold, in units of the response of skin without lines
	double pattern;        // threshold, in units of the neutral skin's own pattern nearby
	double length_mm;      // shortest
	double lash_mm;        // no lines nearer to the opening of an eye: lashes
	double slope;          // deepest: d / w
	int frames;            // of an expression, from neutral to peak, in which its lines are followed
};

#define WRINKLE_OPTS(c) \
	OPT_REALS("wrinkle_width_mm", (c)->width_mm, 2, 0.05, 10, "mm", "half widths (w) of the narrowest and the widest wrinkle that is looked for"), \
	OPT_INT("wrinkle_scales", &(c)->scales, 1, 12, "", "widths tried between them"), \
	OPT_REAL("wrinkle_drop", &(c)->drop, 0.005, 1, "", "share of its light that the faintest line loses"), \
	OPT_REAL("wrinkle_significance", &(c)->significance, 1, 50, "", "a line stands out so many times above skin without lines"), \
	OPT_REAL("wrinkle_pattern", &(c)->pattern, 0, 10, "", "and so many times above the neutral skin's own pattern thereabouts"), \
	OPT_REAL("wrinkle_length_mm", &(c)->length_mm, 1, 100, "mm", "shortest line"), \
	OPT_REAL("wrinkle_lash_mm", &(c)->lash_mm, 0, 30, "mm", "nearer to the opening of an eye lashes are in the way"), \
	OPT_REAL("wrinkle_slope", &(c)->slope, 0.1, 5, "", "deepest wrinkle: depth over half width"), \
	OPT_INT("wrinkle_frames", &(c)->frames, 2, 64, "", "of an expression in which its lines are followed, neutral and peak among them")

/* The skin at rest, and its surface. Everything is borrowed. */
struct wrinkle_ground {
	int x0, y0, width, height;         // chart, px; as much of every frame is kept
	double px_per_mm;
	int n;
	const double (*at)[2];             // px: tracked points in the reference frame
	const uint8_t *mask;               // [height][width] of the chart; 0: no skin, or lashes before it
	const struct mesh *mesh;           // mm
	const float (*normals)[3];
	const struct ray_scene *rays;
	const struct camera *camera;
	const double (*cam_from_head)[4];  // at the reference
};

/* A frame: sRGB grey of the chart's part of the picture, and the tracked points in it (px, 0..1). Borrowed. */
struct wrinkle_frame {
	long index;
	const uint8_t *grey;               // [height][width]
	const float (*at)[2], *confidence; // [n]
};

/* A control point of a line. */
struct wrinkle_point {
	double px[2], mm[3];               // chart; head
	double across[3], across_px[2];    // unit vector on the skin, across the line; in the chart, px a mm
	double depth, width;               // d and w at the peak, mm
	bool even;                         // measured under an even sky instead of the face's light
	int face;                          // of the mesh, and
	double bary[2];                    // where in it: weights of its second and third corner
};

struct wrinkle_line {
	int n;
	struct wrinkle_point *point;
	double length;                     // mm
	float *depth, *shift;              // [frame][n] mm; shift: across, off its place in the chart
};

/* An expression's lines. */
struct wrinkle_pose {
	char *name;
	int n, n_frames;
	struct wrinkle_line *line;
	long *frame;                       // neutral .. peak
};

struct wrinkles {
	int n;
	struct wrinkle_pose *pose;         // in capture.conf's order: that of the action units
	int x0, y0, width, height;         // chart
	double px_per_mm;
	double ambient, from[3];           // light of the neutral face on a normal m (head): ambient + from . m; its mean over the skin is 1
};
void wrinkles_free(struct wrinkles *wrinkles);

/* Finds the lines of the next expression and appends a pose to w; wrinkles_free. frames[0]: neutral, frames[n - 1]: peak; n <
 * 2: the pose has none.
 * Returns false, err set, when the ridge filter fails. */
bool wrinkle_find(struct wrinkles *w, const char *name, int n, const struct wrinkle_frame frames[],
                  const struct wrinkle_ground *ground, const struct wrinkle_conf *conf, struct err *err);

/* Bump map of a pose, of the chart's size; channels: 0 height (mm, <= 0), 1 share of an even sky that is visible. image_free. */
struct image wrinkle_bump(const struct wrinkles *w, const struct wrinkle_pose *pose);

/* Share of an even sky's light that reaches s / w across a groove of slope d / w. */
double wrinkle_sky(double s, double slope);

/* Writes wrinkles.json: curves, depths by frame, and the chart. made_by: JSON text or null. */
bool wrinkles_save(const struct wrinkles *w, const char *path, const char *made_by, struct err *err);

#endif
