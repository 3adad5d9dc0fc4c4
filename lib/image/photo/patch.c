#include "image/photo/patch.h"

#include <math.h>

static const double clipped = 0.93;  // linear; above it a channel has lost its slope in most cameras' curves

bool photo_patch(double rgb[3], const struct photo *photo, double x, double y, double radius)
{
	int r = (int)fmax(radius, 0), x0 = (int)floor(x) - r, y0 = (int)floor(y) - r, size = 2 * r + 1;
	if (x0 < 0 || y0 < 0 || x0 + size > photo->width || y0 + size > photo->height)
		return false;
	struct image part = photo_linear(photo, x0, y0, size, size);
	rgb[0] = rgb[1] = rgb[2] = 0;
	bool ok = true;
	for (int i = 0; i < 3 * size * size; i++) {
		rgb[i % 3] += part.px[i] / (size * size);
		ok = ok && part.px[i] < clipped;
	}
	image_free(&part);
	return ok;
}
