/* Fronts of the skin column: knobs of `train`, `transfer` and `extrapolate` on the bundled clip and character, time and error of
 * the same run. train: error of lids and skin in frames held out, px of the video. transfer: how far the registered character
 * lies from where the finest setting puts it, mm. extrapolate: how far the maps of globes and skull are from the
 * finest ones, mm.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "image/exr.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/bench/fronts.h"
#include "tests/lib/scratch.h"

/* Mean over the model's parts. */
static double held_out(const char *capture, const char *reference)
{
	(void)reference;
	struct err err = { 0 };
	char *path = mem_printf("%s/work/skin/train.json", capture);
	json_t *json = json_read(path, 1 << 22, &err), *part;
	const char *key;
	double sum = 0;
	int n = 0;
	json_object_foreach(json, key, part) {
		json_t *px = json_object_get(part, "held_out_px");
		if (json_is_number(px)) {
			sum += json_number_value(px);
			n++;
		}
	}
	json_decref(json);
	free(path);
	return n ? sum / n : NAN;
}

static double registered_off(const char *capture, const char *reference)
{
	struct mesh a = { 0 }, b = { 0 };
	struct err err = { 0 };
	char *is = mem_printf("%s/work/targets/mpfb/registered.ply", capture), *was = mem_printf("%s/targets/mpfb/registered.ply", reference);
	double sum = NAN;
	if (om_mesh_load(&a, is, 1 << 22, &err) && om_mesh_load(&b, was, 1 << 22, &err) && a.n_vertices == b.n_vertices) {
		sum = 0;
		for (int i = 0; i < a.n_vertices; i++) {
			double d = 0;
			for (int k = 0; k < 3; k++)
				d = hypot(d, (double)(a.vertices[i][k] - b.vertices[i][k]));
			sum += d / a.n_vertices;
		}
		sum *= 10;  // the bundled meshes are in centimetres
	}
	mesh_free(&a);
	mesh_free(&b);
	free(is);
	free(was);
	return sum;
}

static bool map_of(struct image *map, const char *folder, const char *file, int n, const char *const channels[])
{
	struct exr_info info = { 0 };
	struct err err = { 0 };
	char *path = mem_printf("%s/targets/mpfb/%s", folder, file);
	bool ok = exr_read(map, path, n, channels, 1 << 26, &info, &err);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	free(path);
	return ok;
}

/* rms distance of a map's points from the finest one's, at the finest one's nodes. Both begin at one place; `whole`: they end at
 * one, too, else their steps are powers of two of each other. */
static double map_off(const char *capture, const char *reference, const char *file, int n, bool whole)
{
	static const char *const names[2][3] = { { "Y" }, { "R", "G", "B" } };
	struct image a = { 0 }, b = { 0 };
	char *work = mem_printf("%s/work", capture);
	double sum = 0;
	long count = 0;
	if (map_of(&a, work, file, n, names[n == 3]) && map_of(&b, reference, file, n, names[n == 3])) {
		double step = whole ? (a.width - 1.0) / (b.width - 1) : exp2(round(log2((double)a.width / b.width)));
		for (int y = 0; y < b.height; y++)
			for (int x = 0; x < b.width; x++) {
				double squared = 0;
				for (int c = 0; c < n; c++) {
					double d = (double)image_sample(&a, 0.5 + x * step, 0.5 + y * step, c) - (double)image_at(&b, x, y)[c];
					squared += d * d;
				}
				if (isfinite(squared)) {
					sum += squared;
					count++;
				}
			}
	}
	image_free(&a);
	image_free(&b);
	free(work);
	return count ? sqrt(sum / (double)count) : NAN;
}

/* The larger of the globes' and the skull's. */
static double maps_off(const char *capture, const char *reference)
{
	double globe = fmax(map_off(capture, reference, "globe_left.exr", 1, true), map_off(capture, reference, "globe_right.exr", 1, true));
	return fmax(globe, map_off(capture, reference, "skull.exr", 3, false));
}

static const struct fronts_stage stages[] = {
	{ .stage = "transfer", .keys = "rounds, polish_rounds", .finest = { "finest", "8 8 6, 4" },
	  .more = { { "least", "1 1 1, 1" }, { "no_polish", "4 4 2, 0" } },
	  .unit = "mm", .error_of = "mean distance from the finest registration", .error = registered_off, .reps = 3 },
	{ .stage = "train", .keys = "lid_components, skin_components", .always = "--rbf=no",
	  .more = { { "one", "1, 1" }, { "two", "2, 2" }, { "three", "3, 3" }, { "four", "4, 4" }, { "many", "20, 8" } },
	  .unit = "px", .error_of = "lids and skin held out, mean", .error = held_out, .reps = 3 },
	{ .stage = "extrapolate", .keys = "map_step_px, globe_cells", .finest = { "finest", "0.5, 1024" },
	  .more = { { "small", "8, 64" }, { "coarse_globe", "2, 96" }, { "large_globe", "2, 512" } },
	  .unit = "mm", .error_of = "globes or skull, rms, against the finest", .error = maps_off, .reps = 0 },
};

int main(int argc, char **argv)
{
	struct err err = { 0 };
	bench_open("fronts_skin", argc, argv);
	if (fronts_left_out())
		return bench_close();
	scratch_open();
	char *dir = mem_str(scratch_path("face"));
	char *command = mem_printf("cp -r samples/face '%s' && rm -rf '%s/work' && echo 'quality = draft' >>'%s/capture.conf'", dir, dir, dir);
	if (!system(command) && fronts_make(dir, "train") && fronts_make(dir, "extrapolate"))
		for (int i = 0; i < COUNT(stages); i++)
			fronts_measure(&stages[i], dir, 0, (const double[2]){ 1, 0 });
	if (!fronts_write(bench_out(), "fronts_skin", &err))
		fprintf(stderr, "%s\n", err.msg);
	scratch_close();
	free(command);
	free(dir);
	return bench_close();
}
