/* limbus_overlay: the photograph with what was found drawn over it. */
#ifndef LIMBUS_OVERLAY_H
#define LIMBUS_OVERLAY_H
#include "anatomy/fit.h"
#include "limbus/record.h"

/* 8-bit RGB, longer side at most most_px: limbus and pupil ellipses, edge points that were used (dots) and
 * stretches that are hidden, the optical axis out of the eye. Size in *width, *height; free(). */
uint8_t *limbus_overlay(int *width, int *height, int most_px, const struct photo *photo, const struct limbus_record *record,
                        const struct fit *fit);

#endif
