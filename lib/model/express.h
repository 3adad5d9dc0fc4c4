/* express: how far lids go with expressions. Apertures are inputs of their own (model/model.h), so that an expression that is set moves skin alone; what lids did with it in the
 * film is added to the apertures that gaze gives (eq. 3.11): everything that sets an expression adds it here.
 *
 *     a[4] = c A [g1 g2 1] + min(c, 1) sum_k w_k by[k]
 *
 * c: how far the eye is open, of what is usual there (so that it shuts as ever), w_k: strengths, 0..1. An eye is opened no further by it than wide open (a = 1), and shut no further than
 * shut (a = 0, both lids together: one may go on where the other makes way), unless it was so before. */
#ifndef MODEL_EXPRESS_H
#define MODEL_EXPRESS_H

/* Apertures in the order g4 g5 (left), g9 g10 (right). */
enum { EXPRESS_LIDS = 4 };

/* Adds to one eye's apertures.
 * aperture  [2] controls g~ of its upper and its lower lid, in and out
 * eye       0 left, 1 right
 * n, w      expressions; [n] their strengths, a NAN counts as 0
 * by        [n][4] of each in full, controls g~
 * px        [4] of each aperture from 0 to 1: what both lids leave open together is px . a
 * open      c: how far the eye is open of what is usual */
void express_eye(double aperture[2], int eye, int n, const double *w, const double (*by)[EXPRESS_LIDS], const double px[EXPRESS_LIDS], double open);

#endif
