/* plane: single-channel maps, row-major [height][width]: blur and interpolation.
 * Places are px, x right, y down; the centre of the first pixel is (0.5, 0.5).
 */
#ifndef IMAGE_PLANE_H
#define IMAGE_PLANE_H

/* Gaussian blur in place by three box blurs (error below 3 % of the peak); the border pixels are repeated outwards.
 * sigma: px. */
void plane_blur(float *px, int width, int height, double sigma);

/* Normalised convolution in place: blur(px weight) / blur(weight).
 * weight    [height][width], >= 0; px is not read where it is 0
 * fallback  the value where no weight reaches */
void plane_blur_weighted(float *px, const float *weight, int width, int height, double sigma, float fallback);

/* Value at (x, y) px, bilinear, clamped at the borders. */
float plane_sample(const float *px, int width, int height, double x, double y);

#endif
