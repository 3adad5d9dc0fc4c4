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

/* Finds centres by k-means on rows x[n_rows][q] of weights w[n_rows] >= 0; the result depends on the seed alone. Inputs should be
 * of comparable scale.
 * functions  how many centres; at most the number of rows
 * rbf_free. */
void rbf_centers(struct rbf *rbf, int functions, long n_rows, int q, const double *x, const double *w, uint64_t seed);

/* Fits the output layer to y[n_rows][r] by ridge regression; may be called again with another width or ridge.
 * width  of the Gaussians, in units of the mean distance between a centre and the nearest other one
 * ridge  penalty on the weights, >= 0 */
void rbf_train(struct rbf *rbf, double width, double ridge, long n_rows, int r, const double *x, const double *y,
               const double *w);

/* y[n_rows][r] of inputs x[n_rows][q]. */
void rbf_predict(double *y, const struct rbf *rbf, long n_rows, const double *x);
void rbf_free(struct rbf *rbf);

#endif
