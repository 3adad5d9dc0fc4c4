/* impl: what the files of wrinkle share. Charts are [height][width]; chart coordinates begin at (x0, y0). */
#ifndef TRACK_WRINKLE_IMPL_H
#define TRACK_WRINKLE_IMPL_H
#include "track/wrinkle/wrinkle.h"

/* warp.c: log of the frame's linear brightness, warped to the chart; sure: 0 where no tracked point is near. */
void wrinkle_unwrap(float *log_light, uint8_t *sure, const struct wrinkle_ground *ground, const struct wrinkle_frame *frame);

/* Of the threshold: a line that is surely one goes on where it is so strong (hysteresis, Canny 1986). On the folds of the bundled clip. */
static const double wrinkle_follows = 0.7;

/* ridge.c: dark ridges of the chart, by their curvature across, from wrinkle_follows times the threshold on. */
struct wrinkle_ridges {
	int width, height;
	float *rise;        // curvature across, sigma^2 times; 0: no ridge here
	float *trust;       // response over threshold
	float (*at)[2];     // px of the chart, to a fraction of a texel
	float (*along)[2];  // unit
	float *half;        // w, px
};
bool wrinkle_ridges_find(struct wrinkle_ridges *ridges, const float *change, const float *neutral, const uint8_t *skin,
                         const struct wrinkle_ground *ground, const struct wrinkle_conf *conf, struct err *err);
void wrinkle_ridges_free(struct wrinkle_ridges *ridges);

/* link.c: links ridges into curves with control points a mm apart on the surface; widths are the ridges'. What is above the threshold has to be long enough; from there
 * a line goes on as long as it is `least` times the threshold, wrinkle_follows to 1. lines: owned by the caller. Returns how many. */
int wrinkle_link(struct wrinkle_line **lines, const struct wrinkle_ridges *ridges, double least, const struct wrinkle_ground *ground,
                 const struct wrinkle_conf *conf);

/* light.c: the light, first from the shading of the neutral face; then the share of ambient in frontal light, which that leaves
 * open, from the
 * shading of the lines: a lamp darkens their walls, a sky their bottom. */
void wrinkle_light(struct wrinkles *w, const float *neutral, const uint8_t *skin, const struct wrinkle_ground *ground);
struct wrinkle_grooves;
void wrinkle_ambient(struct wrinkles *w, int n, const struct wrinkle_line lines[], const float *change, const struct wrinkle_ground *ground,
                     const struct wrinkle_grooves *grooves);

/* depth.c */
/* Residual of a line's profiles after grooves have been fitted. */
double wrinkle_unexplained(const struct wrinkle_line *line, const struct wrinkles *w, const float *change, const struct wrinkle_ground *ground,
                           const struct wrinkle_grooves *grooves);
struct wrinkle_grooves *wrinkle_grooves_new(double most_slope);  // free()
/* Fits depth, width and middle of every point to the peak's change; a line that is no groove gets n = 0. */
void wrinkle_measure(struct wrinkle_line *line, const struct wrinkles *w, const float *change, const struct wrinkle_ground *ground,
                     const struct wrinkle_grooves *grooves, const struct wrinkle_conf *conf);
/* Fits depth and shift in frame k; the width is kept. */
void wrinkle_follow(struct wrinkle_line *line, int k, const struct wrinkles *w, const float *change,
                    const struct wrinkle_ground *ground, const struct wrinkle_grooves *grooves);

/* Point (mm, head) and unit normal of the surface that a pixel of the reference shows; false when there is none. */
bool wrinkle_on_surface(struct wrinkle_point *point, double normal[3], const struct wrinkle_ground *ground, const double px[2]);

#endif
