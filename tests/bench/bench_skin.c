/* bench_skin: the whole skin column as a user runs it: a video of 300 frames, a mesh, a character of 14 000 vertices; make;
 * time by stage, and the error of what came out against the capture's own truth. Run from the top of the checkout. */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"

static const char sample[] = "samples/face";
static const char *const stages[] = { "track", "train", "transfer", "extrapolate", "animate", "render" };

/* Seconds a program took; negative when it failed. What it says goes to `log`. */
static double run(const char *log, char *const argv[])
{
	struct timespec a, b;
	clock_gettime(CLOCK_MONOTONIC, &a);
	fflush(stdout);
	pid_t pid = fork();
	if (!pid) {
		if (!freopen(log, "a", stderr) || !freopen(log, "a", stdout))
			_exit(1);
		execvp(argv[0], argv);
		_exit(127);
	}
	int status = 1;
	waitpid(pid, &status, 0);
	clock_gettime(CLOCK_MONOTONIC, &b);
	double s = (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec);
	return WIFEXITED(status) && !WEXITSTATUS(status) ? s : -1;
}

/* Skin and eyeballs of the head with 14 388 vertices, as a target of its own; false where the shared data is not. */
static bool big_target(const char *to)
{
	enum { SKIN = 11248, EYES = 21451, END = 24591 };
	const char *from = bench_data("meshes/ict/generic_neutral_mesh.obj");
	FILE *in = from ? fopen(from, "r") : 0, *out = in ? fopen(to, "w") : 0;
	char line[512];
	long n = 0;
	while (out && fgets(line, sizeof line, in)) {
		long v[4] = { 0 };
		if (!strncmp(line, "v ", 2)) {
			if (n < SKIN || (n >= EYES && n < END))
				fputs(line, out);
			n++;
		} else if (!strncmp(line, "f ", 2)) {
			int got = 0, used = 0;
			bool ours = true;
			for (char *at = line + 1; got < 4 && sscanf(at, " %ld%n", &v[got], &used) == 1; got++) {
				at += used + (int)strcspn(at + used, " \n");
				long i = v[got] - 1;
				ours = ours && (i < SKIN || (i >= EYES && i < END));
				v[got] = i < SKIN ? i + 1 : i - EYES + SKIN + 1;
			}
			if (ours && got >= 3)
				fprintf(out, got == 4 ? "f %ld %ld %ld %ld\n" : "f %ld %ld %ld\n", v[0], v[1], v[2], v[3]);
		}
	}
	if (in)
		fclose(in);
	return out && !fclose(out);
}

static bool make_capture(const char *dir, const char *quality, bool big)
{
	char *copy = mem_printf("mkdir -p '%s' && cp -r %s/video %s/targets %s/script %s/subject.ply %s/capture.conf '%s'", dir, sample, sample,
	                        sample, sample, sample, dir);
	char *target = mem_printf("%s/targets/head.obj", dir), *other = mem_printf("%s/targets/mpfb.obj", dir), *conf = mem_printf("%s/capture.conf", dir);
	// Quick: half of the clip; what a copy that broke off leaves is followed as far as it goes. Expressions come later in it.
	char *half = mem_printf("head -c 1300000 %s/video/face.mp4 >'%s/video/face.mp4' && sed -i '/^expression/d' '%s/capture.conf' && "
	                        "sed 1d %s/script/look_around.csv | cut -d, -f1-7 >'%s/script/look_around.csv'", sample, dir, dir, sample, dir);
	bool ok = !system(copy) && (!bench_quick() || !system(half));
	free(half);
	if (ok && big && big_target(target))
		remove(other);
	FILE *out = ok ? fopen(conf, "a") : 0;
	if (out) {
		fprintf(out, "quality = %s\ntarget.head.unit_mm = 10\n%s", quality, bench_quick() ? "render.clip_seconds = 1\n" : "");
		fclose(out);
	}
	free(copy);
	free(target);
	free(other);
	free(conf);
	return out;
}

