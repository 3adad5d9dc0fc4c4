/* iris_map: the correspondence between photo pixels and points of the iris plane, refracted by the cornea (iris paper,
 * section 3).
 * Frame  eye: origin at the corneal apex, z into the eye, mm; the iris plane is z = depth.
 * Maps   square, centred on the optical axis, half-width `extent` mm: texel (col, row) lies at
 *        x = (col + ½) 2 extent / size − extent, y likewise; row 0 is at −y.
 */
#ifndef IRIS_IRIS_MAP_H
#define IRIS_IRIS_MAP_H
#include "anatomy/fit.h"
#include "image/image.h"

enum iris_method {
	IRIS_LATTICE,     // exact light paths on a lattice, bicubic between
	IRIS_NEWTON,      // an exact light path for each texel
	IRIS_ALGORITHM1,  // the paper's algorithm 1 for each texel
};

/* One photograph's view of the iris plane. The cornea has no rim here: paths that leave it beyond the limbus are followed too, so
 * that the map stays smooth; the results' `rim` is the distance from the axis at which they left. */
struct iris_view {
	const struct fit *fit;
	struct cornea cornea;   // without a rim
	double depth;           // of the iris plane, mm
	double a[2][3];         // affine map from the map frame to this photograph's eye frame: a (x, y, 1), mm; identity for one
	                        // photograph alone
};

/* fit: must outlive the view. */
struct iris_view iris_view_new(const struct fit *fit, const struct eye *eye);

struct iris_map_conf {
	int method;    // enum iris_method
	int node;      // texels between the lattice's nodes
	double alpha, eps_inner, eps_outer;  // algorithm 1's, mm
	int max_inner, max_outer;
};

struct iris_map {
	int size;
	double extent;
	float *u, *v;  // [size][size] photo px; NAN beyond `radius` or where no path leads
	float *rim;    // [size][size] mm from the axis at which the path leaves the cornea
};

/* From a photo pixel to the iris plane: Snell's law at the cornea.
 * P    out: the point (x, y) in this photograph's own eye frame, mm
 * rim  out: distance from the axis at which the ray enters the cornea, mm; may be null
 * False when the ray misses the cornea or the plane. */
bool iris_see(double P[2], double *rim, const struct iris_view *view, const double px[2]);

/* From a point P of the iris plane (this photograph's own frame) to the photo pixel that shows it: the exact light path. rim as
 * above. False when no path leads to the camera. */
bool iris_find(double px[2], double *rim, const struct iris_view *view, const double P[2]);

/* iris_find for a whole map of size x size texels, those within `radius` mm of the axis. iris_map_free. */
struct iris_map iris_map_new(const struct iris_view *view, int size, double extent, double radius,
                             const struct iris_map_conf *conf);
void iris_map_free(struct iris_map *map);

/* iris_see for each pixel of the photograph: channels X and Y, mm, map frame. NAN where the ray misses the cornea, meets the iris
 * plane beyond `radius`, or enters the cornea farther than `rim` from the axis (mm). image_free. */
struct image iris_map_forward(const struct iris_view *view, double radius, double rim);

/* Resolution at the middle of the map, photo pixels a mm: the geometric mean over both directions. */
double iris_view_px_per_mm(const struct iris_view *view);

#endif
