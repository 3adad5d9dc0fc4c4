/* The interactive page in a headless Chromium, at 1280 x 1024: size, time until the first picture stands, frames by preset, what
 * they would take on GPUs of 2015 by what the shaders compute and read (tests/browser/count.js), and which preset the page falls
 * back to by itself. Run from the top of the checkout; needs chromium and node. EYEWRIGHT_BROWSER_GL=vulkan (or gl, gl-egl): on
 * this machine's graphics processor instead of software. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"

enum { REPS = 8 };

/* A script of the shell, to which R is the folder. */
static bool run(const char *script, const char *dir)
{
	char *command = mem_printf("R='%s'; %s", dir, script);
	bool ok = system(command) == 0;
	free(command);
	return ok;
}

static double megabytes(const char *page)
{
	struct stat st;
	return stat(page, &st) ? NAN : (double)st.st_size / 1e6;
}

/* What one run of the browser says. */
struct said {
	double opened, fallback_s;
	char driver[160], starts[32], fallback[32], size[32];
};

static void frame_row(const char *what, const char *line, const char *driver)
{
	char name[32];
	double s[REPS];
	int at = 0, n = 0, step;
	if (sscanf(line, "frame %31s%n", name, &at) != 1)
		return;
	while (n < REPS && sscanf(line + at, "%lf%n", &s[n], &step) == 1) {
		at += step;
		n++;
	}
	char *method = mem_printf("%s, %s", what, strstr(driver, "SwiftShader") ? "software GL" : "GPU");
	if (n)
		bench_row("interactive page, 1280 x 1024", method, name, bench_time_of(n, s), "frame", NAN, "", "");
	free(method);
}

/* An estimate: operations and texture reads of a picture, and the time these take. */
static void count_row(const char *what, const char *line)
{
	char preset[32];
	double operations, reads, s;
	int at = 0;
	if (sscanf(line, "count %31s %lf %lf %lf %n", preset, &operations, &reads, &s, &at) != 4)
		return;
	char *gpu = mem_printf("%.*s", (int)strcspn(line + at, "\n"), line + at);
	char *method = mem_printf("%s, %s (estimate)", what, gpu);
	char *setting = mem_printf("%s: %.2f G operations, %.1f M reads", preset, operations / 1e9, reads / 1e6);
	bench_row("interactive page, 1280 x 1024", method, setting, (struct bench_time){ s, s, s }, "frame", NAN, "", "");
	// The best preset, and the one that the page falls back to where that is too slow.
	static bool holds;
	bool best = !strcmp(preset, "full");
	if (strstr(gpu, "GTX") && (best || !holds)) {
		holds = s <= 1 / 60.0;
		char *goal = mem_printf("page with %s, %s, on a GPU of 2015 (%s; estimate from counted operations and reads, a third of its peak)", what,
		                        best ? "best preset" : setting, gpu);
		bench_goal(goal, "60 frames/s", 1 / s, "frames/s", holds);
		free(goal);
	}
	free(gpu);
	free(method);
	free(setting);
}

/* Pictures that leave something out, against those that do not: "skip WHAT SECONDS ...". */
static void skip_rows(const char *what, const char *line)
{
	static const char *const names[][2] = { { "open", "both eyes of a face, open" }, { "shut", "both eyes of a face, shut" },
		                                    { "traced", "light moves, all rays traced" }, { "shaded", "light moves, rays kept" } };
	double s[COUNT(names)];
	for (int i = 0; i < COUNT(names); i++) {
		char *key = mem_printf(" %s ", names[i][0]);
		const char *at = strstr(line, key);
		s[i] = at ? atof(at + strlen(key)) : NAN;
		free(key);
		if (at)
			bench_row("what is skipped, 1280 x 1024, software GL", what, names[i][1], (struct bench_time){ s[i], s[i], s[i] }, "frame", NAN, "", "");
	}
	if (isfinite(s[0])) {
		char *goal = mem_printf("page with %s: what closed eyes cost of open ones", what);
		bench_goal(goal, "< 10 %", 100 * s[1] / s[0], "%", s[1] < 0.1 * s[0]);
		free(goal);
		return;
	}
	// With a face most of the time is the skin's.
	char *goal = mem_printf("page with %s: while only a light moves no ray is traced again: a frame's time of one that traces all", what);
	bench_goal(goal, "< 100 %", 100 * s[3] / s[2], "%", s[3] < s[2]);
	free(goal);
}

