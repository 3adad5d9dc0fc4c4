/* Fronts of `render`: what the look of the eye costs, on the bundled photograph: pictures as large and as many as a review has, but its
 * film, and their mean difference from those at the finest setting. On few small pictures the march from texels, once a view, would
 * look dear.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/exr.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/bench/fronts.h"
#include "tests/lib/scratch.h"

static bool load(struct image *image, const char *folder, const char *file)
{
	static const char *const rgba[] = { "R", "G", "B", "A" };
	struct exr_info info = { 0 };
	struct err err = { 0 };
	char *path = mem_printf("%s/render/%s", folder, file);
	bool ok = exr_read(image, path, 4, rgba, 1 << 24, &info, &err);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	free(path);
	return ok;
}

/* Mean difference over mean value where the eye covers the pixel, of the view from the front and the turned one, percent. */
static double off_finest(const char *capture, const char *reference)
{
	static const char *const files[] = { "front.exr", "three_quarter.exr" };
	double off = 0, all = 0;
	char *work = mem_printf("%s/work", capture);
	for (int f = 0; f < COUNT(files); f++) {
		struct image a = { 0 }, b = { 0 };
		if (load(&a, work, files[f]) && load(&b, reference, files[f]) && a.width == b.width && a.height == b.height)
			for (long i = 0; i < (long)a.width * a.height; i++)
				for (int c = 0; c < 3 && b.px[4 * i + 3] > 0.5f; c++) {
					off += fabs((double)(a.px[4 * i + c] - b.px[4 * i + c]));
					all += (double)b.px[4 * i + c];
				}
		else
			off = NAN;
		image_free(&a);
		image_free(&b);
	}
	free(work);
	return 100 * off / all;
}

static const struct fronts_stage render = {
	.stage = "render", .keys = "map_size, search, shadow, steps, shading, shading_apart, bands, lights, passes, samples",
	.always = "--size_px=900, --frames=7, --film=no, --exr=yes",
	.finest = { "finest", "2048, 24, 12, 16, rays, 1, 6, 32, 8, 4" },
	.more = { { "fewer_beams", "1024, 8, 4, 3, texels, 2, 4, 4, 1, 2" },
		  { "more_beams", "1024, 8, 4, 3, texels, 2, 4, 16, 1, 2" }, { "every_texel", "1024, 8, 4, 3, texels, 1, 4, 8, 1, 2" },
		  { "rays", "1024, 8, 4, 3, rays, 1, 4, 8, 1, 2" }, 
		  { "texels_converged", "2048, 16, 8, 3, texels, 1, 4, 16, 4, 2" } },
	.unit = "%", .error_of = "pictures of 900 px, mean difference from the finest", .error = off_finest, .reps = 3,
};

int main(int argc, char **argv)
{
	struct err err = { 0 };
	bench_open("fronts_render", argc, argv);
	if (fronts_left_out())
		return bench_close();
	scratch_open();
	char *dir = mem_str(scratch_path("big"));
	char *command = mem_printf("mkdir -p '%s/photos' && cp samples/demo/capture.conf '%s' && cp samples/demo/photos/right_softbox.jpg '%s/photos'", dir, dir, dir);
	if (!system(command) && fronts_make(dir, "render"))
		fronts_measure(&render, dir, 0, (const double[2]){ 1.92, 0 });
	if (!fronts_write(bench_out(), "fronts_render", &err))
		fprintf(stderr, "%s\n", err.msg);
	scratch_close();
	free(command);
	free(dir);
	return bench_close();
}
