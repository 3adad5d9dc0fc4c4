/* lod: fewer triangles, by meshoptimizer. */
#ifndef EXPORT_LOD_H
#define EXPORT_LOD_H
#include "export/part.h"

/* A part with at most about `triangles` triangles of the whole one's vertices, in the order of use. Borders stay, so that parts that meet go on
 * meeting. error_mm: distance that meshoptimizer states between the surfaces, in its quadric measure.
 * Returns a part of its own; export_part_free. */
struct export_part export_lod(const struct export_part *whole, int triangles, double *error_mm);

#endif
