/* cut: where a video jumps from one view to another. */
#ifndef IMAGE_CUT_H
#define IMAGE_CUT_H
#include <stdbool.h>
#include <stdint.h>

enum { CUT_WIDTH = 32, CUT_HEIGHT = 18 };

/* What is kept of a frame: brightness averaged over a coarse grid. */
struct cut_view {
	float cell[CUT_HEIGHT * CUT_WIDTH];
};

struct cut_finder {
	struct cut_view last;
	double usual;         // running mean of how much frames differ
	long frames;
};

void cut_view_of(struct cut_view *view, const uint8_t *luma, int stride, int width, int height);

/* 1 - correlation of two views: 0 the same picture, whatever its brightness and contrast; 1 nothing in common. */
double cut_difference(const struct cut_view *a, const struct cut_view *b);

/* Frames in order, from a zeroed finder. True when this one does not follow from the one before: it differs by more
 * than `least` (1 - correlation), and by many times what frames of this video differ otherwise. */
bool cut_found(struct cut_finder *finder, const struct cut_view *view, double least);

#endif
