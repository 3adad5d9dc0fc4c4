/* Fronts of `track`: its knobs on the first frames of the bundled clip, time and error of the same run: margins of the lids
 * off the clip's truth, px, 95 % of them: gaze and skin come well within what they need at every setting. Where the shared
 * data are there, the error is the mean of that and of the same on its close-up: on one clip alone settings differ by chance.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/bench/fronts.h"
#include "tests/lib/scratch.h"
#include "tests/lib/capture/track_capture.h"
#include "tests/lib/score/track_score.h"

static double off_truth(const char *capture, const char *reference)
{
	(void)reference;
	struct track_score s;
	struct err err = { 0 };
	bool close_up = !strcmp(strrchr(capture, '/'), "/close_up");
	if (!track_score(&s, capture, close_up ? bench_data("video/clip_b") : "samples/face/truth", &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return NAN;
	}
	return s.lid.p95;
}

static struct fronts_stage track = {
	.stage = "track",
	.keys = "settle_frames, patch_radius_px, patch_iterations, patch_every, patch_stop_px, agree_px, sweeps, skin_quiet, limbus_arcs, lid_columns, torsion_rays",
	.more = { { "quickest", "20, 6, 6, 2, 0.1, 1, 1, 0.5, 40, 24, 45" }, { "quick_skin", "180, 8, 8, 2, 0.05, 0.6, 1, 0.3, 120, 48, 360" },
		  { "quick_eyes", "40, 10, 12, 1, 0.02, 0.1, 1, 0, 60, 36, 90" }, { "one_sweep", "180, 10, 12, 1, 0.02, 0.1, 1, 0, 120, 48, 360" },
		  { "thorough", "300, 12, 20, 1, 0.01, 0.1, 3, 0, 180, 64, 360" } },
	.unit = "px", .error_of = "margins of the lids off the truth, 95 %", .error = off_truth, .reps = 0,
};

int main(int argc, char **argv)
{
	struct err err = { 0 };
	bench_open("fronts_track", argc, argv);
	if (fronts_left_out())
		return bench_close();
	scratch_open();
	char *dir = mem_str(scratch_path("face"));
	// Half of the clip: what a copy that broke off leaves is followed as far as it goes.
	char *command = mem_printf("mkdir -p '%s/video' && cp samples/face/capture.conf samples/face/subject.ply '%s' && sed -i '/^expression/d' '%s/capture.conf' && "
	                           "head -c 1300000 samples/face/video/face.mp4 >'%s/video/face.mp4'", dir, dir, dir, dir);
	char *close_up = mem_str(scratch_path("close_up"));
	if (bench_data("video/clip_b/truth.npz") && track_capture_make(close_up, "clip_b", "review", 0, 0, 0) && isfinite(track_capture_run(close_up)))
		track.also = close_up;
	if (!system(command) && fronts_make(dir, "track"))
		fronts_measure(&track, dir, 0, (const double[2]){ 1, 0 });
	if (!fronts_write(bench_out(), "fronts_track", &err))
		fprintf(stderr, "%s\n", err.msg);
	scratch_close();
	free(command);
	free(close_up);
	free(dir);
	return bench_close();
}
