/* Fronts of `calibrate`: its knobs on eight photographs of a carved head whose cameras are known, each run begun anew: time, and how far
 * the mesh lies from the surface that the known cameras give, its own cameras' error with it, as if the head were 230 mm tall.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/run.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/bench/fronts.h"
#include "tests/lib/scratch.h"
#include "tests/lib/capture/views_capture.h"

enum { HEAD_MM = 230 };
static const char *const names[] = { "00013.jpg", "00016.jpg", "00022.jpg", "00031.jpg", "00034.jpg", "00036.jpg", "00062.jpg", "00063.jpg", 0 };
static struct views_truth truth;
static struct sweep_points surface;

static double off_surface(const char *capture, const char *reference)
{
	struct camera_rig rig = { 0 };
	struct views_fit fit;
	struct err err = { 0 };
	double share, middle = NAN;
	char *found = mem_printf("%s/work/rig.json", capture), *mesh = mem_printf("%s/work/subject.ply", capture);
	(void)reference;
	if (!camera_rig_load(&rig, found, &err) || !views_fit(&fit, &truth, &rig) || !views_mesh_within(&share, &middle, mesh, &fit, &surface, &err))
		fprintf(stderr, "%s: %s\n", capture, err_is(&err) ? err.msg : "too few cameras");
	else
		printf("%d cameras, centres %.4f %% of the orbit; %.1f %% of the mesh within 1 %%\n", fit.n, 100 * fit.mean / truth.extent, 100 * share);
	camera_rig_free(&rig);
	free(found);
	free(mesh);
	return HEAD_MM * middle;
}

static const struct fronts_stage calibrate = {
	.stage = "calibrate",
	.keys = "picture_px, features, first_octave, overlap_matches, lens, adjustments, neighbours, subject_px, max_range, voxel, min_pairs, mesh_depth, "
	        "mesh_faces",
	.more = { { "draft_cameras", "1600, 2048, 0, 8, simple_radial, 3, 3, 600, 192, 0.006, 3, 8, 60000" },
		  { "half_features", "2400, 2048, 0, 5, simple_radial, 3, 3, 600, 192, 0.006, 3, 8, 60000" },
		  { "more_features", "2400, 8192, 0, 5, simple_radial, 3, 3, 600, 192, 0.006, 3, 8, 60000" },
		  { "two_neighbours", "2400, 4096, 0, 5, simple_radial, 3, 2, 600, 192, 0.006, 3, 8, 60000" },
		  { "five_neighbours", "2400, 4096, 0, 5, simple_radial, 3, 5, 600, 192, 0.006, 3, 8, 60000" },
		  { "draft_surface", "2400, 4096, 0, 5, simple_radial, 3, 3, 350, 128, 0.009, 2, 7, 30000" } },
	.unit = "mm", .error_of = "median distance of the mesh from the surface, of a head of 230 mm", .error = off_surface, .anew = true,
};

/* Only the cameras that take part: the surface is swept between them. */
static void keep_named(struct views_truth *t)
{
	int n = 0;
	for (int i = 0; i < t->n; i++)
		for (int k = 0; names[k]; k++)
			if (!strncmp(t->c[i].name, names[k], 5))
				t->c[n++] = t->c[i];
	t->n = n;
}

int main(int argc, char **argv)
{
	struct err err = { 0 };
	bench_open("fronts_calibrate", argc, argv);
	const char *data = bench_data("views/buddha");
	if (fronts_left_out())
		return bench_close();
	if (!run_exists("colmap") || !data) {
		printf("COLMAP or views/buddha is not there: left out\n");
		return bench_close();
	}
	scratch_open();
	char *dir = mem_str(scratch_path("small")), *images = mem_printf("%s/images", data);
	bool ok = views_truth_load(&truth, data, &err);
	if (ok)
		keep_named(&truth);
	if (ok && views_capture(dir, images, names, 0, "", &err) && sweep(&surface, &truth, images, 4, 128, &err))
		fronts_measure(&calibrate, dir, 0, (const double[2]){ 1, 0 });
	if (err_is(&err) || !fronts_write(bench_out(), "fronts_calibrate", &err))
		fprintf(stderr, "%s\n", err.msg);
	sweep_free(&surface);
	views_truth_free(&truth);
	scratch_close();
	free(images);
	free(dir);
	return bench_close();
}
