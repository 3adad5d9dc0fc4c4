/* table: the refraction function tabulated, as the iris paper has it: the baseline. For refraction.c alone. */
#ifndef OPTICS_REFRACTION_TABLE_H
#define OPTICS_REFRACTION_TABLE_H
#include "optics/refraction/refraction.h"

/* Fills f->data with K at f->points radii, f->thetas angles from the axis and f->phis azimuths. */
void refraction_tabulate(struct refraction *f);

/* K[n] of P[n] on the iris plane and directions w[n], mm, interpolated or nearest as f->method says. Structure of arrays. */
void refraction_look_up(const struct refraction *f, int n, const float *px, const float *py, const float *wx,
                        const float *wy, const float *wz, float *kx, float *ky, float *kz);

#endif
