/* rbf: a network of one layer of Gaussian radial basis functions and a linear output layer: centres by k-means, one
 * common width, output weights by ridge regression (Broomhead and Lowe 1988; Moody and Darken 1989). */
#ifndef MATH_RBF_H
#define MATH_RBF_H
#include <stdint.h>

struct rbf {
	int q, r, n;       // inputs, outputs, functions
	double *center;    // [n][q]
	double width;      // sigma of the Gaussian, in the unit of the inputs
	double *weight;    // [r][n]
	double *constant;  // [r]
};

/* Centres for rows x[n_rows][q] of weights w >= 0, chosen anew for every seed alone. Inputs should be of comparable
 * scale. The number of functions is lowered to the number of rows. rbf_free. */
void rbf_centers(struct rbf *rbf, int functions, long n_rows, int q, const double *x, const double *w, uint64_t seed);

/* The output layer for y[n_rows][r]; width: in units of the mean distance of a centre from the nearest other. May be
 * called again with another width or ridge. */
void rbf_train(struct rbf *rbf, double width, double ridge, long n_rows, int r, const double *x, const double *y,
               const double *w);

void rbf_predict(double *y, const struct rbf *rbf, long n_rows, const double *x);
void rbf_free(struct rbf *rbf);

#endif
