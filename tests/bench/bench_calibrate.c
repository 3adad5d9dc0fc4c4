/* Cameras and mesh of a head from 67 photographs with known projection matrices, as a user runs it: time, error of the
 * camera centres, reprojection error, distance of the mesh from a surface measured with the known cameras; and what one
 * more photograph costs. COLMAP's own defaults beside it on eight of the photographs; on all of them they take half an hour
 * and run once, where CALIBRATE_DEFAULTS=DIR says (what they found and took stays there).
 * CALIBRATE_SETS="small defaults review more final mesh fountain" (any of them) measures a part. --quick: the reading of
 * COLMAP's files alone. Run from the top of the checkout.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/run.h"
#include "sfm/colmap/colmap.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/capture/views_capture.h"
#include "tests/lib/scenes/sfm_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/truth/views_truth.h"
#include "tests/peers/colmap_defaults.h"
#include "tests/peers/sweep.h"

static bool wanted(const char *set)
{
	const char *sets = getenv("CALIBRATE_SETS");
	return !sets || strstr(sets, set);
}

/* Wall time is what a user waits, on this machine as busy as it is; processor time hardly depends on other programs. */
static void time_row(const char *method, const char *setting, struct spent s, const char *set, double error)
{
	struct bench_time wall = { s.wall, s.wall, s.wall }, cpu = { s.cpu, s.cpu, s.cpu };
	bench_row("calibrate", method, setting, wall, set, error, "%", "camera centres, mean, of the orbit's extent");
	bench_row("calibrate, processor time", method, setting, cpu, set, error, "%", "camera centres, mean, of the orbit's extent");
	printf("%-24s %-12s %-14s %.1f s wall, %.1f s of processors\n", method, setting, set, s.wall, s.cpu);
}

static const char *set_name(const struct views_truth *truth, int n)
{
	static char name[40];
	snprintf(name, sizeof name, "%d photographs%s", n, n < truth->n ? " of them" : "");
	return name;
}

/* Time and error of the cameras of that file; false, said, when they cannot be compared. */
static bool judge_cameras(struct views_fit *fit, double *px, const char *method, const char *setting, struct spent s,
                          const struct camera_rig *rig, int n, const struct views_truth *truth)
{
	if (!views_fit(fit, truth, rig)) {
		fprintf(stderr, "%s: too few cameras\n", method);
		return false;
	}
	double percent = 100 * fit->mean / truth->extent;
	*px = views_residual(rig);
	time_row(method, setting, s, set_name(truth, n), percent);
	printf("%s, %s: centres %.4f %% mean, %.4f %% worst, %.3f px, %d of %d\n", method, setting, percent, 100 * fit->worst / truth->extent,
	       *px, fit->n, n);
	return true;
}

static void judge(const char *dir, const char *quality, struct spent s, const struct views_truth *truth,
                  const struct sweep_points *surface)
{
	struct camera_rig rig = { 0 };
	struct views_fit fit;
	struct err err = { 0 };
	char *path = mem_printf("%s/work/rig.json", dir), *subject = mem_printf("%s/work/subject.ply", dir);
	double bar = strcmp(quality, "final") ? 0.1 : 0.05, px, middle;
	if (s.wall < 0 || !camera_rig_load(&rig, path, &err))
		fprintf(stderr, "%s\n", err.msg);
	else if (judge_cameras(&fit, &px, "calibrate", quality, s, &rig, truth->n, truth)) {
		double percent = 100 * fit.mean / truth->extent, share;
		char *reach = mem_printf("<= %g %%", bar), *name = mem_printf("camera centres, %s, mean of the orbit's extent", quality);
		char *registered = mem_printf("registered of 67, %s", quality), *error = mem_printf("reprojection error, %s, mean", quality);
		char *within = mem_printf("mesh within 1 %% of the head's size, %s", quality);
		bench_goal(name, reach, percent, "%", percent <= bar);
		bench_goal(registered, "all", fit.n, "", fit.n == truth->n);
		bench_goal(error, "<= 0.7 px", px, "px", px <= 0.7);
		if (surface->n && views_mesh_within(&share, &middle, subject, &fit, surface, &err)) {
			printf("mesh: %.1f %% within 1 %%, middle distance %.3f %%\n", 100 * share, 100 * middle);
			bench_row("subject mesh", "calibrate", quality, (struct bench_time){ NAN, NAN, NAN }, "mesh", 100 * middle, "%",
			          "distance from the surface, median, of the head's size");
			bench_goal(within, ">= 90 %", 100 * share, "%", share >= 0.9);
		}
		free(reach);
		free(name);
		free(registered);
		free(error);
		free(within);
	}
	camera_rig_free(&rig);
	free(path);
	free(subject);
}

