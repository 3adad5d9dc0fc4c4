/* Finding and measuring the limbus: the rendered captures, and the grid of 240 synthetic eyes beside other detectors.
 * "quoted" rows are figures published for another grid of the same kind; they were not run here. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "bridge/cv_ellipse.h"
#include "limbus/record.h"
#include "tests/bench/integro.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/truth/truth.h"

enum { OURS, OTSU, HOUGH, INTEGRO, METHODS };
static const char *const names[METHODS] = { "ours", "Otsu + OpenCV fitEllipse", "OpenCV Hough circle",
	"integro-differential operator" };

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double ellipse_error(const struct ellipse *a, const struct ellipse *b)
{
	return fmax(hypot(a->cx - b->cx, a->cy - b->cy), fmax(fabs(a->a - b->a), fabs(a->b - b->b)));
}

static struct bench_time spread(int n, double *seconds)
{
	double low = stats_quantile(n, seconds, 0.1), high = stats_quantile(n, seconds, 0.9);
	return (struct bench_time){ stats_median(n, seconds), low, high };
}

static double axis_of(const struct limbus_found *found, const struct photo *photo, const struct truth *truth)
{
	struct limbus_record *r = mem_new(1, sizeof *r);
	struct pose pose;
	struct err err = { 0 };
	limbus_record_fill(r, found, photo);
	r->view.camera = (struct camera){ .focal_px = truth->focal_px, .source = CAMERA_CONF,
		                          .center_px = { truth->center_px[0], truth->center_px[1] } };
	double dot = -1;
	if (limbus_pose(&pose, &r->view, &truth->eye, &pose_defaults, &err)) {
		dot = 0;
		for (int i = 0; i < 3; i++)
			dot += pose.cam_from_eye[i][2] * truth->cam_from_eye[i][2];
	}
	free(r);
	return acos(fmin(dot, 1)) * 180 / M_PI;
}

static void captures(void)
{
	char *dirs[64];
	int n = truth_captures(dirs, 64), used = 0, reps = bench_quick() ? 3 : 5;
	double error[64], axis[64], seconds[64];
	char name[64][64];
	struct limbus_found *found = mem_new(1, sizeof *found);
	for (int i = 0; i < n; i++) {
		struct truth truth;
		struct photo photo = { 0 };
		struct err err = { 0 };
		if ((bench_quick() && i % 3) || !truth_load(&truth, dirs[i], &err) || !photo_load(&photo, truth.photo, 100, &err))
			continue;
		double t[5];
		for (int k = 0; k < reps; k++) {
			double begin = now();
			limbus_find(found, &photo, 0, &limbus_defaults);
			t[k] = now() - begin;
		}
		seconds[used] = stats_median(reps, t);
		error[used] = found->ok ? ellipse_error(&found->limbus.e, &truth.limbus) : 1e3;
		axis[used] = found->ok ? axis_of(found, &photo, &truth) : 180;
		struct bench_time time = { seconds[used], seconds[used], seconds[used] };
		bench_row("captures, ellipse", "ours", truth.name, time, "photograph", error[used], "px", "centre, semi-axes");
		snprintf(name[used++], sizeof name[0], "%s", truth.name);
		photo_free(&photo);
		free(dirs[i]);
	}
	free(found);
	if (used == 0)
		return;
	for (int i = 0; i < used; i++)
		bench_row("captures, axis", "ours", name[i], (struct bench_time){ seconds[i], seconds[i], seconds[i] }, "photograph",
		          axis[i], "deg", "optical axis");
	double worst = stats_quantile(used, error, 1), median = stats_median(used, error);
	bench_goal("ellipse centre, semi-axes: median", "<= 0.3 px", median, "px", median <= 0.3);
	bench_goal("ellipse centre, semi-axes: worst", "<= 1.5 px", worst, "px", worst <= 1.5);
	worst = stats_quantile(used, axis, 1);
	median = stats_median(used, axis);
	bench_goal("optical axis, camera known: median", "<= 0.5 deg", median, "deg", median <= 0.5);
	bench_goal("optical axis, camera known: worst", "<= 2 deg", worst, "deg", worst <= 2);
	double time = stats_median(used, seconds) * 1e3;
	bench_goal("finding and fitting the limbus, 1600 x 1200", "<= 100 ms", time, "ms", time <= 100);
}

struct tally {
	int n, within5, within1, wrong;
	double *seconds;
};

static bool detect(int method, struct ellipse *e, const struct photo *photo, const uint8_t *grey,
                   struct limbus_found *found)
{
	const double shorter = fmin(photo->width, photo->height);
	switch (method) {
	case OURS:
		limbus_find(found, photo, 0, &limbus_defaults);
		*e = found->limbus.e;
		return found->ok;
	case OTSU: return cv_otsu_ellipse(e, grey, photo->width, photo->height);
	case HOUGH: return cv_hough_circle(e, grey, photo->width, photo->height, 0.1 * shorter, 0.4 * shorter);
	default: return integro_circle(e, grey, photo->width, photo->height, 0.1 * shorter, 0.4 * shorter);
	}
}

static void grid_eye(struct tally tally[METHODS], int index, struct limbus_found *found)
{
	struct synth_eye eye = synth_eye_grid(index);
	struct synth_truth truth;
	struct photo photo = synth_eye_render(&eye, &truth);
	const size_t n = (size_t)photo.width * (size_t)photo.height;
	uint8_t *grey = mem_array(n, 1);
	for (size_t i = 0; i < n; i++)
		grey[i] = (uint8_t)((photo.rgb[3 * i] + photo.rgb[3 * i + 1] + photo.rgb[3 * i + 2]) / 3 >> 8);
	for (int m = 0; m < METHODS; m++) {
		struct ellipse e = { 0 };
		double t = now();
		bool ok = detect(m, &e, &photo, grey, found);
		tally[m].seconds[tally[m].n++] = now() - t;
		double error = ok ? ellipse_error(&e, &truth.limbus) / truth.limbus.a : 1;
		tally[m].within5 += error < 0.05;
		tally[m].within1 += error < 0.01;
		tally[m].wrong += ok && error >= 0.05;
	}
	free(grey);
	photo_free(&photo);
}

static void grid(void)
{
	static const struct { const char *name; double within5, ms; } quoted[] = {
		{ "Swirski (quoted)", 83, 170 }, { "PuRe (quoted)", 59, 2 }, { "arc-support line segments (quoted)", 55, 28 },
		{ "EyeTab-style (quoted)", 67, NAN },
	};
	const int per = SYNTH_GRID / SYNTH_LEVELS, step = bench_quick() ? 24 : 2;
	struct limbus_found *found = mem_new(1, sizeof *found);
	double within1[SYNTH_LEVELS][METHODS];
	struct bench_time times[SYNTH_LEVELS][METHODS];
	int hit40 = 0, n40 = 0, wrong = 0, all = 0, n_all = 0;
	for (int l = 0; l < SYNTH_LEVELS; l++) {
		struct tally tally[METHODS] = { 0 };
		for (int m = 0; m < METHODS; m++)
			tally[m].seconds = mem_new((size_t)per, sizeof(double));
		for (int i = l % step; i < per; i += step)
			grid_eye(tally, l * per + i, found);
		for (int m = 0; m < METHODS; m++) {
			char setting[32];
			snprintf(setting, sizeof setting, "%d %% covered", 15 * l);
			times[l][m] = spread(tally[m].n, tally[m].seconds);
			within1[l][m] = 100.0 * tally[m].within1 / tally[m].n;
			bench_row("grid, within 5 % of a", names[m], setting, times[l][m], "photograph",
			          100.0 * tally[m].within5 / tally[m].n, "%", "found");
			free(tally[m].seconds);
		}
		wrong += tally[OURS].wrong;
		all += tally[OURS].within5;
		n_all += tally[OURS].n;
		if (l < 3) {
			hit40 += tally[OURS].within5;
			n40 += tally[OURS].n;
		}
	}
	for (int i = 0; i < (int)(sizeof quoted / sizeof *quoted); i++)
		bench_row("grid, within 5 % of a", quoted[i].name, "all", (struct bench_time){ quoted[i].ms / 1e3, quoted[i].ms / 1e3,
		          quoted[i].ms / 1e3 }, "photograph", quoted[i].within5, "%", "found");
	for (int l = 0; l < SYNTH_LEVELS; l++)
		for (int m = 0; m < METHODS; m++) {
			char setting[32];
			snprintf(setting, sizeof setting, "%d %% covered", 15 * l);
			bench_row("grid, within 1 % of a", names[m], setting, times[l][m], "photograph", within1[l][m], "%", "found");
		}
	bench_goal("limbus found on the grid to 40 % covered", "100 %", 100.0 * hit40 / n40, "%", hit40 == n40);
	bench_goal("wrong instead of rejected, whole grid", "0", wrong, "", wrong == 0);
	bench_goal("within 5 %, whole grid", "> 83 % (Swirski, quoted)", 100.0 * all / n_all, "%", all > 0.83 * n_all);
	free(found);
}

int main(int argc, char **argv)
{
	bench_open("limbus", argc, argv);
	captures();
	grid();
	return bench_close();
}
