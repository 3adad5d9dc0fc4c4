/* Geometry of the refracted iris: our renderer's picture of each rendered capture's eye against what an independent path tracer
 * made of it: by the map of iris points where there is one, and by registration with the photograph. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/score/registered.h"

enum { CAPTURES = 64 };
static const char *const ways[] = { "rays of sight (reference)", "texels (review)" };

/* Notes the worst median and 95 % of all captures. */
static void judge(double most[2], const char *method, const struct truth *t, int shading, struct registered *r)
{
	char setting[128];
	if (r->n < 20)
		return;
	double median = stats_quantile(r->n, r->px, 0.5), far = stats_quantile(r->n, r->px, 0.95);
	snprintf(setting, sizeof setting, "%s, %s, %d places", t->name, ways[shading], r->n);
	bench_row("geometry of the refracted iris", method, setting, (struct bench_time){ NAN, NAN, NAN }, "", median, "px", "offset, median");
	bench_row("geometry of the refracted iris", method, setting, (struct bench_time){ NAN, NAN, NAN }, "", far, "px", "offset, 95 %");
	most[0] = fmax(most[0], median);
	most[1] = fmax(most[1], far);
}

int main(int argc, char **argv)
{
	bench_open("geometry", argc, argv);
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES), seen = 0;
	double map[2] = { 0, 0 }, photo[2] = { 0, 0 };
	for (int i = 0; i < n; i++) {
		struct truth t;
		struct registered r;
		struct err err = { 0 };
		// Lit irises have relief and shadows that a texture by itself does not show.
		if (!truth_load(&t, dirs[i], &err) || t.name[0] == 'L' || (bench_quick() && seen >= 1))
			continue;
		seen++;
		if (registered_map(&r, &t, dirs[i], &err))
			judge(map, "map of iris points", &t, SCENE_RAYS, &r);
		registered_free(&r);
		for (int shading = SCENE_RAYS; shading <= SCENE_TEXELS; shading++) {
			if (registered_photo(&r, &t, dirs[i], shading, &err))
				judge(photo, "registration with the photograph", &t, shading, &r);
			registered_free(&r);
		}
	}
	for (int i = 0; i < n; i++)
		free(dirs[i]);
	if (seen) {
		bench_goal("geometry of the refracted iris: map of the independent ray tracer, 95 % of the pixels, worst capture", "<= 0.3 px", map[1], "px", map[1] <= 0.3);
		bench_goal("geometry of the refracted iris: registration with the captures, median, worst capture", "<= 0.3 px", photo[0], "px", photo[0] <= 0.3);
		bench_goal("geometry of the refracted iris: registration with the captures, 95 % of the patches, worst capture", "<= 0.3 px", photo[1], "px", photo[1] <= 0.3);
	}
	return bench_close();
}