static bool browse(struct said *said, const char *what, const char *page)
{
	char *command = mem_printf("timeout 100 node tests/browser/bench.js '%s' %d", page, bench_quick());
	char line[512];
	FILE *f = popen(command, "r");
	*said = (struct said){ .opened = NAN, .fallback_s = NAN };
	while (f && fgets(line, sizeof line, f)) {
		sscanf(line, "opened %lf", &said->opened);
		sscanf(line, "driver %159[^\n]", said->driver);
		sscanf(line, "fallback %31s %31s %lf", said->starts, said->fallback, &said->fallback_s);
		count_row(what, line);
		frame_row(what, line, said->driver);
		if (!strncmp(line, "skip ", 5))
			skip_rows(what, line + 4);
		if (!strncmp(line, "failed", 6))
			fprintf(stderr, "bench_viewer: %s: %s", what, line);
	}
	free(command);
	return f && pclose(f) == 0;
}

static void measure(const char *what, const char *page, double limit_mb)
{
	struct said said;
	double mb = megabytes(page);
	char *goal = mem_printf("page with %s: size", what), *reach = mem_printf("< %g MB", limit_mb);
	bench_goal(goal, reach, mb, "MB", mb < limit_mb);
	if (browse(&said, what, page)) {
		char *open = mem_printf("page with %s: until the first picture stands", what);
		char *back = mem_printf("page with %s on %s: from %s quality it falls back by itself to %s (frame %.0f ms)", what,
		                        strstr(said.driver, "SwiftShader") ? "software GL" : said.driver, said.starts, said.fallback, 1000 * said.fallback_s);
		bench_goal(open, "<= 2 s", said.opened, "s", said.opened <= 2);
		if (!bench_quick())
			bench_goal(back, "a cheaper preset", 1000 * said.fallback_s, "ms", strcmp(said.starts, said.fallback) != 0);
		free(open);
		free(back);
	}
	free(goal);
	free(reach);
}

int main(int argc, char **argv)
{
	bench_open("viewer", argc, argv);
	if (system("command -v chromium >/dev/null && command -v node >/dev/null")) {
		printf("bench_viewer: no chromium or no node: the page is not driven (apt-get install chromium nodejs)\n");
		return bench_close();
	}
	const char *root = scratch_open();
	// An eye in the maps of a review, its other stages in a draft.
	bool eye = run("mkdir -p $R/eye/photos && cp samples/demo/photos/*.jpg $R/eye/photos && cp samples/demo/capture.conf $R/eye && "
	               "printf 'quality = draft\\nrender.map_size = 1024\\nrender.vein_map_px = 1536\\n' >>$R/eye/capture.conf && "
	               "make --no-print-directory CAPTURE=$R/eye >$R/log 2>&1 </dev/null", root);
	bool face = !bench_quick() && run("make --no-print-directory build/tests/tools/made_face >$R/log 2>&1 && build/tests/tools/made_face $R/face && "
	                "echo 'render.clip_px = 0' >>$R/face/capture.conf && bin/extrapolate --capture=$R/face --quiet && "
	                "bin/render --capture=$R/face --quiet", root);
	if (eye)
		measure("an eye", scratch_path("eye/work/review/viewer.html"), 10);
	if (face)
		measure("a face", scratch_path("face/work/review/viewer.html"), 20);
	scratch_close();
	return bench_close();
}
