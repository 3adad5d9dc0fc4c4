/* poly: the polynomials that bend a ray inside, from which Newton's steps of a refraction function start. For refraction.c alone. */
#ifndef OPTICS_REFRACTION_POLY_H
#define OPTICS_REFRACTION_POLY_H
#include "optics/refraction/refraction.h"

/* Largest w_z for which the polynomial is good. */
#define REFRACTION_BEHIND 0.087f

/* Number of coefficients of gamma, and of beta: monomials of total degree <= degree in three variables. */
int refraction_monomials(int degree);

/* Fits the polynomials of degree f->degree to the solver's K over the iris and the hemisphere (and 5 degrees below), by linear least
 * squares. Fills f->data and f->n_data. Returns false where the light reaches too little of the iris for that. */
bool refraction_fit(struct refraction *f);

/* Directions q[n] from P towards K, of any length, for lightpath_batch_from(). Structure of arrays; f->degree >= 1. */
void refraction_start(const struct refraction *f, int n, const float *px, const float *py, const float *wx, const float *wy,
                      const float *wz, float *qx, float *qy, float *qz);

#endif
