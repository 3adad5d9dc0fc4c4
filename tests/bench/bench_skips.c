/* What is not done, and what that saves: the same work with each skip and without it, on a scene that needs the work and on
 * one that does not. The scene that needs it shows what looking costs.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"

/* A command before each run, and the command that is timed: shell text, $C the capture, the text this file's own. */
struct run {
	const char *before, *timed;
};

struct skip {
	const char *what, *scene, *capture;
	struct run with, without;
	bool slow;  // left out of a quick run
};

#define MAKE "make --no-print-directory CAPTURE=\"$C\" "
static const struct skip skips[] = {
	{ "stages whose inputs, keys and program are as they were", "nothing changed", "photo", { "true", MAKE "relief" },
	  { "rm -rf \"$C/work\"", MAKE "relief" }, false },
	{ "stages whose inputs, keys and program are as they were", "everything is new", "photo", { "rm -rf \"$C/work\"", MAKE "relief" },
	  { "rm -rf \"$C/work\"; mkdir -p \"$C/work\"",
	    "for s in limbus unrefract freckles heightfield pigment relief; do bin/$s --capture=\"$C\" || exit 1; done" }, true },
	{ "photographs that were measured before", "one of four is new", "four",
	  { "bin/limbus --capture=\"$C\"; rm -f \"$C\"/work/limbus/right_1.*", "bin/limbus --capture=\"$C\"" },
	  { "true", "bin/limbus --force --capture=\"$C\"" }, false },
	{ "photographs that were measured before", "all four are new", "four", { "rm -rf \"$C/work\"", "bin/limbus --capture=\"$C\"" },
	  { "true", "bin/limbus --force --capture=\"$C\"" }, true },
	{ "cornea solved at nodes of a lattice, not for each texel", "any iris", "photo", { "true", "bin/unrefract --force --capture=\"$C\"" },
	  { "true", "bin/unrefract --force --capture=\"$C\" --method=newton" }, false },
	{ "maps that nobody asked for", "unrefract.write_map = no", "photo", { "true", "bin/unrefract --force --capture=\"$C\" --write-map=no" },
	  { "true", "bin/unrefract --force --capture=\"$C\" --write-map=yes" }, true },
	{ "relief's sharpening filter", "not wanted (relief.filter = no)", "photo", { "true", "bin/relief --force --capture=\"$C\" --filter=no" },
	  { "true", "bin/relief --force --capture=\"$C\"" }, true },
	{ "stages that a changed key does not reach", "render.size_px changed", "photo",
	  { MAKE "render; sed -i /size_px/d \"$C/capture.conf\"; echo \"render.size_px = 500\" >>\"$C/capture.conf\"", MAKE "render" },
	  { "rm -rf \"$C/work\"", MAKE "render" }, true },
	{ "film of the turntable", "not wanted (render.film = no)", "photo", { "true", "bin/render --force --capture=\"$C\" --film=no" },
	  { "true", "bin/render --force --capture=\"$C\" --film=yes" }, true },
	{ "the skin column and its pictures", "a photograph alone", "photo", { "rm -rf \"$C/work\"", MAKE "render" },
	  { "rm -rf \"$ROOT/both/work\"", "make --no-print-directory CAPTURE=\"$ROOT/both\" render" }, true },
	{ "skin, lashes and clips in render alone", "a photograph alone", "photo", { "true", "bin/render --force --capture=\"$C\"" },
	  { "true", "bin/render --force --capture=\"$ROOT/both\"" }, true },
	{ "folds of expressions", "none is marked", "face", { "sed -i /^expression/d \"$C/capture.conf\"", "bin/track --force --capture=\"$C\"" },
	  { "sed -i /^expression/d \"$C/capture.conf\"; grep ^expression samples/face/capture.conf >>\"$C/capture.conf\"", "bin/track --force --capture=\"$C\"" }, true },
	{ "eyes and skin that stand still between two frames", "moving eyes and skin", "face", { "true", "bin/track --force --capture=\"$C\"" },
	  { "true", "bin/track --force --capture=\"$C\" --still=0 --skin-still=0" }, true },
	{ "iterations of a patch of skin that has come to rest", "any clip", "face", { "true", "bin/track --force --capture=\"$C\"" },
	  { "true", "bin/track --force --capture=\"$C\" --patch-stop-px=1e-4" }, true },
	{ "registration of a character that has the subject's vertices", "it has them all", "face",
	  { "mkdir -p \"$C/targets\"; rm -f \"$C\"/targets/*; cp \"$C/subject.ply\" \"$C/targets\"", "bin/transfer --force --capture=\"$C\"" },
	  { "sed '$d; s/^element face 4342/element face 4341/' samples/face/subject.ply >\"$C/targets/subject.ply\"", "bin/transfer --force --capture=\"$C\"" }, true },
	{ "the comparison with radial basis functions", "not wanted (train.rbf = no)", "face", { "true", "bin/train --force --capture=\"$C\" --rbf=no" },
	  { "true", "bin/train --force --capture=\"$C\" --rbf=yes" }, true },
};

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool shell(const char *command)
{
	char *quiet = mem_printf("{ %s ; } >>\"$C.log\" 2>&1", command);
	int status = system(quiet);
	free(quiet);
	return WIFEXITED(status) && !WEXITSTATUS(status);
}

