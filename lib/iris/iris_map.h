/* iris_map: where in a photograph each point of the iris plane is seen through the cornea, and the other way round.
 * Eye frame; the iris plane is z = depth, mm. Iris maps are square, centred on the axis: texel (col, row) is at
 * x = (col + ½) 2 extent / size − extent, y likewise, row 0 on −y.
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

/* One photograph's view of the iris plane. rim is no bound of the cornea here: paths that leave beyond the limbus
 * are followed, so that everything stays smooth; `rim` of the result says where they left. */
struct iris_view {
	const struct fit *fit;
	struct cornea cornea;   // without a rim
	double depth;           // of the iris plane, mm
	double a[2][3];         // this photograph's eye-frame point of the map's (x, y): a (x, y, 1); identity when alone
};

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

/* Point of the iris plane (this photograph's own frame) that a photo pixel sees, and where its ray enters the cornea,
 * mm from the axis. False when the ray misses. rim may be null. */
bool iris_see(double P[2], double *rim, const struct iris_view *view, const double px[2]);

/* Photo pixel in which a point (this photograph's own frame) is seen. rim may be null. */
bool iris_find(double px[2], double *rim, const struct iris_view *view, const double P[2]);

/* The inverse for a whole map, texels within `radius` mm of the axis. iris_map_free. */
struct iris_map iris_map_new(const struct iris_view *view, int size, double extent, double radius,
                             const struct iris_map_conf *conf);
void iris_map_free(struct iris_map *map);

/* X, Y (map frame) for each pixel of the photograph, exact; NAN where the ray misses the cornea or meets the plane
 * beyond `radius`, or further from the axis at the cornea than `rim`. Two channels; image_free. */
struct image iris_map_forward(const struct iris_view *view, double radius, double rim);

/* Photo pixels a mm at the middle of the map: the geometric mean over both directions. */
double iris_view_px_per_mm(const struct iris_view *view);

#endif
