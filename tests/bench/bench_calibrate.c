/* Cameras and mesh of a head from 67 photographs with known projection matrices, as a user runs it: time, error of the
 * camera centres, reprojection error, distance of the mesh from a surface measured with the known cameras; and what one
 * more photograph costs. Takes minutes: --quick measures the reading of COLMAP's files alone. CALIBRATE_DEFAULTS=1 runs
 * COLMAP's own defaults beside it (half an hour). Run from the top of the checkout.
 */
#include <ftw.h>
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
#include "base/run.h"
#include "bridge/om_mesh.h"
#include "math/stats.h"
#include "math/vec.h"
#include "optics/colmap.h"
#include "tests/lib/bench.h"
#include "tests/lib/sfm_scene.h"
#include "tests/lib/sweep.h"
#include "tests/lib/views_truth.h"

enum { MESH_LIMIT = 20000000 };

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)kind;
	(void)ftw;
	return remove(path);
}

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double children_s(void)
{
	struct rusage use;
	getrusage(RUSAGE_CHILDREN, &use);
	return (double)use.ru_utime.tv_sec + 1e-6 * (double)use.ru_utime.tv_usec;
}

struct spent {
	double wall, user;  // s; wall negative: it failed
};

static struct spent run(const char *program, const char *const args[], const char *log)
{
	double start = now_s(), user = children_s();
	const char *argv[40] = { program };
	for (int i = 0; args[i]; i++)
		argv[i + 1] = args[i];
	struct err err = { 0 };
	bool ok = run_program(&(struct run){ .argv = argv, .log = log }, &err);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	return (struct spent){ ok ? now_s() - start : -1, children_s() - user };
}

static struct spent calibrate(const char *dir)
{
	char *capture = mem_printf("--capture=%s", dir), *log = mem_printf("%s.log", dir);
	const char *const args[] = { capture, 0 };
	struct spent s = run("bin/calibrate", args, log);
	free(capture);
	free(log);
	return s;
}

static void copy(const char *from, const char *dir, const char *name)
{
	char *data, *source = mem_printf("%s/%s", from, name), *to = mem_printf("%s/%s", dir, name);
	size_t size;
	struct err err = { 0 };
	if (!file_read(&data, &size, source, 1 << 28, &err) || !file_write(to, data, size, &err))
		fprintf(stderr, "%s\n", err.msg);
	free(data);
	free(source);
	free(to);
}

/* A capture of those photographs; quality: and further lines of its capture.conf; leave_out: one that is missing, or null. */
static char *make_capture(const char *root, const char *images, const char *quality, const char *leave_out)
{
	struct file_list list;
	struct err err = { 0 };
	char *dir = mem_printf("%s/%.*s%s", root, (int)strcspn(quality, "\n"), quality, leave_out ? "-less" : ""), *views = mem_printf("%s/views", dir);
	char *conf = mem_printf("%s/capture.conf", dir), *text = mem_printf("quality = %s\n", quality);
	file_list(&list, images, &err);
	for (int i = 0; i < list.n; i++)
		if (!leave_out || strcmp(list.names[i], leave_out))
			copy(images, views, list.names[i]);
	if (!file_write(conf, text, strlen(text), &err))
		fprintf(stderr, "%s\n", err.msg);
	file_list_free(&list);
	free(views);
	free(conf);
	free(text);
	return dir;
}

static void time_row(const char *method, const char *setting, struct spent s, double error, const char *unit, const char *what)
{
	struct bench_time once = { s.wall, s.wall, s.wall };
	bench_row("calibrate", method, setting, once, "67 photographs", error, unit, what);
	printf("%-24s %-10s %.1f s wall, %.1f s of processors\n", method, setting, s.wall, s.user);
}

static double residual_of(const struct camera_rig *rig)
{
	double sum = 0, n = 0;
	for (int i = 0; i < rig->n; i++) {
		sum += rig->cameras[i].residual_px * rig->cameras[i].points;
		n += rig->cameras[i].points;
	}
	return sum / n;
}

