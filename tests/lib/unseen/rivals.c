#include "tests/lib/unseen/rivals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/mem.h"
#include "bridge/cv_ellipse.h"
#include "tests/bench/integro.h"
#include "tests/peers/radial_search.h"
#include "tests/peers/swirski.h"

const char *const rival_name[RIVALS] = { "radial search", "OpenCV Hough circle", "integro-differential operator", "Swirski's" };

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void rival_answer(struct answer *out, enum rival rival, const struct photo *photo)
{
	static const int longest[RIVALS] = { 1 << 20, 640, 320, 320 };
	const int longer = photo->width > photo->height ? photo->width : photo->height, n = (longer + longest[rival] - 1) / longest[rival];
	const int w = photo->width / n, h = photo->height / n;
	// What the split holds: 30 px and more, within the frame.
	const double most = 0.5 * fmin(w, h), least = fmax(30.0 / n, 3);
	const double start = now();
	uint8_t *full = mem_array((size_t)photo->width * (size_t)photo->height, 1), *grey;
	for (long i = 0; i < (long)photo->width * photo->height; i++)
		full[i] = (uint8_t)((photo->rgb[3 * i] + 2 * photo->rgb[3 * i + 1] + photo->rgb[3 * i + 2]) / 4 >> 8);
	radial_shrink(&grey, full, photo->width, photo->height, n);
	*out = (struct answer){ .theta = NAN, .theta_sigma = NAN, .weak = NAN };
	struct ellipse *e = &out->e;
	switch (rival) {
	case RIVAL_RADIAL: out->ok = radial_search(e, grey, w, h, least, most); break;
	case RIVAL_HOUGH: out->ok = cv_hough_circle(e, grey, w, h, least, most); break;
	case RIVAL_INTEGRO: out->ok = integro_circle(e, grey, w, h, least, most); break;
	default: out->ok = swirski_ellipse(e, grey, w, h, least, most); break;
	}
	*e = (struct ellipse){ n * e->cx, n * e->cy, n * e->a, n * e->b, e->angle };
	out->seconds = now() - start;
	if (out->ok)
		out->weak = acos(fmin(e->b / e->a, 1));
	else
		snprintf(out->reason, sizeof out->reason, "nothing found");
	free(full);
	free(grey);
}
