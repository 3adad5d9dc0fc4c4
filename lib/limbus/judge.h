/* judge: tests whether a measured ellipse is a limbus. Internal to limbus_find.
 */
#ifndef LIMBUS_JUDGE_H
#define LIMBUS_JUDGE_H
#include "limbus/find.h"

extern const char LIMBUS_COVERED[], LIMBUS_UNCLEAR[], LIMBUS_PUPIL[];
#define LIMBUS_PIXEL_RMS 0.4   // px of scatter that pixels and their noise cause in any case
#define LIMBUS_EXACT 0.004     // scatter, share of the semi-axis, that nothing but a limbus or a pupil stays below
#define LIMBUS_CENTRED 0.12    // limbus_pupil_off of true ones, at most

/* The first test that a measured ellipse fails, as a reason for the user; null when it passes all. */
const char *limbus_judge(const struct rim *rim, const struct photo *photo, const struct pyramid *pyramid,
                         const struct limbus_conf *conf);

/* Distance between the centres of an ellipse and of the pupil seen in it, share of the semi-axis; NAN: no pupil is seen. */
double limbus_pupil_off(const struct ellipse *e, const struct photo *photo, const struct pyramid *pyramid,
                        const struct limbus_conf *conf);

/* True where the edge scatters so little, or the pupil lies so well in the middle, that the ellipse is no coincidence. */
bool limbus_sure(const struct rim *rim, double pupil_off, const struct photo *photo, const struct pyramid *pyramid);

/* True where the inside is as dark as pupils and brown irises are. bright: pyramid.bright[0]. */
bool limbus_is_dark(const struct ellipse *e, const struct grey *bright);

/* True where a larger circle round it has clear sides: a score of limbus_flank_around above `least`. */
bool limbus_has_sides_around(const struct ellipse *e, const struct photo *photo, double least);

/* True where the ellipse reaches out of the photograph. */
bool limbus_is_cut(const struct ellipse *e, const struct photo *photo);
/* True where e is smaller than `around` and lies inside it. */
bool limbus_within(const struct ellipse *e, const struct ellipse *around);
#endif
