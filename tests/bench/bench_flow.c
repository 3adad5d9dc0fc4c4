/* Points of skin followed through the first frames of a rendered clip, every one begun at its true place: patches against the first
 * frame, as `track` does it, beside OpenCV's Lucas-Kanade, DIS and Farneback, from frame to frame or against the first.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/score/skin_points.h"

enum { POINTS = 1000, FRAMES = 100, QUICK_FRAMES = 5 };

static const struct {
	const char *name;
	struct skin_points_way way;
} ways[] = {
	{ "ours: affine patches against the first frame, review", { .conf = &skin_track_review } },
	{ "ours: affine patches against the first frame, draft", { .conf = &skin_track_draft } },
	{ "OpenCV Lucas-Kanade, frame to frame", { .flow = CV_FLOW_LUCAS_KANADE, .chained = true } },
	{ "OpenCV Lucas-Kanade, against the first frame", { .flow = CV_FLOW_LUCAS_KANADE } },
	{ "OpenCV DIS fast, frame to frame", { .flow = CV_FLOW_DIS_FAST, .chained = true } },
	{ "OpenCV DIS medium, frame to frame", { .flow = CV_FLOW_DIS_MEDIUM, .chained = true } },
	{ "OpenCV DIS medium, against the first frame", { .flow = CV_FLOW_DIS_MEDIUM } },
	{ "OpenCV Farneback, frame to frame", { .flow = CV_FLOW_FARNEBACK, .chained = true } },
};

static void measure(const char *clip)
{
	char *from = mem_printf("video/%s", clip), *setting = mem_printf("%s, %d frames", clip, bench_quick() ? QUICK_FRAMES : FRAMES);
	for (int i = 0; i < COUNT(ways); i++) {
		struct skin_points_way way = ways[i].way;
		struct skin_points_score s;
		struct err err = { 0 };
		if (bench_quick() && (i == 1 || way.flow == CV_FLOW_FARNEBACK || (i > 1 && !way.chained)))
			continue;
		way.frames = bench_quick() ? QUICK_FRAMES : FRAMES;
		if (!skin_points_follow(&s, bench_data(from), POINTS, &way, &err)) {
			printf("%s: %s\n", clip, err.msg);
			continue;
		}
		struct bench_time each = { s.seconds, s.seconds, s.seconds }, none = { NAN, NAN, NAN };
		bench_row("points of skin", ways[i].name, setting, each, "frame", s.all.median, "px", "points in sight, median");
		bench_row("points of skin", ways[i].name, setting, none, "frame", s.all.p90, "px", "points in sight, 90 %");
		printf("%s: %.3f px, 90 %% %.2f px, %.1f ms a frame; %.0f %% seen\n", ways[i].name, s.all.median, s.all.p90, 1e3 * s.seconds, 100 * s.seen);
	}
	free(from);
	free(setting);
}

int main(int argc, char **argv)
{
	bench_open("flow", argc, argv);
	if (!bench_data("video/clip_a/truth.npz")) {
		printf("bench_flow: shared data video/ is not there: nothing measured\n");
		return bench_close();
	}
	measure("clip_a");
	return bench_close();
}
