/* limbus_judge: what speaks against a measured ellipse being a limbus, and the search by the limbus' two sides.
 * Internal to limbus_find.
 */
#ifndef LIMBUS_JUDGE_H
#define LIMBUS_JUDGE_H
#include "limbus/find.h"

extern const char LIMBUS_COVERED[], LIMBUS_UNCLEAR[], LIMBUS_PUPIL[];
#define LIMBUS_PIXEL_RMS 0.4   // px of scatter that pixels and their noise cause in any case
#define LIMBUS_EXACT 0.004     // scatter, share of the semi-axis, that nothing but a limbus or a pupil stays below
#define LIMBUS_CENTRED 0.12    // limbus_pupil_off of true ones, at most

/* The first reason against a measured ellipse, or null. */
const char *limbus_judge(const struct rim *rim, const struct photo *photo, const struct pyramid *pyramid,
                         const struct limbus_conf *conf);

/* Centre of the pupil that is seen in an ellipse off the ellipse's, share of its semi-axis; NAN: none is seen. */
double limbus_pupil_off(const struct ellipse *e, const struct photo *photo, const struct pyramid *pyramid,
                        const struct limbus_conf *conf);

/* So exact, or with a pupil so well in its middle, that chance does not make it. */
bool limbus_sure(const struct rim *rim, double pupil_off, const struct photo *photo, const struct pyramid *pyramid);

/* Dark inside as pupils and brown irises are. bright: level 0. */
bool limbus_is_dark(const struct ellipse *e, const struct grey *bright);

/* The sides of something larger are round it, of that score of limbus_flank_around. */
bool limbus_has_sides_around(const struct ellipse *e, const struct photo *photo, double least);

bool limbus_is_cut(const struct ellipse *e, const struct photo *photo);
/* Smaller and inside. */
bool limbus_within(const struct ellipse *e, const struct ellipse *around);
#endif