static void beside(const char *dir, const char *images, int n, const struct views_truth *truth)
{
	struct camera_rig rig = { 0 };
	struct views_fit fit;
	struct spent s;
	struct err err = { 0 };
	double px;
	if (colmap_defaults(&rig, &s, dir, images, &err))
		judge_cameras(&fit, &px, "COLMAP's own defaults", "exhaustive", s, &rig, n, truth);
	else
		fprintf(stderr, "%s\n", err.msg);
	camera_rig_free(&rig);
}

/* Eight neighbours: what takes COLMAP's defaults half an hour of all takes them a minute. */
static void small_set(const char *root, const char *images, const struct views_truth *truth)
{
	static const char *const names[] = { "00013.jpg", "00016.jpg", "00022.jpg", "00031.jpg", "00034.jpg", "00036.jpg", "00062.jpg",
		                                 "00063.jpg", 0 };
	struct camera_rig rig = { 0 };
	struct views_fit fit;
	struct err err = { 0 };
	struct spent s;
	double px;
	char *dir = mem_printf("%s/small", root), *views = mem_printf("%s/views", dir), *found = mem_printf("%s/work/rig.json", dir);
	char *defaults = mem_printf("%s/small-defaults", root);
	bool ok = views_capture(dir, images, names, 0, "quality = review\n", &err);
	if (ok && wanted("small")) {
		ok = views_calibrate(&s, dir, &err) && camera_rig_load(&rig, found, &err);
		if (ok)
			judge_cameras(&fit, &px, "calibrate", "review", s, &rig, COUNT(names) - 1, truth);
	}
	if (ok && wanted("defaults"))
		beside(defaults, views, COUNT(names) - 1, truth);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	camera_rig_free(&rig);
	free(dir);
	free(views);
	free(found);
	free(defaults);
}

/* One photograph taken away from the finished capture, all that is known of it forgotten; then added: what that costs against
 * beginning with all of them. */
static void one_more(const char *root, const char *images, struct spent whole)
{
	static const char last[] = "00034.jpg";
	static const char conf[] = "quality = review\n";
	char *dir = mem_printf("%s/review", root), *file = mem_printf("%s/views/%s", dir, last);
	struct err err = { 0 };
	struct spent s;
	if (file_remove(file, &err) && views_calibrate(&s, dir, &err) && views_capture(dir, images, (const char *const[]){ last, 0 }, 0, conf, &err)
	    && views_calibrate(&s, dir, &err)) {
		// On a machine that others use the one share may come out too well, or the other.
		double share = fmax(s.wall / whole.wall, s.cpu / whole.cpu);
		printf("one photograph more: %.1f %% of the time, %.1f %% of the processors' time\n", 100 * s.wall / whole.wall, 100 * s.cpu / whole.cpu);
		time_row("one photograph more", "review", s, "67 photographs", NAN);
		bench_goal("one photograph more, share of beginning anew", "<= 25 %", 100 * share, "%", share <= 0.25);
	} else
		fprintf(stderr, "%s\n", err.msg);
	free(dir);
	free(file);
}

static void quality_set(struct spent *s, const char *root, const char *images, const char *quality, const struct views_truth *truth,
                        const struct sweep_points *surface)
{
	char *dir = mem_printf("%s/%s", root, quality), *conf = mem_printf("quality = %s\n", quality);
	struct err err = { 0 };
	*s = (struct spent){ -1, 0 };
	if (!views_capture(dir, images, 0, 0, conf, &err) || !views_calibrate(s, dir, &err))
		fprintf(stderr, "%s\n", err.msg);
	judge(dir, quality, *s, truth, surface);
	free(dir);
	free(conf);
}

