/* edge: brightness profiles across an ellipse, and the sub-pixel place of a blurred step in each.
 * The limbus is a ramp: sclera over iris with an opacity that rises across it. In linear light
 *     I(s) = (1 - A) i0 exp(k s) + A s0 (1 + m max(s - d - 2 w, 0)),   A = Phi((s - d) / w)
 * s along the outward normal, d the middle of the ramp (opacity one half), w its width. The iris darkens towards its
 * root (k); the sclera is shaded (m) from where the ramp ends, because the surface turns in the sulcus behind it. The
 * half-height crossing of the profile alone is biased by up to 0.05 mm.
 */
#ifndef LIMBUS_EDGE_H
#define LIMBUS_EDGE_H
#include "limbus/image.h"

enum { ARCS = 360 };

/* Profiles across n = ARCS places, equally spaced along the ellipse. Lengths in px of the photograph. */
struct ring {
	struct ellipse e;
	int m;                 // samples in a profile
	double lo, step;       // s of the first sample, spacing
	double t[ARCS];        // eccentric angle
	double p[ARCS][2], normal[ARCS][2];
	bool inside[ARCS];     // the whole profile lies in the photograph
	float *v;              // [ARCS][m]; owned
};

/* Samples the profiles of an ellipse from lo to hi px (lo < 0 < hi) along the outward normal, every `step` px.
 * across         each sample is the mean of at most so many places along the arc
 * width, height  of the photograph, px
 * ring_free. */
struct ring ring_sample(const struct grey *grey, const struct ellipse *e, double lo, double hi, double step,
                        int across, int width, int height);
void ring_free(struct ring *ring);

struct step {
	double d, w;          // middle and width (sigma of Phi), px
	double in, out;       // i0, s0: iris and sclera at s = 0
	double k, m;          // their slopes, 1/px
	double rms;           // residual, in units of out - in
	double sigma_d;       // px, from the residuals, were they independent
	double contrast;      // (out - in) / (out + in), at the step
	bool steep;           // the brightness outside changes too fast: a shadow's edge, a lid
	bool ok;
};

enum { EDGE_CANDIDATES = 4 };

/* The strongest dark-to-bright steps of one profile, strongest first: local maxima of the difference of the means
 * over `half` px on both sides. Returns how many; strength in units of brightness. */
int edge_candidates(double at[EDGE_CANDIDATES], double strength[EDGE_CANDIDATES], const struct ring *ring, int arc,
                    double half);

/* The typical profile: the median over the arcs in `use` of the profile moved by shift[arc] px and scaled to 0 inside, 1 outside.
 * Returned as arc 0 of a ring; ring_free. */
struct ring ring_typical(const struct ring *ring, const bool use[ARCS], const double shift[ARCS]);

/* Estimates the slopes k and m of every arc from the brightness farther than `reach` px from the step, smoothed along the ring. */
void edge_slopes(struct step step[ARCS], const struct ring *ring, double reach);

/* Fits the step model to one arc by least squares: d, in, out (and w where free_width), from the start step->d and step->w, with
 * k and m fixed. window: sigma of the Gaussian weight round d, px. step->ok is false when there is no step. */
void edge_fit(struct step *step, const struct ring *ring, int arc, double window, bool free_width);

#endif
