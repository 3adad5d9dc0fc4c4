/* The parts refraction.c is put together from: polynomial and table. */
#ifndef OPTICS_REFRACTION_PARTS_H
#define OPTICS_REFRACTION_PARTS_H
#include "optics/refraction/refraction.h"

/* Number of coefficients of gamma, and of beta: monomials of total degree <= degree in three variables. */
int refraction_monomials(int degree);

/* Fits the polynomials to the solver's K over the iris and the hemisphere (and 5 degrees below), by least squares.
 * Fills f->data. False where the light reaches too little of the iris for that. */
bool refraction_fit(struct refraction *f);

/* Directions from P towards K for lightpath_batch_from(), of any length. f->degree >= 1. */
void refraction_start(const struct refraction *f, int n, const float *px, const float *py, const float *wx, const float *wy,
                      const float *wz, float *qx, float *qy, float *qz);

/* Largest w_z for which the polynomial is good. */
#define REFRACTION_BEHIND 0.087f

void refraction_tabulate(struct refraction *f);
void refraction_look_up(const struct refraction *f, int n, const float *px, const float *py, const float *wx,
                        const float *wy, const float *wz, float *kx, float *ky, float *kz);

#endif
