#include "image/saliency_pick.h"

#include <math.h>

bool saliency_next(double place[2], const struct saliency *s)
{
	double best = 1e-6;
	int found = -1;
	for (int i = 0; i < s->width * s->height; i++) {
		double v = s->map[i] * (1 - s->inhibited[i]);
		found = v > best ? i : found;
		best = fmax(best, v);
	}
	place[0] = found < 0 ? 0.5 : (found % s->width + 0.5) / s->width;
	place[1] = found < 0 ? 0.5 : (found / s->width + 0.5) / s->height;
	return found >= 0;
}

void saliency_inhibit(struct saliency *s, const double place[2], double radius)
{
	double r = radius * (s->width < s->height ? s->width : s->height);
	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++) {
			double d = hypot(x + 0.5 - place[0] * s->width, y + 0.5 - place[1] * s->height);
			double to = d <= r ? 1 : exp(-(d - r) * (d - r) / (0.5 * r * r));
			double *was = &s->inhibited[y * s->width + x];
			*was = fmax(*was, to);
		}
}

void saliency_decay(struct saliency *s, double seconds, double tau)
{
	double keep = exp(-seconds / tau);
	for (int i = 0; i < s->width * s->height; i++)
		s->inhibited[i] *= keep;
}