static void head_set(const char *data)
{
	const char *root = scratch_open();
	char *images = mem_printf("%s/images", data);
	struct views_truth truth = { 0 };
	struct sweep_points surface = { 0 };
	struct spent s;
	struct err err = { 0 };
	if (!views_truth_load(&truth, data, &err)
	    || (wanted("mesh") && (wanted("review") || wanted("final")) && !sweep(&surface, &truth, images, 6, 128, &err))) {
		fprintf(stderr, "%s\n", err.msg);
		scratch_close();
		free(images);
		return;
	}
	if (wanted("small") || wanted("defaults"))
		small_set(root, images, &truth);
	if (wanted("review")) {
		quality_set(&s, root, images, "review", &truth, &surface);
		bench_goal("head set, review", "<= 300 s", s.wall, "s", s.wall > 0 && s.wall <= 300);
		if (wanted("more") && s.wall > 0)
			one_more(root, images, s);
	}
	if (wanted("final"))
		quality_set(&s, root, images, "final", &truth, &surface);
	if (getenv("CALIBRATE_DEFAULTS"))
		beside(getenv("CALIBRATE_DEFAULTS"), images, truth.n, &truth);
	if (getenv("CALIBRATE_KEEP"))
		printf("all of it stands in %s\n", root);
	else
		scratch_close();
	free(images);
	sweep_free(&surface);
	views_truth_free(&truth);
}

/* Strecha et al. 2008: eleven photographs of a fountain, 15 m across, cameras from a laser scan; at half their resolution. */
static void fountain(const char *data)
{
	const char *root = scratch_open();
	char *images = mem_printf("%s/images", data), *cameras = mem_printf("%s/gt_dense_cameras", data);
	char *path = mem_printf("%s/work/rig.json", root);
	struct views_truth truth = { 0 };
	struct views_fit fit;
	struct camera_rig rig = { 0 };
	struct spent s;
	struct err err = { 0 };
	bool ok = views_truth_load_cameras(&truth, cameras, &err);
	free(path);
	path = mem_printf("%s/work/rig.json", root);
	ok = ok && views_capture(root, images, 0, 0, "quality = review\ncalibrate.picture_px = 1536\n", &err)
	     && views_calibrate(&s, root, &err) && camera_rig_load(&rig, path, &err) && views_fit(&fit, &truth, &rig);
	if (ok) {
		struct bench_time once = { s.wall, s.wall, s.wall };
		bench_row("fountain", "calibrate", "1536 px", once, "11 photographs", 1000 * fit.mean, "mm", "camera centres, mean");
		bench_goal("fountain, camera centres, mean", "<= 6 mm", 1000 * fit.mean, "mm", fit.mean <= 0.006);
		bench_goal("fountain, registered of 11", "all", fit.n, "", fit.n == truth.n);
	} else {
		fprintf(stderr, "%s\n", err.msg);
		bench_goal("fountain, camera centres, mean", "<= 6 mm", NAN, "mm", false);
	}
	scratch_close();
	camera_rig_free(&rig);
	views_truth_free(&truth);
	free(path);
	free(images);
	free(cameras);
}

static void load_model(void *ctx)
{
	struct colmap_model m;
	struct err err = { 0 };
	if (!colmap_load(&m, ctx, &err) || !colmap_check_errors(&m, ctx, &err))
		fprintf(stderr, "%s\n", err.msg);
	colmap_free(&m);
}

/* A model of 60 pictures and 2000 points that all of them see. */
static void reading(void)
{
	const char *root = scratch_open();
	struct colmap_model m;
	struct err err = { 0 };
	sfm_scene(&m, 60, 2000, 1);
	for (int format = 0; format < 2; format++) {
		char *dir = mem_printf("%s/%d", root, format);
		if (!colmap_save(&m, dir, (enum colmap_format)format, &err))
			fprintf(stderr, "%s\n", err.msg);
		struct bench_time t = bench_time(load_model, dir, bench_quick() ? 3 : 9);
		bench_row("COLMAP's files", "read and checked", format == COLMAP_TEXT ? "text" : "binary",
		          bench_time_each(t, 60.0 * 2000), "observation", NAN, "", "");
		free(dir);
	}
	colmap_free(&m);
	scratch_close();
}

int main(int argc, char **argv)
{
	bench_open("calibrate", argc, argv);
	const char *data = bench_data("views/buddha"), *scene = bench_data("views/fountain-P11");
	reading();
	if (bench_quick())
		printf("--quick: the head set takes minutes and is left out\n");
	else if (!run_exists("colmap"))
		printf("colmap is not installed: the head set is left out\n");
	else if (!data)
		printf("no photographs with known cameras: the head set is left out\n");
	else
		head_set(data);
	if (!scene)
		printf("no views/fountain-P11 among the data (github.com/openMVG/SfM_quality_evaluation): left out\n");
	else if (!bench_quick() && run_exists("colmap") && wanted("fountain"))
		fountain(scene);
	return bench_close();
}
