/* overlay: the photograph with what was found drawn over it. */
#ifndef LIMBUS_OVERLAY_H
#define LIMBUS_OVERLAY_H
#include "anatomy/fit.h"
#include "limbus/record.h"

/* Draws limbus and pupil ellipses, the edge points that were used (dots), hidden stretches, and the optical axis out of the eye; of a refused
 * photograph the likeliest ellipse and its rival.
 * Of an eye that is small in its photograph, the surroundings of that eye alone.
 * Returns 8-bit RGB [height][width][3], the longer side at most most_px; free(). width, height: out. */
uint8_t *limbus_overlay(int *width, int *height, int most_px, const struct photo *photo, const struct limbus_record *record,
                        const struct fit *fit);

#endif
