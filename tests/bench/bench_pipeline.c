/* The whole chain, as a user runs it: make on each rendered capture with truth; time, memory, and error of what came
 * out: limbus ellipse, optical axis, unrefracted position. Run from the top of the checkout.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/exr.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"
#include "tests/lib/truth/truth.h"

enum { MAX_CAPTURES = 64, LIMIT_PX = 1 << 26 };

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void show_end(const char *path)
{
	char line[1024], last[3][1024] = { "", "", "" };
	FILE *f = fopen(path, "r");
	for (int i = 0; f && fgets(line, sizeof line, f); i++)
		memcpy(last[i % 3], line, sizeof line);
	fprintf(stderr, "make failed; the end of %s:\n%s%s%s", path, last[0], last[1], last[2]);
	if (f)
		fclose(f);
}

/* Wall-clock seconds of `make CAPTURE=dir`; negative when it fails: the end of its log, dir.log, is shown then. */
static double run_make(const char *dir)
{
	double start = now_s();
	fflush(stdout);
	pid_t pid = fork();
	if (!pid) {
		char *log = mem_printf("%s.log", dir), *capture = mem_printf("CAPTURE=%s", dir);
		if (!freopen(log, "a", stderr) || !freopen(log, "a", stdout))
			_exit(1);
		execlp("make", "make", "--no-print-directory", capture, (char *)0);
		_exit(127);
	}
	int status = 1;
	waitpid(pid, &status, 0);
	double seconds = now_s() - start;
	if (WIFEXITED(status) && !WEXITSTATUS(status))
		return seconds;
	char *log = mem_printf("%s.log", dir);
	show_end(log);
	free(log);
	return -1;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double quantile(double *x, long n, double q)
{
	if (!n)
		return NAN;
	qsort(x, (size_t)n, sizeof *x, by_value);
	return x[(long)(q * (double)(n - 1) + 0.5)];
}

struct errors {
	double centre_px[MAX_CAPTURES], axes_px[MAX_CAPTURES], axis_deg[MAX_CAPTURES];
	double map_median[MAX_CAPTURES], map_95[MAX_CAPTURES];
	int n, n_map, found;
};

static void compare_fit(struct errors *e, const struct truth *t, const struct fit *f)
{
	double dot = 0;
	for (int i = 0; i < 3; i++)
		dot += f->cam_from_eye[i][2] * t->cam_from_eye[i][2];
	e->centre_px[e->n] = hypot(f->limbus.cx - t->limbus.cx, f->limbus.cy - t->limbus.cy);
	e->axes_px[e->n] = fmax(fabs(f->limbus.a - t->limbus.a), fabs(f->limbus.b - t->limbus.b));
	e->axis_deg[e->n] = acos(fmin(dot, 1)) * 180 / M_PI;
	printf("%-24s centre %.3f px  axes %.3f px  axis %.3f deg (theta %.2f, sigma %.2f)\n", t->name, e->centre_px[e->n],
	       e->axes_px[e->n], e->axis_deg[e->n], f->theta * 180 / M_PI, f->theta_sigma * 180 / M_PI);
	e->n++;
}

/* Distances between our per-pixel map and the independent one, inside 0.9 of the iris radius. */
static long map_distances(double *d, const struct image *ours, const struct image *truth, const struct truth *t)
{
	long n = 0;
	for (int y = 0; y < truth->height; y++)
		for (int x = 0; x < truth->width; x++) {
			const float *p = image_at(truth, x, y), *q = image_at(ours, 2 * x, 2 * y);
			double in[2] = { (double)p[0], (double)p[1] }, want[2];
			if (lroundf(p[2]) != 1 || hypot(in[0], in[1]) > 0.9 * t->iris_radius)
				continue;
			truth_turn(want, t, in);
			double error = hypot((double)q[0] - want[0], (double)q[1] - want[1]);
			if (isfinite(error))
				d[n++] = error;
		}
	return n;
}

static void compare_map(struct errors *e, const struct truth *t, const char *ours_path, const char *truth_path)
{
	static const char *const xy[] = { "X", "Y" }, *const rga[] = { "R", "G", "A" };
	struct image ours = { 0 }, truth = { 0 };
	struct err err = { 0 };
	if (!file_exists(truth_path) || !file_exists(ours_path))
		return;
	if (exr_read(&ours, ours_path, 2, xy, LIMIT_PX, 0, &err) && exr_read(&truth, truth_path, 3, rga, LIMIT_PX, 0, &err)
	    && ours.width >= 2 * truth.width - 1 && ours.height >= 2 * truth.height - 1) {
		double *d = mem_new((size_t)truth.width * (size_t)truth.height, sizeof *d);
		long n = map_distances(d, &ours, &truth, t);
		e->map_median[e->n_map] = quantile(d, n, 0.5);
		e->map_95[e->n_map] = quantile(d, n, 0.95);
		printf("%-24s unrefracted position: median %.4f mm, 95 %% %.4f mm, %ld px\n", t->name, e->map_median[e->n_map],
		       e->map_95[e->n_map], n);
		e->n_map++;
		free(d);
	} else
		fprintf(stderr, "%s: %s\n", ours_path, err.msg);
	image_free(&ours);
	image_free(&truth);
}

static void one_capture(struct errors *e, const char *dir, const char *root)
{
	struct truth t;
	struct err err = { 0 };
	struct fit fit;
	if (!truth_load(&t, dir, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return;
	}
	char *capture = mem_printf("%s/%s", root, t.name), *json = mem_printf("%s/work/limbus/%s.json", capture, t.name);
	char *map = mem_printf("%s/work/iris/%s.map.exr", capture, t.name), *truth_map = mem_printf("%s/map.exr", dir);
	double seconds = truth_make_capture(&t, capture, "unrefract.write_map = yes\n", &err) ? run_make(capture) : -1;
	printf("%-24s make: %.2f s\n", t.name, seconds);
	if (fit_load(&fit, json, &err) && fit.ok) {
		e->found++;
		compare_fit(e, &t, &fit);
		compare_map(e, &t, map, truth_map);
	} else
		printf("%-24s %s%s\n", t.name, err.msg, fit.reason);
	free(capture);
	free(json);
	free(map);
	free(truth_map);
}

static void time_chain(const struct truth *t, const char *root, const char *quality, double bar_s)
{
	char *extra = mem_printf("quality = %s\n", quality), *reach = mem_printf("<= %g s", bar_s);
	char *measure = mem_printf("whole pipeline, %s, 1600 x 1200", quality);
	double times[5];
	int reps = bench_quick() ? 1 : 5;
	struct err err = { 0 };
	for (int i = 0; i < reps; i++) {
		char *capture = mem_printf("%s/time-%s-%d", root, quality, i);
		if (!truth_make_capture(t, capture, extra, &err))
			fprintf(stderr, "%s\n", err.msg);
		times[i] = run_make(capture);
		if (i == 0) {
			double again = run_make(capture);
			struct bench_time once = { again, again, again };
			bench_row("whole pipeline", "second make", quality, once, "make", NAN, "", "");
		}
		free(capture);
	}
	double median = quantile(times, reps, 0.5);
	struct bench_time time = { median, times[0], times[reps - 1] };
	bench_row("whole pipeline", "make", quality, time, "photograph", NAN, "", "");
	bench_goal(measure, reach, median, "s", times[0] > 0 && median <= bar_s);
	free(extra);
	free(measure);
	free(reach);
}

/* The same picture enlarged. Peak memory: the largest of all programs run so far, so larger pictures come later. */
static void time_large(struct truth t, const char *root, int big_w, int big_h, double most_s, double most_gib)
{
	char *setting = mem_printf("%d megapixels", (int)lrint(1e-6 * big_w * big_h));
	uint8_t *px, *jpeg;
	int w, h;
	size_t size;
	struct err err = { 0 };
	char *path = mem_printf("%s/big.jpg", root), *capture = mem_printf("%s/large_%d", root, big_w);
	if (!picture_read(&px, &w, &h, t.photo, 100, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return;
	}
	uint8_t *big = cv_resize8(px, w, h, 3, big_w, big_h);
	double scale = (double)big_w / w;
	if (picture_jpeg_encode(&jpeg, &size, big, big_w, big_h, 3, 92, &err) && file_write(path, jpeg, size, &err)) {
		snprintf(t.photo, sizeof t.photo, "%s", path);
		t.focal_px *= scale;
		t.center_px[0] *= scale;
		t.center_px[1] *= scale;
		double seconds = truth_make_capture(&t, capture, 0, &err) ? run_make(capture) : -1;
		struct rusage use;
		getrusage(RUSAGE_CHILDREN, &use);
		double gib = (double)use.ru_maxrss / 1048576;
		struct bench_time once = { seconds, seconds, seconds };
		bench_row("whole pipeline", "make", setting, once, "photograph", gib, "GiB", "peak memory");
		char *time = mem_printf("whole pipeline, %s", setting), *memory = mem_printf("%s: memory", time);
		char *time_reach = mem_printf("<= %g s", most_s), *memory_reach = mem_printf("<= %g GiB", most_gib);
		bench_goal(time, time_reach, seconds, "s", seconds > 0 && seconds <= most_s);
		bench_goal(memory, memory_reach, gib, "GiB", seconds > 0 && gib <= most_gib);
		free(time);
		free(memory);
		free(time_reach);
		free(memory_reach);
		free(jpeg);
	}
	free(big);
	free(px);
	free(path);
	free(capture);
	free(setting);
}

static void goal(const char *measure, double *values, int n, double q, double bar, const char *unit)
{
	double value = quantile(values, n, q);
	char *reach = mem_printf("<= %g %s", bar, unit);
	bench_goal(measure, reach, value, unit, value <= bar);
	free(reach);
}

int main(int argc, char **argv)
{
	bench_open("pipeline", argc, argv);
	char *dirs[MAX_CAPTURES];
	int n = truth_captures(dirs, MAX_CAPTURES);
	struct errors e = { 0 };
	struct truth t;
	struct err err = { 0 };
	if (!n) {
		printf("no captures with truth: nothing measured\n");
		return bench_close();
	}
	const char *root = scratch_open();
	if (truth_load(&t, dirs[n - 1], &err)) {
		if (!bench_quick())
			time_chain(&t, root, "draft", 2);
		time_chain(&t, root, "review", 10);
		if (!bench_quick()) {
			time_large(t, root, 5664, 4248, 30, 2);
			time_large(t, root, 11547, 8660, 60, 1);
		}
	}
	int made = 0;
	for (int i = 0; i < n; i++) {
		if (!bench_quick() || i == 0) {
			one_capture(&e, dirs[i], root);
			made++;
		}
		free(dirs[i]);
	}
	bench_goal("limbus found, captures", "100 %", 100.0 * e.found / made, "%", e.found == made);
	goal("ellipse centre, median", e.centre_px, e.n, 0.5, 0.3, "px");
	goal("ellipse centre, worst", e.centre_px, e.n, 1, 1.5, "px");
	goal("ellipse semi-axes, median", e.axes_px, e.n, 0.5, 0.3, "px");
	goal("ellipse semi-axes, worst", e.axes_px, e.n, 1, 1.5, "px");
	goal("optical axis, median", e.axis_deg, e.n, 0.5, 0.5, "deg");
	goal("optical axis, worst", e.axis_deg, e.n, 1, 2, "deg");
	goal("unrefracted position, median of the worst capture", e.map_median, e.n_map, 1, 0.03, "mm");
	goal("unrefracted position, 95 % of the worst capture", e.map_95, e.n_map, 1, 0.1, "mm");
	scratch_close();
	return bench_close();
}