/* Share of the mesh within 1 % of the head's height of the surface, of those parts the surface covers at all. */
static double mesh_within(const char *path, const struct views_fit *fit, const struct sweep_points *surface, double *middle)
{
	struct mesh mesh;
	struct err err = { 0 };
	if (!om_mesh_load(&mesh, path, MESH_LIMIT, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return NAN;
	}
	// The head is 1.25 radii of its ball tall, as the ball was chosen; 1 % of that.
	double size = 2 * surface->radius / 1.25, reach = 0.03 * size;
	struct sweep_index *index = sweep_index_new(surface, reach);
	double *d = mem_array((size_t)mesh.n_vertices, sizeof *d);
	int n = 0, near = 0;
	for (int i = 0; i < mesh.n_vertices; i++) {
		double p[3], head[3] = { (double)mesh.vertices[i][0], (double)mesh.vertices[i][1], (double)mesh.vertices[i][2] };
		views_to_truth(p, fit, head);
		double off = sweep_distance(index, p);
		if (!isfinite(off))
			continue;
		near += off <= 0.01 * size;
		d[n++] = off / size;
	}
	printf("mesh: %d vertices, %d beside the measured surface\n", mesh.n_vertices, n);
	double share = (double)near / n;
	*middle = stats_quantile(n, d, 0.5);
	free(d);
	sweep_index_free(index);
	mesh_free(&mesh);
	return share;
}

static void judge(const char *dir, const char *quality, struct spent s, const struct views_truth *truth,
                  const struct sweep_points *surface)
{
	struct camera_rig rig;
	struct views_fit fit;
	struct err err = { 0 };
	char *path = mem_printf("%s/work/rig.json", dir), *subject = mem_printf("%s/work/subject.ply", dir);
	double bar = strcmp(quality, "final") ? 0.1 : 0.05, middle = NAN;
	if (!camera_rig_load(&rig, path, &err) || !views_fit(&fit, truth, &rig))
		fprintf(stderr, "%s\n", err.msg);
	else {
		double percent = 100 * fit.mean / truth->extent, px = residual_of(&rig);
		char *reach = mem_printf("<= %g %%", bar), *name = mem_printf("camera centres, %s, mean of the orbit's extent", quality);
		time_row("calibrate", quality, s, percent, "%", "camera centres, mean");
		printf("%s: centres %.4f %% mean, %.4f %% worst, %.3f px, %d of %d\n", quality, percent, 100 * fit.worst / truth->extent,
		       px, fit.n, truth->n);
		bench_goal(name, reach, percent, "%", percent <= bar);
		bench_goal("registered of 67", "all", fit.n, "", fit.n == truth->n);
		bench_goal("reprojection error, mean", "<= 0.7 px", px, "px", px <= 0.7);
		if (surface->n) {
			double share = 100 * mesh_within(subject, &fit, surface, &middle);
			printf("mesh: %.1f %% within 1 %%, middle distance %.3f %%\n", share, 100 * middle);
			bench_row("subject mesh", "calibrate", quality, (struct bench_time){ NAN, NAN, NAN }, "mesh", 100 * middle, "%",
			          "distance from the surface, median, of the head's size");
			bench_goal("mesh within 1 % of the head's size", ">= 90 %", share, "%", share >= 90);
		}
		free(reach);
		free(name);
		camera_rig_free(&rig);
	}
	free(path);
	free(subject);
}

/* Extraction, exhaustive matching and mapping as a user of COLMAP alone would have them. */
static void defaults(const char *root, const char *images, const struct views_truth *truth)
{
	char *db = mem_printf("%s/defaults.db", root), *models = mem_printf("%s/defaults", root), *log = mem_printf("%s/defaults.log", root);
	char *first = mem_printf("%s/0", models);
	struct err err = { 0 };
	setenv("QT_QPA_PLATFORM", "offscreen", 1);
	file_mkdirs(models, &err);
	const char *const steps[][14] = {
		{ "feature_extractor", "--database_path", db, "--image_path", images, "--ImageReader.single_camera", "1",
		  "--SiftExtraction.use_gpu", "0", 0 },
		{ "exhaustive_matcher", "--database_path", db, "--SiftMatching.use_gpu", "0", 0 },
		{ "mapper", "--database_path", db, "--image_path", images, "--output_path", models, 0 },
	};
	struct spent sum = { 0 };
	for (int i = 0; i < COUNT(steps) && sum.wall >= 0; i++) {
		struct spent s = run("colmap", steps[i], log);
		sum = (struct spent){ s.wall < 0 ? -1 : sum.wall + s.wall, sum.user + s.user };
	}
	struct colmap_model m;
	if (sum.wall > 0 && colmap_load(&m, first, &err)) {
		struct camera_rig rig = { .cameras = mem_new((size_t)m.n_images, sizeof(struct rig_camera)), .n = m.n_images };
		for (int i = 0; i < m.n_images; i++) {
			double R[3][3];
			struct rig_camera *c = &rig.cameras[i];
			*c = (struct rig_camera){ .name = mem_printf("%.*s", (int)strcspn(m.images[i].name, "."), m.images[i].name),
				                      .file = mem_str(""), .has_pose = true };
			colmap_rotation(R, m.images[i].q);
			for (int r = 0; r < 3; r++) {
				for (int k = 0; k < 3; k++)
					c->cam_from_head[r][k] = R[r][k];
				c->cam_from_head[r][3] = m.images[i].t[r];
			}
		}
		struct views_fit fit;
		if (views_fit(&fit, truth, &rig))
			time_row("COLMAP's own defaults", "exhaustive", sum, 100 * fit.mean / truth->extent, "%", "camera centres, mean");
		camera_rig_free(&rig);
		colmap_free(&m);
	}
	free(db);
	free(models);
	free(first);
	free(log);
}

/* 66 photographs, then the last: what that costs against beginning with all of them. */
static void one_more(const char *root, const char *images, double whole)
{
	const char *last = "00034.jpg";
	char *dir = make_capture(root, images, "review", last), *views = mem_printf("%s/views", dir);
	if (calibrate(dir).wall > 0) {
		copy(images, views, last);
		struct spent s = calibrate(dir);
		time_row("one photograph more", "review", s, NAN, "", "");
		bench_goal("one photograph more, share of beginning anew", "<= 25 %", 100 * s.wall / whole, "%", s.wall > 0 && s.wall <= 0.25 * whole);
	}
	free(dir);
	free(views);
}

static void head_set(const char *data)
{
	char root[] = "/tmp/eyewright-bench-XXXXXX", *images = mem_printf("%s/images", data);
	struct views_truth truth;
	struct sweep_points surface = { 0 };
	struct err err = { 0 };
	if (!mkdtemp(root) || !views_truth_load(&truth, data, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return;
	}
	char *review = make_capture(root, images, "review", 0), *final = make_capture(root, images, "final", 0);
	struct spent s = calibrate(review);
	if (!sweep(&surface, &truth, images, 6, 128, &err))
		fprintf(stderr, "%s\n", err.msg);
	bench_goal("head set, review", "<= 300 s", s.wall, "s", s.wall > 0 && s.wall <= 300);
	judge(review, "review", s, &truth, &surface);
	one_more(root, images, s.wall);
	judge(final, "final", calibrate(final), &truth, &surface);
	if (getenv("CALIBRATE_DEFAULTS"))
		defaults(root, images, &truth);
	if (!getenv("CALIBRATE_KEEP"))
		nftw(root, remove_one, 16, FTW_DEPTH | FTW_PHYS);
	free(review);
	free(final);
	free(images);
	sweep_free(&surface);
	views_truth_free(&truth);
}

/* Strecha et al. 2008: eleven photographs of a fountain, 15 m across, cameras from a laser scan; at half their resolution. */
static void fountain(const char *data)
{
	char root[] = "/tmp/eyewright-bench-XXXXXX", *images = mem_printf("%s/images", data), *cameras = mem_printf("%s/gt_dense_cameras", data);
	struct views_truth truth;
	struct views_fit fit;
	struct camera_rig rig = { 0 };
	struct err err = { 0 };
	if (!mkdtemp(root) || !views_truth_load_cameras(&truth, cameras, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return;
	}
	char *dir = make_capture(root, images, "review\ncalibrate.picture_px = 1536", 0), *path = mem_printf("%s/work/rig.json", dir);
	struct spent s = calibrate(dir);
	if (s.wall > 0 && camera_rig_load(&rig, path, &err) && views_fit(&fit, &truth, &rig)) {
		struct bench_time once = { s.wall, s.wall, s.wall };
		bench_row("fountain", "calibrate", "1536 px", once, "11 photographs", 1000 * fit.mean, "mm", "camera centres, mean");
		bench_goal("fountain, camera centres, mean", "<= 6 mm", 1000 * fit.mean, "mm", fit.mean <= 0.006);
		bench_goal("fountain, registered of 11", "all", fit.n, "", fit.n == truth.n);
	} else
		fprintf(stderr, "%s\n", err.msg);
	nftw(root, remove_one, 16, FTW_DEPTH | FTW_PHYS);
	camera_rig_free(&rig);
	views_truth_free(&truth);
	free(dir);
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
	char root[] = "/tmp/eyewright-bench-XXXXXX";
	struct colmap_model m;
	struct err err = { 0 };
	if (!mkdtemp(root))
		return;
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
	nftw(root, remove_one, 16, FTW_DEPTH | FTW_PHYS);
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
	else if (!bench_quick() && run_exists("colmap"))
		fountain(scene);
	return bench_close();
}
