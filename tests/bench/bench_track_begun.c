/* bench_track_begun: the stage `track` on rendered clips that begin where none should: while the eyes look aside or down, in a blink. Each is the bundled clip
 * from one of its frames on. Run from the top of the checkout. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/capture/track_capture.h"
#include "tests/lib/score/track_score.h"
#include "tests/lib/scratch.h"

static const struct {
	const char *clip, *first, *name;
} begun[] = { { "clip_a", "174", "in a blink" }, { "clip_a", "150", "15 deg down, 17 aside" }, { "clip_b", "30", "15 deg aside" }, { "clip_b", "128", "in a blink" } };

static void row(const char *setting, double each, const char *of, const struct spread *s, const char *unit)
{
	static const char *const shares[] = { "median", "95 %" };
	for (int k = 0; k < 2; k++) {
		char *what = mem_printf("%s, %s", of, shares[k]);
		bench_row("track: clips begun badly", of, setting, (struct bench_time){ each, each, each }, "frame", k ? s->p95 : s->median, unit, what);
		free(what);
	}
}

/* The worst so far of gaze's median and 95 %, of blinks missed or invented. */
static void measure(double worst[3], const char *root, int k)
{
	struct track_score s;
	struct err err = { 0 };
	char *dir = mem_printf("%s/%d", root, k), *truth = mem_printf("video/%s", begun[k].clip), *setting = mem_printf("%s from %s: %s", begun[k].clip, begun[k].first, begun[k].name);
	double seconds = track_capture_make(dir, begun[k].clip, "review", begun[k].first, 0, 0) ? track_capture_run(dir) : NAN;
	if (isnan(seconds) || !track_score_from(&s, dir, bench_data(truth), strtol(begun[k].first, 0, 10), &err)) {
		printf("%s: track failed: %s\n", setting, err.msg);
		worst[0] = worst[1] = worst[2] = INFINITY;
	} else {
		double each = seconds / (double)s.frames;
		row(setting, each, "gaze, horizontal", &s.gaze[0], "deg");
		row(setting, each, "gaze, vertical", &s.gaze[1], "deg");
		row(setting, each, "lid margins", &s.lid, "px");
		row(setting, each, "skin, motion since the reference", &s.skin, "px");
		printf("%s: blinks %d of %d, %d wrong; gaze in %.0f %% of frames with open eyes\n", setting, s.found, s.blinks, s.wrong, 100 * s.gaze_share);
		for (int a = 0; a < 2; a++) {
			worst[0] = fmax(worst[0], s.gaze[a].median);
			worst[1] = fmax(worst[1], s.gaze[a].p95);
		}
		worst[2] += s.blinks - s.found + s.wrong;
	}
	free(dir);
	free(truth);
	free(setting);
}

int main(int argc, char **argv)
{
	bench_open("track_begun", argc, argv);
	double worst[3] = { 0 };
	if (!bench_data("video/clip_a/truth.npz") || !file_exists("bin/track")) {
		printf("bench_track_begun: shared data video/ or bin/track is not there: nothing measured\n");
		return bench_close();
	}
	if (bench_quick()) {
		printf("bench_track_begun: left out of a quick run\n");
		return bench_close();
	}
	const char *root = scratch_open();
	for (int k = 0; k < COUNT(begun); k++)
		measure(worst, root, k);
	bench_goal("gaze of clips begun on a glance or in a blink, median", "<= 0.5 deg", worst[0], "deg", worst[0] <= 0.5);
	bench_goal("gaze of clips begun on a glance or in a blink, 95 %", "<= 1.5 deg", worst[1], "deg", worst[1] <= 1.5);
	bench_goal("blinks missed or invented in them", "none", worst[2], "", worst[2] == 0);
	scratch_close();
	return bench_close();
}
