/* sheet: a bumpy sheet of skin as a height field, at any fineness and with things wrong with it, for registration tests.
 * Frame: x and y over [-60, 60] x [-60, 60] mm, z out; every sheet is the same surface.
 */
#ifndef TESTS_SHEET_H
#define TESTS_SHEET_H
#include <stdbool.h>

#include "mesh/mesh.h"

/* Height of the surface, mm: a nose, two sockets, a chin, nothing symmetric. */
double sheet_height(double x, double y);

/* n x m vertices. slits: two eye openings are cut out. mesh_free. */
struct mesh sheet_make(int n, int m, bool slits);

/* b after a, its vertices behind a's. Frees neither. */
struct mesh sheet_joined(const struct mesh *a, const struct mesh *b);

/* vertices = scale R p + shift, R about the axis (1, 1, 1) by `angle`. */
void sheet_move(struct mesh *mesh, double scale, double angle, const double shift[3]);

#endif
