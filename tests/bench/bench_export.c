/* The eye for other programs: how long its export takes at each quality, and what a rasteriser loses of it, from the same run. Time is
 * that of `render --only=export` as a whole, with the photograph decoded and its colours fitted.
 */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"

static const char *const qualities[] = { "draft", "review", "final" };

static void export(void *ctx)
{
	char *command = mem_printf("bin/render --capture='%s' --only=export --force --quiet", (const char *)ctx);
	if (system(command))
		fprintf(stderr, "bench_export: %s failed\n", command);
	free(command);
}

/* Entry `view` of "lost": 0, 30, 60 degrees. */
static double lost(const json_t *says, size_t view, const char *key)
{
	const json_t *number = json_object_get(json_array_get(json_object_get(says, "lost"), view), key);
	return json_is_number(number) ? json_number_value(number) : NAN;
}

static void quality(const char *name)
{
	const char *dir = scratch_path("%s", name);
	char *make = mem_printf("mkdir -p '%s' && cp -r samples/demo/capture.conf samples/demo/photos '%s' && echo 'quality = %s' >> '%s/capture.conf' && "
	                        "make --no-print-directory CAPTURE='%s' export > /dev/null 2>&1", dir, dir, name, dir, dir);
	bool made = !system(make);
	free(make);
	struct bench_time time = { NAN, NAN, NAN };
	if (made)
		time = bench_time(export, (void *)(size_t)dir, bench_quick() ? 3 : 9);
	struct err err = { 0 };
	char *path = mem_printf("%s/work/export/eye.json", dir);
	json_t *says = json_read(path, 1 << 20, &err);
	bench_row("eye for other programs", "export", name, time, "eye", lost(says, 1, "refraction_mm_mean"), "mm", "refraction by a rasteriser at 30 degrees, mean");
	bench_row("eye in a rasteriser, colour", "export", name, time, "eye", lost(says, 0, "eye_difference_mean"), "CIEDE2000", "over the eye at 0 degrees");
	if (!strcmp(name, "review")) {
		bench_goal("export of an eye at review", "at most 3 s", time.median, "s", time.median <= 3);
		bench_goal("a rasteriser's picture of it at 0 degrees", "mean difference at most 3", lost(says, 0, "eye_difference_mean"), "CIEDE2000",
		           lost(says, 0, "eye_difference_mean") <= 3);
		bench_goal("a rasteriser's picture of it at 30 degrees", "mean difference at most 3", lost(says, 1, "eye_difference_mean"), "CIEDE2000",
		           lost(says, 1, "eye_difference_mean") <= 3);
	}
	json_decref(says);
	free(path);
}

int main(int argc, char **argv)
{
	bench_open("export", argc, argv);
	scratch_open();
	for (size_t i = 0; i < sizeof qualities / sizeof *qualities; i++)
		quality(qualities[i]);
	scratch_close();
	return bench_close();
}
