/* unrefract_mask: what of a survey is not iris. Internal. */
#ifndef IRIS_UNREFRACT_MASK_H
#define IRIS_UNREFRACT_MASK_H
#include "iris/unrefract/unrefract.h"

/* The iris between pupil and limbus as a sheet: t runs from the pupil's margin (0) to the limbus (1). */
struct sheet {
	int size;
	double extent;        // of the planes, mm
	struct circle pupil;
	double limbus;        // mm
	const double *open;   // [SHEET_ANGLES] how sure it is that no lid covers the iris there, 0..1; null: unknown
};

enum { SHEET_RINGS = 64, SHEET_ANGLES = 360 };

double sheet_t(const struct sheet *sheet, double x, double y);
void sheet_point(double xy[2], const struct sheet *sheet, double t, double phi);

/* Robust level and spread of a plane on each ring, over the texels of `weight`. */
struct rings {
	float median[SHEET_RINGS], scale[SHEET_RINGS];
};
/* favour: what no lid covers counts more: where the sheet does not know, left and right. min_scale: floor of scale. */
struct rings rings_of(const float *plane, const float *weight, const struct sheet *sheet, bool favour,
                      float min_scale);
/* Where a ring's spread is that of the pupil's or the limbus' blur, that of the other rings counts. */
void rings_even(struct rings *rings);
float rings_median(const struct rings *rings, double t);
/* (value − median) / scale at parameter t. */
float rings_z(const struct rings *rings, float value, double t);

/* survey->rgb given: fills weight, lid_share, glint_share. seen: [size][size] 1 where the photograph shows the texel. */
void unrefract_mask(struct unrefract_survey *survey, const float *seen, const struct sheet *sheet,
                    const struct unrefract_conf *conf);

/* Part of the mask: for each angle, the parameter t beyond which a lid covers the iris; 1: open. */
void unrefract_lids(double lid_t[SHEET_ANGLES], const float *const logs[3], const float *weight,
                    const struct sheet *sheet, const struct unrefract_conf *conf);

#endif
