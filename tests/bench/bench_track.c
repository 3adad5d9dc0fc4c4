/* bench_track: the stage `track` as it is run on the rendered clips, against their truth: gaze, lids, blinks, skin, head; frames
 * a second beside plain decoding. And the points of skin by themselves, begun at their true places, so that where the mesh was
 * laid on the picture does not count. Run from the top of the checkout. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "image/video/video.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/score/skin_points.h"
#include "tests/lib/capture/track_capture.h"
#include "tests/lib/score/track_score.h"
#include "tests/lib/scratch.h"
#include "tests/lib/score/track_units.h"

static const char *const clips[] = { "clip_a", "clip_b" };

static const char *const units[] = { "browInnerUp_L", "eyeSquint_L" };
enum { UNITS = sizeof units / sizeof *units };

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Processor time of what has been run and waited for, all threads together: other programs on the machine change it less than the clock's. */
static double busy(void)
{
	struct rusage u;
	getrusage(RUSAGE_CHILDREN, &u);
	return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) + 1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void decode_only(const char *path)
{
	struct video_info info;
	struct err err = { 0 };
	double start = now();
	struct video *video = video_open(&info, path, &(struct video_conf){ 40, 100000, 2, 0 }, &err);
	bool got = video != 0;
	long n = 0;
	while (got) {
		struct video_frame f;
		got = video_next(&f, &got, video, &err) && got;
		video_frame_free(&f);
		n += got;
	}
	video_close(video);
	double each = (now() - start) / (double)(n ? n : 1);
	bench_row("track: time", "decode alone", "2 threads", (struct bench_time){ each, each, each }, "frame", NAN, "", "");
}

static void row(const char *method, const char *clip, const char *quality, double each, const struct spread *s, const char *unit, const char *of)
{
	char *setting = mem_printf("%s, %s", clip, quality), *what = mem_printf("%s, median", of), *tail = mem_printf("%s, 95 %%", of);
	struct bench_time t = { each, each, each }, none = { NAN, NAN, NAN };
	bench_row("track: errors", method, setting, t, "frame", s->median, unit, what);
	bench_row("track: errors", method, setting, none, "frame", s->p95, unit, tail);
	free(setting);
	free(what);
	free(tail);
}

/* Strengths of the expressions that were marked. */
static void strengths(const char *dir, const char *clip, double each)
{
	struct spread all, shown, rest;
	struct err err = { 0 };
	char *from = mem_printf("video/%s", clip);
	if (track_units_score(&all, &shown, &rest, dir, bench_data(from), UNITS, units, &err)) {
		row("expressions", clip, "review", each, &all, "of the peak", "all frames");
		row("expressions", clip, "review", each, &shown, "of the peak", "shown more than half");
		row("expressions", clip, "review", each, &rest, "of the peak", "not shown");
	} else {
		printf("%s: %s\n", clip, err.msg);
	}
	free(from);
}

/* Figures of both clips that the goals ask for: the worse of the two. */
struct worst {
	double gaze, gaze95, torsion, lid, lid95, missed, wrong, rate[2];
};

static void whole_stage(struct worst *w, const char *root, const char *clip, int quality)
{
	static const char *const names[] = { "draft", "review" };
	struct track_score s;
	struct err err = { 0 };
	char *dir = mem_printf("%s/%s-%s", root, clip, names[quality]), *from = mem_printf("video/%s", clip);
	bool made = track_capture_make(dir, clip, names[quality], 0, UNITS, units);
	double before = busy(), seconds = made ? track_capture_run(dir) : NAN, work = busy() - before;
	if (isnan(seconds) || !track_score(&s, dir, bench_data(from), &err)) {
		printf("%s, %s: track failed: %s\n", clip, names[quality], err.msg);
		w->missed += 1;
	} else {
		double each = seconds / (double)s.frames, busy_each = work / (double)s.frames;
		char *setting = mem_printf("%s, %s", clip, names[quality]);
		bench_row("track: time", "track", setting, (struct bench_time){ each, each, each }, "frame", NAN, "", "");
		bench_row("track: time", "track, processor time", setting, (struct bench_time){ busy_each, busy_each, busy_each }, "frame", NAN, "", "");
		free(setting);
		static const char *const axes[] = { "gaze, horizontal", "gaze, vertical", "torsion" };
		for (int k = 0; k < 3; k++)
			row(axes[k], clip, names[quality], each, &s.gaze[k], "deg", "open eyes");
		row("lid margins", clip, names[quality], each, &s.lid, "px", "true points off the margin");
		row("aperture g4 + g5", clip, names[quality], each, &s.aperture, "px", "against the truth");
		row("skin, motion since the reference", clip, names[quality], each, &s.skin, "px", "points in sight");
		row("skin, place", clip, names[quality], each, &s.skin_place, "px", "points in sight");
		printf("%s, %s: gaze in %.0f %% of frames with open eyes, margins in %.0f %%, %.0f %% of skin in sight seen; blinks %d of %d, %d wrong; "
		       "skin first tenth %.2f px, last %.2f px; head %.2f deg\n",
		       clip, names[quality], 100 * s.gaze_share, 100 * s.lid_share, 100 * s.skin_seen, s.found, s.blinks, s.wrong, s.skin_first.median,
		       s.skin_last.median, s.head_deg);
		if (quality == 1)
			strengths(dir, clip, each);
		if (quality == 1) {
			w->gaze = fmax(w->gaze, fmax(s.gaze[0].median, s.gaze[1].median));
			w->gaze95 = fmax(w->gaze95, fmax(s.gaze[0].p95, s.gaze[1].p95));
			w->torsion = fmax(w->torsion, s.gaze[2].median);
			w->lid = fmax(w->lid, s.lid.median);
			w->lid95 = fmax(w->lid95, s.lid.p95);
			w->missed += s.blinks - s.found;
			w->wrong += s.wrong;
		}
		w->rate[quality] = fmin(w->rate[quality], 1 / each);
	}
	free(dir);
	free(from);
}

