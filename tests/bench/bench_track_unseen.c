/* bench_track_unseen: the stage `track` on clips that were not used in development, told nothing but camera, mesh and the landmarks of the lids: accepted
 * or refused, and how far off what was accepted is. EYEWRIGHT_FACES=DIR: folders of a clip with its truth each (video.mp4, subject.ply, truth.json,
 * truth.npz, as those of the shared data video/); besides them the two clips of the shared data, with and without their eyeballs' centres.
 * FACES=still: only folders whose name has that. Run from the top of the checkout. */
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

/* Gaze about its offset in the median and at 95 %, that offset, torsion, degrees; lids in the median and at 95 %, motion of skin, its place, px. */
enum { GAZE, GAZE95, OFFSET, TORSION, LID, LID95, SKIN, PLACE, FIGURES };
static const char *const names[FIGURES] = { "gaze", "95%", "offset", "tors", "lids", "95%", "skin", "place" };
static const double reach[FIGURES] = { 0.5, 1.5, 1.5, 1, 1, 3, 0.5, 2.5 };
static const double far_turned = 25;  // degrees: heads turned further may be off by twice as much

struct tally {
	int clips, accepted, reached, off, blinks, missed, wrong;
	double gaze[2], drift;
};

static void figures(double x[FIGURES], const struct track_score *s)
{
	const double all[FIGURES] = { fmax(s->about[0].median, s->about[1].median), fmax(s->about[0].p95, s->about[1].p95), 0, s->gaze[2].median, s->lid.median,
		                          s->lid.p95, s->skin.median, s->skin_place.median };
	memcpy(x, all, sizeof all);
	for (int k = 0; k < 4; k++)
		x[OFFSET] = fmax(x[OFFSET], fabs(s->offset[k / 2][k % 2]));
}

static void measure(struct tally *t, const char *dir, const char *from, const char *name, bool centers)
{
	struct track_score s;
	struct err err = { 0 };
	double x[FIGURES], seconds = track_capture_bare(dir, from, bench_quick() ? "draft" : "review", centers) ? track_capture_run(dir) : NAN;
	t->clips++;
	printf("%-26s ", name);
	if (isnan(seconds)) {
		printf("refused\n");
		return;
	}
	if (!track_score(&s, dir, from, &err)) {
		printf("not measured: %s\n", err.msg);
		return;
	}
	const double more = fmax(s.yaw, s.pitch) > far_turned ? 2 : 1;
	bool reached = s.gaze_share > 0.5, off = false;
	figures(x, &s);
	printf("accepted %5.1f ms a frame;", 1000 * seconds / (double)s.frames);
	for (int k = 0; k < FIGURES; k++) {
		printf(" %s %.2f%s", names[k], x[k], x[k] <= reach[k] * more ? "" : x[k] <= 2 * reach[k] * more ? "+" : isnan(x[k]) ? "?" : "!");
		reached = reached && x[k] <= reach[k] * more;
		off = off || x[k] > 2 * reach[k] * more;  // what is not told misses the goal, but is not wrong
	}
	printf("; no gaze %.0f%%, skin %.0f%% seen, head %.2f deg %.1f mm (95%% %.1f, %.1f), turned %.0f, blinks %d of %d, %d wrong\n", 100 - 100 * s.gaze_share,
	       100 * s.skin_seen, s.head_off.median, s.head_at.median, s.head_off.p95, s.head_at.p95, fmax(s.yaw, s.pitch), s.found, s.blinks, s.wrong);
	t->accepted++;
	t->reached += reached;
	t->off += off;
	t->blinks += s.blinks;
	t->missed += s.blinks - s.found;
	t->wrong += s.wrong;
	t->gaze[0] = fmax(t->gaze[0], x[GAZE]);
	t->gaze[1] = fmax(t->gaze[1], x[GAZE95]);
	t->drift = fmax(t->drift, s.skin_last.median - s.skin_first.median);
	struct bench_time each = { seconds / (double)s.frames, seconds / (double)s.frames, seconds / (double)s.frames }, none = { NAN, NAN, NAN };
	bench_row("track: unseen clips", "gaze", name, each, "frame", x[GAZE], "deg", "worse axis, median");
	bench_row("track: unseen clips", "gaze", name, none, "frame", x[OFFSET], "deg", "largest offset");
	bench_row("track: unseen clips", "head pose", name, none, "frame", s.head_off.median, "deg", "median");
}

static void unseen(struct tally *t, const char *root)
{
	const char *at = getenv("EYEWRIGHT_FACES");
	char *name[TRACK_FACES];
	const int n = track_capture_faces(name);
	for (int i = 0; i < n; i++) {
		char *dir = mem_printf("%s/%s", root, name[i]), *from = mem_printf("%s/%s", at, name[i]);
		measure(t, dir, from, name[i], false);
		free(dir);
		free(from);
		free(name[i]);
	}
}

static void known(struct tally *t, const char *root)
{
	static const char *const clips[] = { "clip_a", "clip_b" };
	for (int k = 0; k < 4; k++) {
		char *from = mem_printf("video/%s", clips[k / 2]), *name = mem_printf("%s%s", clips[k / 2], k % 2 ? ", centres told" : ""), *dir = mem_printf("%s/%d", root, k);
		if (bench_data(from) && !getenv("FACES"))
			measure(t, dir, bench_data(from), name, k % 2);
		free(from);
		free(name);
		free(dir);
	}
}

int main(int argc, char **argv)
{
	bench_open("track_unseen", argc, argv);
	struct tally all = { .drift = -INFINITY };
	if (!file_exists("bin/track")) {
		printf("bench_track_unseen: bin/track is not there: nothing measured\n");
		return bench_close();
	}
	const char *root = scratch_open();
	printf("+ past what is to be reached, ! past twice that, ? not told; of heads turned by more than %.0f degrees, twice and four times\n", far_turned);
	unseen(&all, root);
	known(&all, root);
	if (!getenv("EYEWRIGHT_FACES"))
		printf("bench_track_unseen: EYEWRIGHT_FACES names no folder of clips: the shared data's alone were measured\n");
	if (all.clips) {
		bench_goal("skin points, drift: last tenth of the clip less its first", "<= 0 px", all.drift, "px", all.drift <= 0);
		bench_goal("clips accepted", ">= 90 %", 100.0 * all.accepted / all.clips, "%", all.accepted >= 0.9 * all.clips);
		bench_goal("clips accepted and off by more than twice what is to be reached", "none", all.off, "", !all.off);
		bench_goal("clips in which all is reached", ">= 90 %", 100.0 * all.reached / all.clips, "%", all.reached >= 0.9 * all.clips);
		bench_goal("blinks missed or invented in those accepted", "none", all.missed + all.wrong, "", !(all.missed + all.wrong));
		printf("%d clips, %d accepted, %d of them within all goals, %d off; worst gaze %.2f deg, 95 %% %.2f deg; blinks: %d of %d missed, %d invented\n", all.clips,
		       all.accepted, all.reached, all.off, all.gaze[0], all.gaze[1], all.missed, all.blinks, all.wrong);
	}
	scratch_close();
	return bench_close();
}
