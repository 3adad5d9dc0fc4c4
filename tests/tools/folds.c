/* folds FOUND.json DRAWN.json: wrinkle lines that `track` found (work/skin/wrinkles.json) against those that were drawn into the clip (samples/face/truth/folds.json), on the
 * neutral mesh, mm. Prints a line an expression: its name, mm of lines found, the share of their points that lie within 1 mm of a drawn course, the median distance of these,
 * the share of the drawn courses' points with a found line within 1.5 mm, and the medians of depth and half width at the peak over what was drawn, at points that lie so near. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "math/stats.h"

enum { MOST = 20000 };

struct place {
	double x[3], depth, width;
};

static double number(const json_t *o, const char *key)
{
	return json_number_value(json_object_get(o, key));
}

static void put(struct place *p, const json_t *x, double depth, double width)
{
	for (int d = 0; d < 3; d++)
		p->x[d] = json_number_value(json_array_get(x, (size_t)d));
	p->depth = depth;
	p->width = width;
}

/* Points that were found of an expression; *mm: length of its lines; *peak: their last frame. */
static int found_of(struct place *p, double *mm, int *peak, const json_t *expression)
{
	int n = 0;
	size_t i, k;
	const json_t *line, *point, *frames = json_object_get(expression, "frames");
	*mm = 0;
	*peak = (int)json_integer_value(json_array_get(frames, json_array_size(frames) - 1));
	json_array_foreach(json_object_get(expression, "lines"), i, line) {
		*mm += number(line, "length_mm");
		json_array_foreach(json_object_get(line, "points"), k, point)
			if (n < MOST)
				put(&p[n++], json_object_get(point, "head_mm"), number(point, "depth_mm"), number(point, "half_width_mm"));
	}
	return n;
}

/* The same of what was drawn, ten places between any two, as deep as in frame `peak`. */
static int drawn_of(struct place *p, const json_t *drawn, const char *name, int peak)
{
	int n = 0;
	size_t i;
	const json_t *fold;
	const double share = json_number_value(json_array_get(json_object_get(json_object_get(drawn, "share"), name), (size_t)peak));
	json_array_foreach(json_object_get(drawn, "folds"), i, fold) {
		const json_t *x = json_object_get(fold, "head_mm"), *depth = json_object_get(fold, "depth_mm");
		if (strcmp(json_string_value(json_object_get(fold, "expression")), name))
			continue;
		for (size_t k = 0; k + 1 < json_array_size(x); k++)
			for (int j = 0; j < 10 && n < MOST; j++) {
				struct place a, b;
				put(&a, json_array_get(x, k), json_number_value(json_array_get(depth, k)), number(fold, "half_width_mm"));
				put(&b, json_array_get(x, k + 1), json_number_value(json_array_get(depth, k + 1)), a.width);
				for (int d = 0; d < 3; d++)
					p[n].x[d] = a.x[d] + 0.1 * j * (b.x[d] - a.x[d]);
				p[n].depth = share * (a.depth + 0.1 * j * (b.depth - a.depth));
				p[n++].width = a.width;
			}
	}
	return n;
}

static double nearest(int *which, const struct place *of, const struct place *in, int n)
{
	double best = INFINITY;
	for (int i = 0; i < n; i++) {
		const double d = hypot(hypot(of->x[0] - in[i].x[0], of->x[1] - in[i].x[1]), of->x[2] - in[i].x[2]);
		if (d < best) {
			best = d;
			*which = i;
		}
	}
	return best;
}

int main(int argc, char **argv)
{
	json_t *found = argc == 3 ? json_load_file(argv[1], 0, 0) : 0, *drawn = argc == 3 ? json_load_file(argv[2], 0, 0) : 0;
	if (!found || !drawn) {
		fputs("folds: FOUND.json DRAWN.json\n", stderr);
		return 1;
	}
	static struct place was[MOST], got[MOST];
	static double off[MOST], depth[MOST], width[MOST];
	size_t e;
	const json_t *expression;
	json_array_foreach(json_object_get(found, "expressions"), e, expression) {
		const char *name = json_string_value(json_object_get(expression, "name"));
		double mm;
		int peak, near = 0, seen = 0, at;
		const int n = found_of(got, &mm, &peak, expression), m = drawn_of(was, drawn, name, peak);
		for (int i = 0; i < n; i++)
			if ((off[near] = nearest(&at, &got[i], was, m)) < 1) {
				depth[near] = got[i].depth / was[at].depth;
				width[near++] = got[i].width / was[at].width;
			}
		for (int i = 0; i < m; i++)
			seen += nearest(&at, &was[i], got, n) < 1.5;
		printf("%s %.1f mm on_course %.2f off %.2f mm covered %.2f depth %.2f width %.2f\n", name, mm, (double)near / n, stats_median(near, off), (double)seen / m, stats_median(near, depth),
		       stats_median(near, width));
	}
	json_decref(found);
	json_decref(drawn);
	return 0;
}