static double timed(const struct run *run)
{
	shell(run->before);
	double begin = now_s();
	return shell(run->timed) ? now_s() - begin : NAN;
}

static void measure(const struct skip *s, int reps)
{
	double *with = mem_new(2 * (size_t)reps, sizeof *with), *without = with + reps;
	for (int i = 0; i < reps; i++) {  // in turn: the machine's drift hits both
		with[i] = timed(&s->with);
		without[i] = timed(&s->without);
	}
	struct bench_time a = bench_time_of(reps, with), b = bench_time_of(reps, without);
	char *with_it = mem_printf("%s: with", s->scene), *without_it = mem_printf("%s: without", s->scene);
	double saved = b.median - a.median;
	bench_row(s->what, "skipped", with_it, a, "run", 100 * saved / b.median, "%", "time saved");
	bench_row(s->what, "done all the same", without_it, b, "run", NAN, "", "");
	printf("| %s | %s | %.2f s | %.2f s | %.2f s |\n", s->what, s->scene, a.median, b.median, saved);
	free(with);
	free(with_it);
	free(without_it);
}

static bool make_captures(const char *root)
{
	setenv("ROOT", root, 1);
	setenv("C", root, 1);
	setenv("QUICK", bench_quick() ? "photo four" : "", 1);
	return shell("for c in photo four; do mkdir -p \"$ROOT/$c/photos\"; cp samples/demo/capture.conf \"$ROOT/$c\"; done;"
	             "cp samples/demo/photos/right_softbox.jpg \"$ROOT/photo/photos\";"
	             "for i in 1 2 3 4; do { cat samples/demo/photos/right_softbox.jpg; echo $i; } >\"$ROOT/four/photos/right_$i.jpg\"; done;"
	             "mkdir -p \"$ROOT/face\"; cp -r samples/face/video samples/face/subject.ply samples/face/capture.conf \"$ROOT/face\";"
	             "cp -r \"$ROOT/face\" \"$ROOT/both\"; cp -r samples/face/targets \"$ROOT/photo/photos\" \"$ROOT/both\"; cat samples/demo/capture.conf | sed /camera/d >>\"$ROOT/both/capture.conf\";"
	             "for c in face both $QUICK; do echo 'quality = draft' >>\"$ROOT/$c/capture.conf\"; done");
}

/* A make that has nothing to do, as its user waits for it: what it looks at grows with the photographs. */
static void hundred(const char *root)
{
	enum { REPS = 7 };
	double s[REPS];
	char *dir = mem_printf("%s/hundred", root);
	setenv("C", dir, 1);
	bool ok = shell("mkdir -p \"$C/photos\"; cat samples/demo/capture.conf >\"$C/capture.conf\"; printf 'quality = draft\\nrender.size_px = 96\\n"
	                "render.frame_px = 64\\nrender.photo_px = 64\\nrender.map_size = 128\\nrender.vein_map_px = 128\\nunrefract.max_size = 64\\n'"
	                " >>\"$C/capture.conf\"; for i in $(seq 100); do { cat samples/demo/photos/right_softbox.jpg; echo $i; } >\"$C/photos/right_$i.jpg\"; done");
	double begin = now_s();
	ok = ok && shell(MAKE);
	double anew = now_s() - begin;
	for (int i = 0; i < REPS && ok; i++)
		s[i] = timed(&(struct run){ "true", MAKE });
	if (ok) {
		struct bench_time t = bench_time_of(REPS, s);
		bench_row("a make of 100 photographs", "nothing changed", "all stages", t, "make", 100 * (1 - t.median / anew), "%", "time saved");
		bench_row("a make of 100 photographs", "begun anew", "all stages", (struct bench_time){ anew, anew, anew }, "make", NAN, "", "");
		bench_goal("nothing changed, 100 photographs", "< 0.3 s", t.median, "s", t.median < 0.3);
	} else {
		fprintf(stderr, "100 photographs: failed\n");
	}
	free(dir);
}

int main(int argc, char **argv)
{
	bench_open("skips", argc, argv);
	const char *root = scratch_open();
	char *last = 0;
	if (!make_captures(root))
		printf("samples/ is not there: nothing measured\n");
	for (int i = 0; i < COUNT(skips); i++) {
		if (bench_quick() && skips[i].slow)
			continue;
		char *capture = mem_printf("%s/%s", root, skips[i].capture);
		setenv("C", capture, 1);
		if (!last || strcmp(last, capture))  // what comes before the stages here
			shell(strcmp(skips[i].capture, "face") ? MAKE "relief && " MAKE "refraction" : MAKE "track");
		measure(&skips[i], skips[i].slow || bench_quick() ? 1 : 3);
		free(last);
		last = capture;
	}
	free(last);
	if (!bench_quick())
		hundred(root);
	scratch_close();
	return bench_close();
}
