/* rice: the tilt of an eye near the front. An ellipse's shape tells a vector whose length is the square of the tilt, and whose angle twice its
 * direction: noise makes it longer, never shorter, so that eyes that look into the lens seem tilted. Where the noise is the same each way its
 * length is of Rice's distribution (Rice 1945), else of Beckmann's (1962).
 */
#ifndef LIMBUS_RICE_H
#define LIMBUS_RICE_H

/* Sigma of a tilt's square, of the tilt and its sigma. */
double rice_square_sigma(double theta, double sigma);

/* Mean and standard deviation of a tilt, rad, that was measured as theta, with sigma of its square, the same each way. All directions of sight are as
 * likely, but for a Gaussian of standard deviation prior round the front (0: none). Sharp measurements stay as they are. */
void rice_tilt(double *mean, double *deviation, double theta, double sigma, double prior);

/* Log of the probability of that measurement, up to a constant: large tilts are rarely seen just so. sigma > 0. */
double rice_log_evidence(double theta, double sigma, double prior);

/* How far the tilt is from `about`, root mean square, where theta was measured towards phi and the noise of the vector of its square and twice its
 * direction has covariance cov, rad^4: lids hide what would tell an eye's height, and its aspect is not known, so that it differs with direction. */
double rice_astray(double about, double theta, double phi, const double cov[2][2], double prior);

#endif
