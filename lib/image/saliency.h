/* saliency: the bottom-up saliency map of Itti, Koch and Niebur 1998. Features: intensity, colour opponency, orientation,
 * each as centre-surround differences over nine scales, normalised so that a map with one high peak weighs more than one with
 * many alike; for video also flicker (Itti 2003). saliency_pick.h chooses where to look in it.
 */
#ifndef IMAGE_SALIENCY_H
#define IMAGE_SALIENCY_H
#include <stdbool.h>

enum { SALIENCY_SIZE = 512 };  // px of the longer side that the model works at

/* Zeroed before the first frame; saliency_free. */
struct saliency {
	int width, height;     // of the map: 1/16 of the working size
	float *map;            // [height][width], saliency 0..1
	double *inhibited;     // [height][width], inhibition of return 0..1; kept from frame to frame
	float *last;           // intensity of the last frame at the working size, for flicker
	int last_width, last_height;
};

/* Computes the map of the next frame.
 * s    one for all frames of a video, which have one size; the first frame has no flicker
 * rgb  [height][stride] bytes, 8-bit sRGB, 3 bytes a pixel */
void saliency_push(struct saliency *s, const unsigned char *rgb, int width, int height, int stride);
void saliency_free(struct saliency *s);

#endif