/* The tracker of points alone, from their true places. */
static void points_alone(const char *clip, const struct skin_track_conf *conf, const char *quality, double *worst, double *drift, double *later,
                         double *alike)
{
	struct skin_points_score s;
	struct err err = { 0 };
	char *from = mem_printf("video/%s", clip), *setting = mem_printf("%s, %s", clip, quality);
	if (!skin_points_follow(&s, bench_data(from), 1000, &(struct skin_points_way){ .conf = conf }, &err)) {
		printf("%s: %s\n", clip, err.msg);
	} else {
		struct bench_time each = { s.seconds, s.seconds, s.seconds }, none = { NAN, NAN, NAN };
		bench_row("track: points of skin alone", "patches on the reference frame", setting, each, "frame", s.all.median, "px", "points in sight, median");
		bench_row("track: points of skin alone", "patches on the reference frame", setting, none, "frame", s.all.p90, "px", "points in sight, 90 %");
		printf("%s, %s: %d points from their true places: last tenth %.3f px, first %.3f px (had it moved as far: %.3f px), first shown again after the last %.3f px; all %.3f px, 90 %% %.2f px; %.0f %% seen\n",
		       clip, quality, s.points, s.last.median, s.first.median, s.first_alike, s.again.median, s.all.median, s.all.p90, 100 * s.seen);
		*worst = fmax(*worst, s.all.median);
		*drift = fmax(*drift, s.again.median - s.first.median);
		*later = fmax(*later, s.last.median - s.first.median);
		*alike = fmax(*alike, s.last.median - s.first_alike);
	}
	free(from);
	free(setting);
}

/* The goals of the preset review. */
static void precision(const struct worst *w)
{
	bench_goal("gaze, horizontal and vertical, open eyes, median", "<= 0.5 deg", w->gaze, "deg", w->gaze <= 0.5);
	bench_goal("gaze, 95 %", "<= 1.5 deg", w->gaze95, "deg", w->gaze95 <= 1.5);
	bench_goal("torsion, median", "<= 1 deg", w->torsion, "deg", w->torsion <= 1);
	bench_goal("lid margins, median", "<= 1 px", w->lid, "px", w->lid <= 1);
	bench_goal("lid margins, 95 %", "<= 3 px", w->lid95, "px", w->lid95 <= 3);
	bench_goal("track, review", ">= 20 frames/s", w->rate[1], "frames/s", w->rate[1] >= 20);
}

int main(int argc, char **argv)
{
	bench_open("track", argc, argv);
	struct worst w = { .rate = { INFINITY, INFINITY } };
	double points = 0, drift = -INFINITY, later = -INFINITY, alike = -INFINITY;
	if (!bench_data("video/clip_a/truth.npz") || !file_exists("bin/track")) {
		printf("bench_track: shared data video/ or bin/track is not there: nothing measured\n");
		return bench_close();
	}
	const char *root = scratch_open();
	for (int c = 0; c < (bench_quick() ? 1 : 2); c++) {
		if (!bench_quick()) {  // bench_flow has the points' first frames
			points_alone(clips[c], &skin_track_review, "review", &points, &drift, &later, &alike);
			points_alone(clips[c], &skin_track_draft, "draft", &(double){ 0 }, &(double){ 0 }, &(double){ 0 }, &(double){ 0 });
		}
		char *video = mem_printf("video/%s/video.mp4", clips[c]);
		decode_only(bench_data(video));
		free(video);
		for (int quality = 0; quality < (bench_quick() ? 1 : 2); quality++)
			whole_stage(&w, root, clips[c], quality);
	}
	if (!bench_quick()) {
		static const char first[] = "(first worded: no drift, last tenth of the clip against its first)";
		char *again = mem_printf("<= 0.001 px %s", first), *moved = mem_printf("<= 0 px %s", first);
		bench_goal("skin points, drift: last tenth of the clip less its first", "<= 0 px", later, "px", later <= 0);
		bench_goal("skin points, drift: last tenth less the points of the first that had moved as far since the reference", moved, alike, "px", alike <= 0);
		bench_goal("skin points, drift: the first tenth shown again after the last, less the first time", again, drift, "px", drift <= 1e-3);
		bench_goal("skin points, median", "<= 0.5 px", points, "px", points <= 0.5);
		free(again);
		free(moved);
	}
	bench_goal("track, draft", ">= 60 frames/s", w.rate[0], "frames/s", w.rate[0] >= 60);
	bench_goal("blinks missed or invented", "none", w.missed + w.wrong, "", w.missed + w.wrong == 0);
	if (!bench_quick())  // review's
		precision(&w);
	scratch_close();
	return bench_close();
}
