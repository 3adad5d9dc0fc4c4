/* rice: the tilt of an eye near the front. An ellipse's shape tells a vector whose length is the square of the tilt: noise makes it longer, never
 * shorter, so that eyes that look into the lens seem tilted. Its length is of Rice's distribution (Rice 1945).
 */
#ifndef LIMBUS_RICE_H
#define LIMBUS_RICE_H

/* Mean and standard deviation of a tilt, rad, of which theta was measured and sigma is that of its square, each way: all directions of sight as
 * likely, but for a Gaussian of standard deviation prior round the front (0: none). Sharp measurements stay as they are. */
void rice_tilt(double *mean, double *deviation, double theta, double sigma, double prior);

#endif
