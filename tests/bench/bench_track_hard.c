/* bench_track_hard: the stage `track` on a rendered clip as a lesser camera would have taken it: noisy, out of focus, of half as many pixels. Errors in px of
 * the clip as it is. No goals: how it degrades. Run from the top of the checkout. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/capture/track_capture.h"
#include "tests/lib/score/track_score.h"
#include "tests/lib/scratch.h"

static void row(const char *of, const char *how, double each, double got, const char *unit, const char *share)
{
	char *what = mem_printf("%s, %s", of, share);
	bench_row("track: lesser clips", of, how, (struct bench_time){ each, each, each }, "frame", got, unit, what);
	free(what);
}

int main(int argc, char **argv)
{
	static const char *const hows[] = { 0, "noise", "blur", "half" }, *const names[] = { "as it is", "noise of 8", "blur of 2 px", "half the size" };
	bench_open("track_hard", argc, argv);
	if (bench_quick()) {
		printf("--quick: left out; bench_track has the clip as it is\n");
		return bench_close();
	}
	if (!bench_data("video/clip_b/truth.npz") || !file_exists("bin/track")) {
		printf("bench_track_hard: shared data video/ or bin/track is not there: nothing measured\n");
		return bench_close();
	}
	const char *root = scratch_open();
	for (int k = 0; k < 4; k++) {
		struct track_score s;
		struct err err = { 0 };
		char *dir = mem_printf("%s/%d", root, k);
		double seconds = track_capture_make(dir, "clip_b", "review", hows[k], 0, 0) ? track_capture_run(dir) : NAN;
		if (isnan(seconds) || !track_score(&s, dir, bench_data("video/clip_b"), &err)) {
			printf("clip_b, %s: track failed: %s\n", names[k], err.msg);
		} else {
			static const char *const axes[] = { "gaze, horizontal", "gaze, vertical", "torsion" };
			double each = seconds / (double)s.frames;
			for (int a = 0; a < 3; a++) {
				row(axes[a], names[k], each, s.gaze[a].median, "deg", "median");
				row(axes[a], names[k], each, s.gaze[a].p95, "deg", "95 %");
			}
			row("lid margins", names[k], each, s.lid.median, "px", "median");
			row("lid margins", names[k], each, s.lid.p95, "px", "95 %");
			row("skin", names[k], each, s.skin.median, "px", "median");
			printf("clip_b, %s: blinks %d of %d, %d wrong; gaze in %.0f %% of frames with open eyes, %.0f %% of skin in sight seen\n", names[k], s.found, s.blinks,
			       s.wrong, 100 * s.gaze_share, 100 * s.skin_seen);
		}
		free(dir);
	}
	scratch_close();
	return bench_close();
}
