/* refraction_file: the refraction function in a file, IRIS/refraction.exr: channels X, Y, Z, float.
 * Row 0, X: constants, in order: format (2), method, steps, degree, points, thetas, phis, R, p, n, rim, depth, radius,
 * error_mm, worst_mm, mean_mm, number of data. From row 1 on, row by row, the data: of a polynomial the coefficients of
 * gamma (X) and beta (Y); of a table K in mm, one row for each point of the radius, its columns angle from the axis × azimuth;
 * of the closed-form start nothing. lib/optics/refraction/refraction.h says what they mean.
 */
#ifndef IRIS_REFRACTION_FILE_H
#define IRIS_REFRACTION_FILE_H
#include "base/err.h"
#include "optics/refraction/refraction.h"

/* Writes it beside `path`, then renames it. made_by: stage_made_by(). False, err set, when it cannot. */
bool refraction_save(const struct refraction *f, const char *path, const char *made_by, struct err *err);

/* Reads one. f: overwritten; refraction_free. False, err set, for a file that is no refraction function. */
bool refraction_load(struct refraction *f, const char *path, struct err *err);

#endif
