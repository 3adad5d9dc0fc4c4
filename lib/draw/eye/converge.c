#include "draw/eye/converge.h"

#include <math.h>

#include "math/rng.h"

static float luminance(const float *p)
{
	return 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
}

/* Adds a pass, and the squares of its luminance. */
static void add(struct image *sum, float *square, const struct image *pass)
{
#pragma omp parallel for schedule(static)
	for (long i = 0; i < (long)sum->width * sum->height; i++) {
		float l = luminance(pass->px + 4 * i);
		square[i] += l * l;
		for (int c = 0; c < 4; c++)
			sum->px[4 * i + c] += pass->px[4 * i + c];
	}
}

/* Mean standard error of the mean of n passes, relative to the mean luminance. */
static double standard_error(const struct image *mean, const float *square, int n)
{
	double off = 0, all = 0;
	for (long i = 0; i < (long)mean->width * mean->height; i++) {
		double l = luminance(mean->px + 4 * i), variance = square[i] / n - l * l;
		off += sqrt(fmax(variance, 0) / fmax(n - 1, 1));
		all += l;
	}
	return all > 0 ? off / all : 0;
}

struct image scene_converge(const struct scene *s, const struct scene_view *view, const struct envmap *env,
                            const struct envmap *mirror, int lights, int passes, double *error, struct scene_count *count)
{
	struct image sum = image_new(view->width, view->height, 4), square = image_new(view->width, view->height, 1);
	struct rng rng = { 77 };
	for (int k = 0; k < passes; k++) {
		struct scene_lighting light = { .env = env, .mirror = mirror };
		struct scene_view moved = *view;
		light.n = envmap_lights_drawn(light.light, lights, env, (uint64_t)k + 1);
		moved.x0 += view->scale * (rng_uniform(&rng) - 0.5);
		moved.y0 += view->scale * (rng_uniform(&rng) - 0.5);
		struct image pass = scene_render(s, &moved, &light, count);
		add(&sum, square.px, &pass);
		image_free(&pass);
	}
	for (long i = 0; i < 4L * sum.width * sum.height; i++)
		sum.px[i] /= (float)passes;
	if (error)
		*error = standard_error(&sum, square.px, passes);
	image_free(&square);
	return sum;
}
