/* bench_track_small: the stage `track` on a video alone whose irises are small (6 to 13 px radius), as in most films of a face: clips with truth at a fifth of their size, told
 * nothing, neither lens nor mesh. Accepted or refused; lids, blinks, how the head is turned, gaze against the head and its own standard deviation, and against the camera's axes. The clip of the shared data with both
 * eyes, and EYEWRIGHT_FACES=DIR: folders of others (bench_track_unseen). Beside it the same by edges and the clip's own colours alone, the head by its skin, accepted whatever it is.
 * FACES=84047: only those whose name has that; TIMES=1, 2: not reduced, or to a half. Run from the top of the checkout. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/capture/track_capture.h"
#include "tests/lib/score/track_score.h"
#include "tests/lib/scratch.h"
#include "tests/lib/variants/worsen.h"

static const double far = 15;         // degrees: track.wrong_alone_deg

struct tally { int clips, accepted, off, blinks, missed, wrong; double lid, lid95, ratio; };

static int times(void)
{
	const int told = getenv("TIMES") ? atoi(getenv("TIMES")) : 5;
	return told == 1 || told == 2 ? told : 5;
}

static bool capture(const char *dir, const char *from, bool edges_alone)
{
	struct err err = { 0 };
	char *in = mem_printf("%s/video.mp4", from), *folder = mem_printf("%s/video", dir), *out = mem_printf("%s/video/a.mp4", dir), *conf = mem_printf("%s/capture.conf", dir);
	bool ok = file_mkdirs(folder, &err) && worsen_video(out, in, times() == 1 ? "as it is" : times() == 2 ? "half" : "fifth", &err);
	const char *keys = "track.evidence_px = 0\ntrack.wrong_most = 1\ntrack.gaze_least = 0\n";
	ok = ok && (!edges_alone || file_write(conf, keys, strlen(keys), &err));
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	free(in);
	free(folder);
	free(out);
	free(conf);
	return ok;
}

/* edges_alone: the rival, which counts for nothing. */
static void measure(struct tally *t, const char *dir, const char *from, const char *name, bool edges_alone)
{
	struct track_score s;
	struct err err = { 0 };
	const double seconds = capture(dir, from, edges_alone) ? track_capture_run(dir) : NAN;
	const char *method = edges_alone ? "edges and colours alone" : "the network's evidence";
	t->clips++;
	printf("%-14s %-24s ", name, method);
	if (isnan(seconds) || !track_score(&s, dir, from, &err)) {
		printf("refused%s%s\n", err.msg[0] ? ": " : "", err.msg);
		return;
	}
	const double gaze95 = fmax(s.gaze[0].p95, s.gaze[1].p95), ratio = fmax(s.ratio[0].p90, s.ratio[1].p90);
	printf("accepted %5.1f ms a frame; lids %.2f, 95%% %.2f px; gaze h %.1f, 95%% %.1f, v %.1f, 95%% %.1f deg, 90%% of errors below %.1f sigma, in %.0f%% of frames; against the camera h %.1f, 95%% %.1f, v %.1f, 95%% %.1f; blinks %d of %d, %d wrong; "
	       "head turned by %.0f, told to %.1f, 95%% %.1f deg\n",
	       1000 * seconds / (double)s.frames, s.lid.median / times(), s.lid.p95 / times(), s.gaze[0].median, s.gaze[0].p95, s.gaze[1].median, s.gaze[1].p95, ratio, 100 * s.gaze_share,
	       s.seen[0].median, s.seen[0].p95, s.seen[1].median, s.seen[1].p95, s.found, s.blinks, s.wrong, fmax(s.yaw, s.pitch), s.head_off.median, s.head_off.p95);
	t->accepted++;
	t->off += gaze95 > 2 * far;
	t->blinks += s.blinks;
	t->missed += s.blinks - s.found;
	t->wrong += s.wrong;
	t->lid = fmax(t->lid, s.lid.median / times());
	t->lid95 = fmax(t->lid95, s.lid.p95 / times());
	t->ratio = fmax(t->ratio, ratio);
	const double each = seconds / (double)s.frames;
	bench_row("track: a video alone, lid margins", method, name, (struct bench_time){ each, each, each }, "frame", s.lid.median / times(), "px", "median");
	bench_row("track: a video alone, gaze", method, name, (struct bench_time){ each, each, each }, "frame", fmax(s.gaze[0].median, s.gaze[1].median), "deg", "against the head, worse axis, median");
}

static void both(struct tally *t, const char *dir, const char *from, const char *name)
{
	struct tally rival = { 0 };
	char *other = mem_printf("%s.edges", dir);
	measure(t, dir, from, name, false);
	measure(&rival, other, from, name, true);
	free(other);
}

int main(int argc, char **argv)
{
	bench_open("track_small", argc, argv);
	struct tally all = { 0 };
	if (!file_exists("bin/track")) {
		printf("bench_track_small: bin/track is not there: nothing measured\n");
		return bench_close();
	}
	const char *root = scratch_open(), *at = getenv("EYEWRIGHT_FACES");
	if (bench_data("video/clip_a") && !getenv("FACES")) {
		char *dir = mem_printf("%s/clip_a", root);
		both(&all, dir, bench_data("video/clip_a"), "clip_a");
		free(dir);
	}
	char *name[TRACK_FACES];
	const int n = track_capture_faces(name);
	for (int i = 0; i < n; i++) {
		char *dir = mem_printf("%s/%s", root, name[i]), *from = mem_printf("%s/%s", at, name[i]);
		both(&all, dir, from, name[i]);
		free(dir);
		free(from);
		free(name[i]);
	}
	if (!at)
		printf("bench_track_small: EYEWRIGHT_FACES names no folder of clips: the shared data's alone was measured\n");
	if (all.clips) {
		bench_goal("a video alone, small irises: lids, median", "<= 1 px", all.lid, "px", all.lid <= 1);
		bench_goal("a video alone, small irises: lids, 95 %", "<= 3 px", all.lid95, "px", all.lid95 <= 3);
		bench_goal("a video alone, small irises: gaze, 90 % of its errors over sigma, worst clip", "<= 2", all.ratio, "", all.ratio <= 2);
		bench_goal("a video alone, small irises: accepted and off by more than twice track.wrong_alone_deg (95 %)", "none", all.off, "", !all.off);
		bench_goal("a video alone, small irises: blinks missed or invented", "none", all.missed + all.wrong, "", !(all.missed + all.wrong));
		printf("%d clips, %d accepted, %d of them off; blinks: %d of %d missed, %d invented\n", all.clips, all.accepted, all.off, all.missed, all.blinks, all.wrong);
	}
	scratch_close();
	return bench_close();
}
