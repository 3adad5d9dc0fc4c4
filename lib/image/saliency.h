/* saliency: where a picture draws the eye: Itti, Koch and Niebur 1998: intensity, colour and orientation, centre against
 * surround over nine scales, each feature map weighed by how far its highest peak stands out of the others; for video
 * also flicker (Itti 2003). And who looks next: the highest place that was not looked at just now.
 */
#ifndef IMAGE_SALIENCY_H
#define IMAGE_SALIENCY_H
#include <stdbool.h>

enum { SALIENCY_SIZE = 512 };  // px of the longer side the model works at

struct saliency {
	int width, height;     // of the map: 1/16 of the working size
	float *map;            // [height][width] 0..1
	double *inhibited;     // [height][width] 0..1, what was looked at; kept from frame to frame
	float *last;           // intensity of the last frame at the working size, for flicker
	int last_width, last_height;
};

/* rgb[height][stride] 8-bit sRGB, 3 bytes a pixel. The first frame has no flicker. The same saliency for all frames of one
 * video: what it remembers is of one size. */
void saliency_push(struct saliency *s, const unsigned char *rgb, int width, int height, int stride);

/* The most salient place not inhibited, share of width and height 0..1 from the top left; false where the map is flat. */
bool saliency_next(double at[2], const struct saliency *s);

/* Inhibits a disk about a place (radius: share of the shorter side); lets all inhibition decay by exp(-seconds / tau). */
void saliency_inhibit(struct saliency *s, const double at[2], double radius);
void saliency_decay(struct saliency *s, double seconds, double tau);

void saliency_free(struct saliency *s);

#endif
