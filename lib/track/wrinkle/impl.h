/* wrinkle_impl: what the files of wrinkle share. Charts are [height][width]; chart coordinates begin at (x0, y0). */
#ifndef TRACK_WRINKLE_IMPL_H
#define TRACK_WRINKLE_IMPL_H
#include "track/wrinkle/wrinkle.h"

/* warp.c: log of the frame's linear brightness, brought to the chart; sure: 0 where no point tells. */
void wrinkle_unwrap(float *log_light, uint8_t *sure, const struct wrinkle_ground *ground, const struct wrinkle_frame *frame);

/* ridge.c: where the chart is darkest across a line. */
struct wrinkle_ridges {
	int width, height;
	float *rise;        // curvature across, sigma^2 times; 0: no ridge here
	float *trust;       // times what counts as one
	float (*at)[2];     // px of the chart, to a part of a texel
	float (*along)[2];  // unit
	float *half;        // w, px
};
bool wrinkle_ridges_find(struct wrinkle_ridges *ridges, const float *change, const float *neutral, const uint8_t *skin,
                         const struct wrinkle_ground *ground, const struct wrinkle_conf *conf, struct err *err);
void wrinkle_ridges_free(struct wrinkle_ridges *ridges);

/* link.c: curves, control points a mm apart on the surface, px of the picture; width as the ridges say. */
int wrinkle_link(struct wrinkle_line **lines, const struct wrinkle_ridges *ridges, const struct wrinkle_ground *ground,
                 const struct wrinkle_conf *conf);

/* light.c: from the neutral face; then what it cannot tell, whether light comes straight on or from everywhere, from how the
 * lines are shaded: a lamp darkens their walls, a sky their bottom. */
void wrinkle_light(struct wrinkles *w, const float *neutral, const uint8_t *skin, const struct wrinkle_ground *ground);
struct wrinkle_grooves;
void wrinkle_ambient(struct wrinkles *w, int n, const struct wrinkle_line lines[], const float *change, const struct wrinkle_ground *ground,
                     const struct wrinkle_grooves *grooves);

/* depth.c */
/* What is left of a line's profiles when grooves have been fitted. */
double wrinkle_unexplained(const struct wrinkle_line *line, const struct wrinkles *w, const float *change, const struct wrinkle_ground *ground,
                           const struct wrinkle_grooves *grooves);
struct wrinkle_grooves *wrinkle_grooves_new(double most_slope);  // free()
/* Depth, width and true middle of every point from the peak's change; of a line that is no groove n becomes 0. */
void wrinkle_measure(struct wrinkle_line *line, const struct wrinkles *w, const float *change, const struct wrinkle_ground *ground,
                     const struct wrinkle_grooves *grooves, const struct wrinkle_conf *conf);
/* Depth and shift in frame k, its width known. */
void wrinkle_follow(struct wrinkle_line *line, int k, const struct wrinkles *w, const float *change,
                    const struct wrinkle_ground *ground, const struct wrinkle_grooves *grooves);

/* Normal and place of the surface that a pixel of the reference shows; false: none. mm, head. */
bool wrinkle_on_surface(struct wrinkle_point *point, double normal[3], const struct wrinkle_ground *ground, const double px[2]);

#endif
