/* bell: smoothing by a bell that is its own transpose, as least squares need it, in a time that does not depend on its width. */
#ifndef TISSUE_RELIEF_BELL_H
#define TISSUE_RELIEF_BELL_H

/* map[n][n] is smoothed `twice` times, each time by two boxes along either axis, of fractional width (Gwosdek et al. 2011); what lies beyond the
 * map is 0. Each time is a symmetric matrix with no negative eigenvalue; two times are near a Gaussian of standard deviation sigma, texels: one
 * time is half of its variance. scratch[n][n]. The same bits for any number of threads. */
void bell_blur(float *map, int n, double sigma, int twice, float *scratch);

#endif