static double stage_number(const char *dir, const char *stage, const char *key)
{
	struct err err = { 0 };
	char *path = mem_printf("%s/work/log/%s.json", dir, stage);
	json_t *log = file_exists(path) ? json_read(path, 1 << 24, &err) : 0;
	json_t *v = key ? json_object_get(json_object_get(json_object_get(log, "figures"), key), "value") : json_object_get(log, "seconds");
	double x = json_is_number(v) ? json_number_value(v) : NAN;
	json_decref(log);
	free(path);
	return x;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Median error of the tracked gaze against the sample's truth, open eyes; NAN without either. deg. */
static double gaze_error(const char *dir)
{
	struct csv_table t = { 0 };
	struct npy truth[2] = { 0 }, state = { 0 };
	struct err err = { 0 };
	char *csv = mem_printf("%s/work/skin/gaze.csv", dir), *npz = mem_printf("%s/truth/truth.npz", sample);
	double median = NAN;
	if (csv_read(&t, csv, &err) && npz_read(&truth[0], npz, "gaze_left_deg", NPY_LIMIT, &err)
	    && npz_read(&truth[1], npz, "gaze_right_deg", NPY_LIMIT, &err) && npz_read(&state, npz, "blink_state", NPY_LIMIT, &err)) {
		double *want[2] = { npy_doubles(&truth[0]), npy_doubles(&truth[1]) }, *blink = npy_doubles(&state);
		double *e = mem_new(4 * (size_t)t.n_rows + 1, sizeof *e);
		int n = 0;
		for (long f = 0; f < t.n_rows && f < truth[0].shape[0]; f++)
			for (int k = 0; k < 4 && blink[f] == 0; k++) {
				const char *names[4] = { "g1_deg", "g2_deg", "g6_deg", "g7_deg" };
				double got = csv_at(&t, f, csv_column(&t, names[k])), d = fabs(got - want[k / 2][3 * f + k % 2]);
				if (isfinite(d))
					e[n++] = d;
			}
		qsort(e, (size_t)n, sizeof *e, by_value);
		median = n ? e[n / 2] : NAN;
		free(want[0]);
		free(want[1]);
		free(blink);
		free(e);
	}
	csv_table_free(&t);
	npy_free(&truth[0]);
	npy_free(&truth[1]);
	npy_free(&state);
	free(csv);
	free(npz);
	return median;
}

static void measure(const char *root, const char *quality, bool goal)
{
	char *dir = mem_printf("%s/%s", root, quality), *log = mem_printf("%s.log", dir), *capture = mem_printf("CAPTURE=%s", dir);
	char *const argv[] = { "make", "--no-print-directory", capture, 0 };
	if (!make_capture(dir, quality, true)) {
		fprintf(stderr, "bench_skin: %s cannot be copied\n", sample);
		return;
	}
	double s = run(log, argv), again = s > 0 ? run(log, argv) : NAN, gaze = gaze_error(dir);
	const char *per = bench_quick() ? "half the frames" : "300 frames";
	struct bench_time whole = { s, s, s }, second = { again, again, again };
	bench_row("skin column", "make", quality, whole, per, gaze, "deg", "tracked gaze, open eyes, median");
	bench_row("skin column", "second make", quality, second, "make", NAN, "", "");
	for (int i = 0; i < (int)(sizeof stages / sizeof *stages); i++) {
		double t = stage_number(dir, stages[i], 0);
		struct bench_time one = { t, t, t };
		if (isfinite(t))
			bench_row("stages of the skin column", stages[i], quality, one, per, NAN, "", "");
	}
	printf("eyes told to close stay open by %.2f mm as learnt, %.2f mm sealed; morph targets %.2f mm off at worst\n",
	       stage_number(dir, "extrapolate", "open_when_closed"), stage_number(dir, "extrapolate", "open_after_sealing"),
	       stage_number(dir, "render", "morph_worst"));
	if (goal)
		bench_goal("whole skin column, 300 frames of 1280 x 720, a target of 14 000 vertices, review", "<= 60 s", s, "s", s > 0 && s <= 60);
	free(dir);
	free(log);
	free(capture);
}

int main(int argc, char **argv)
{
	bench_open("skin", argc, argv);
	for (int i = 0; i < (int)(sizeof stages / sizeof *stages); i++) {
		char *program = mem_printf("bin/%s", stages[i]);
		bool built = file_exists(program);
		free(program);
		if (!built && strcmp(stages[i], "animate")) {
			printf("bin/%s is not built: nothing measured\n", stages[i]);
			return bench_close();
		}
	}
	const char *root = scratch_open();
	measure(root, "draft", false);
	if (!bench_quick())
		measure(root, "review", true);
	scratch_close();
	return bench_close();
}
