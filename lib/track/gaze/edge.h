/* edge: limbus edges of one frame, searched along the normals of the expected limbus, and the direction of gaze fitted to them.
 */
#ifndef TRACK_GAZE_EDGE_H
#define TRACK_GAZE_EDGE_H
#include <stdint.h>

#include "track/gaze/globe.h"

enum { GAZE_ARCS_MAX = 360 };

struct luma {
	const uint8_t *px;     // [height][stride]
	int width, height, stride;
};

/* Bilinear, clamped at the border; x, y px, centre of the first pixel (0.5, 0.5). */
static inline double luma_at(const struct luma *luma, double x, double y)
{
	double u = x - 0.5, v = y - 0.5;
	u = u < 0 ? 0 : u > luma->width - 1.001 ? luma->width - 1.001 : u;
	v = v < 0 ? 0 : v > luma->height - 1.001 ? luma->height - 1.001 : v;
	int i = (int)u, j = (int)v;
	double fu = u - i, fv = v - j;
	const uint8_t *p = luma->px + (long)j * luma->stride + i, *q = p + luma->stride;
	double top = p[0] + fu * (p[1] - p[0]), bottom = q[0] + fu * (q[1] - q[0]);
	return top + fv * (bottom - top);
}

struct gaze_edge {
	float angle;           // on the limbus, radians
	float x, y;            // px
	float strength;        // height of the step, grey levels
};

/* Whether the limbus may be seen at a place of the image; ctx the caller's. */
typedef bool (*gaze_seen_fn)(const void *ctx, const double px[2]);

struct gaze_search {
	int arcs;              // equally spaced round the limbus
	double range;          // px searched on both sides of the expected limbus
	double half;           // px averaged on both sides of the step
	double least;          // grey levels a step must rise
	gaze_seen_fn seen;     // null: everywhere
	const void *ctx;
};

/* Finds on each arc the strongest dark-to-bright step along the normal, to a fraction of a pixel: the peak of the difference
 * between the means on both sides, which blur and motion do not shift. fick: expected gaze. Returns how many arcs have one. */
int gaze_edges(struct gaze_edge edge[GAZE_ARCS_MAX], const struct luma *luma, const struct gaze_globe *globe,
               const struct gaze_view *view, const double fick[2], const struct gaze_search *search);

struct gaze_fit {
	double fick[2];        // radians
	double cov[2][2];      // radians², from the scatter
	double bias;           // radial offset of the edges from the circle, mm, positive outside
	double rms;            // of the inliers' distances, px
	double inliers;        // sum of the robust weights
	double span;           // 0..1: how evenly the inliers lie round the limbus; 0 all in one place
};

/* Estimates h and v by least squares with Tukey weights, starting from fit->fick, together with a radial offset of all edges
 * (prior standard deviation bias_sigma, mm): how far out a blurred limbus has its half height differs between eyes.
 * Returns false when too few edges agree. */
bool gaze_fit_edges(struct gaze_fit *fit, int n, const struct gaze_edge edge[], const struct gaze_globe *globe,
                    const struct gaze_view *view, double bias_sigma);

#endif
