/* Fronts of the photograph column: its stages' knobs on the bundled photograph, time and error of the same run. Errors are
 * lengths: how far the limbus and the margins of freckles are off the truth; how far a point of the iris texture may be off, by its shift
 * against the finest setting and by half a texel; how far K is off; how far the detail of a Monte Carlo iris's thickness is off the truth, where the
 * shared data are there; that of the bundled photograph, whose truth nobody knows, off the finest setting's.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/exr.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/bench/fronts.h"
#include "tests/lib/scratch.h"
#include "tests/lib/score/mc_iris.h"
#include "tests/lib/truth/iris.h"

enum { LIMIT_PX = 1 << 26 };
static const char *const rgb[] = { "R", "G", "B" }, *const y[] = { "Y" };

static bool read_map(struct image *map, double *extent, const char *dir, const char *file, int n, const char *const channels[])
{
	struct exr_info info = { 0 };
	struct err err = { 0 };
	char *path = mem_printf("%s/iris/%s", dir, file);
	bool ok = exr_read(map, path, n, channels, LIMIT_PX, &info, &err);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	*extent = info.extent_mm;
	free(path);
	return ok;
}

/* The value of `map` at a texel of another map of the same iris. */
static double at(const struct image *map, double extent, const struct image *as, double as_extent, int i, int j, int c)
{
	double x = as_extent * (2 * (i + 0.5) / as->width - 1), z = as_extent * (2 * (j + 0.5) / as->height - 1);
	return (double)image_sample(map, 0.5 * (x / extent + 1) * map->width, 0.5 * (z / extent + 1) * map->height, c);
}

static struct mc_iris iris;  // where the shared data are there

/* How far the limbus is off the truth, mean over its points, mm. */
static double limbus_off(const char *capture, const char *reference)
{
	(void)reference;
	struct truth truth;
	struct err err = { 0 };
	char *path = mem_printf("%s/work/limbus/right_softbox.json", capture);
	json_t *fit = json_read(path, 1 << 20, &err), *of = json_object_get(fit, "ellipse");
	struct ellipse e = { 0 };
	double sum = NAN;
	if (fit && truth_load(&truth, "samples/demo/truth", &err) && json_get(&e.cx, of, "cx", path, &err) && json_get(&e.cy, of, "cy", path, &err)
	    && json_get(&e.a, of, "a", path, &err) && json_get(&e.b, of, "b", path, &err) && json_get(&e.angle, of, "angle_deg", path, &err)) {
		enum { POINTS = 180 };
		e.angle *= M_PI / 180;
		sum = 0;
		for (int i = 0; i < POINTS; i++) {
			double p[2], normal[2], t;
			ellipse_point(p, normal, &e, 2 * M_PI * i / POINTS);
			sum += fabs(ellipse_distance(&t, &truth.limbus, p)) / POINTS;
		}
		sum *= truth.eye.limbus_radius / truth.limbus.a;
	} else {
		fprintf(stderr, "%s: %s\n", path, err.msg);
	}
	json_decref(fit);
	free(path);
	return sum;
}

/* How far margins of freckles are off the painted ones, mm: the area on which they differ over the painted ones' circumference, and half a
 * texel. */
static double freckles_off(const char *capture, const char *reference)
{
	static const char *const opacity[] = { "Y" };
	(void)reference;
	struct image found = { 0 };
	struct truth truth;
	struct err err = { 0 };
	double extent, off = NAN, differ = 0, around = 0;
	char *work = mem_printf("%s/work", capture);
	if (read_map(&found, &extent, work, "freckles.exr", 1, opacity) && truth_load(&truth, "samples/demo/truth", &err)) {
		const int n = found.width;
		uint8_t *painted = iris_freckle_mask(&truth, "samples/demo/truth", n, extent, true);
		for (long i = 0; painted && i < (long)n * (n - 1) - 1; i++) {
			differ += (found.px[i] >= 0.5f) != painted[i];
			around += (painted[i] != painted[i + 1]) + (painted[i] != painted[i + n]);
		}
		off = around > 0 ? hypot(2 * extent / n * differ / (M_PI_4 * around), extent / n) : NAN;
		free(painted);
	}
	image_free(&found);
	free(work);
	return off;
}

static double mc_off(const char *capture, const char *file, const char *channel)
{
	char *path = mem_printf("%s/work/iris/%s", capture, file);
	const double off = mc_iris_detail_off(&iris, path, channel);
	free(path);
	return off;
}

static double thickness_of_truth(const char *capture, const char *reference)
{
	(void)reference;
	return mc_off(capture, "thickness.exr", "Y");
}

static double relief_of_truth(const char *capture, const char *reference)
{
	(void)reference;
	return mc_off(capture, "relief.exr", "T");
}

/* How far a point of the texture may be off, mm: the shift that would explain its difference from the finest one (rms difference over rms
 * gradient), and half a texel, between which nothing is known. */
static double point_of_texture(const char *capture, const char *reference)
{
	struct image a = { 0 }, b = { 0 };
	double ea = NAN, eb, difference = 0, gradient = 0;
	char *work = mem_printf("%s/work", capture);
	if (read_map(&a, &ea, work, "texture.exr", 3, rgb) && read_map(&b, &eb, reference, "texture.exr", 3, rgb)) {
		double step = 2 * eb / b.width;
		for (int j = 0; j + 1 < b.height; j++)
			for (int i = 0; i + 1 < b.width; i++) {
				double here = (double)image_at(&b, i, j)[1], d = at(&a, ea, &b, eb, i, j, 1) - here;
				double gx = (double)image_at(&b, i + 1, j)[1] - here, gy = (double)image_at(&b, i, j + 1)[1] - here;
				if (isfinite(d + gx + gy)) {
					difference += d * d;
					gradient += (gx * gx + gy * gy) / (step * step);
				}
			}
	}
	const double half_texel = ea / a.width;
	image_free(&a);
	image_free(&b);
	free(work);
	return hypot(sqrt(difference / gradient), half_texel);
}

/* rms difference from the finest setting's thickness, mm. */
static double thickness_off(const char *capture, const char *reference)
{
	struct image a = { 0 }, b = { 0 };
	double ea, eb, sum = 0;
	long n = 0;
	char *work = mem_printf("%s/work", capture);
	if (read_map(&a, &ea, work, "relief.exr", 1, y) && read_map(&b, &eb, reference, "relief.exr", 1, y))
		for (int j = 0; j < b.height; j++)
			for (int i = 0; i < b.width; i++) {
				double d = at(&a, ea, &b, eb, i, j, 0) - (double)image_at(&b, i, j)[0];
				if (isfinite(d)) {
					sum += d * d;
					n++;
				}
			}
	image_free(&a);
	image_free(&b);
	free(work);
	return n ? sqrt(sum / (double)n) : NAN;
}

/* K's worst error as the stage measured it, mm. */
static double k_off(const char *capture, const char *reference)
{
	(void)reference;
	struct err err = { 0 };
	char *path = mem_printf("%s/work/log/refraction.json", capture);
	json_t *log = json_read(path, 1 << 20, &err);
	json_t *value = json_object_get(json_object_get(json_object_get(log, "figures"), "refraction_error_worst"), "value");
	double off = value ? json_number_value(value) : NAN;
	json_decref(log);
	free(path);
	return off;
}

/* Of a Monte Carlo iris: 800 px wide, its iris 400. */
#define MC_MTEXEL (464 * 464 * 1e-6)
static const struct fronts_stage mc_stages[] = {
	{ .stage = "heightfield", .keys = "reach_mm", .more = { { "near", "0.01" } },
	  .mtexel = MC_MTEXEL, .unit = "mm", .error_of = "thickness off the truth, 0.12 to 0.6 mm, rms", .error = thickness_of_truth, .reps = 3 },
	{ .stage = "relief", .keys = "filter", .more = { { "none", "no" } },
	  .mtexel = MC_MTEXEL, .unit = "mm", .error_of = "thickness off the truth, 0.12 to 0.6 mm, rms", .error = relief_of_truth, .reps = 3 },
};

static const struct fronts_stage stages[] = {
	{ .stage = "limbus", .keys = "candidates, passes, measured_px",
	  .more = { { "three_passes", "8, 3, 900" }, { "large", "12, 12, 2500" } },  // fewer candidates save little, and find fewer eyes
	  .unit = "mm", .error_of = "limbus off the truth, mean", .error = limbus_off, .reps = 3 },
	{ .stage = "unrefract", .keys = "scale, max_size, survey_size", .finest = { "finest", "2, 4096, 1024" },
	  .more = { { "quarter", "0.25, 512, 320" }, { "third", "0.35, 512, 320" }, { "two_thirds", "0.7, 1536, 512" },
		    { "quick_survey", "1, 1536, 320" }, { "finer", "1.4, 2048, 512" } },
	  .unit = "mm", .error_of = "a point of the texture, by its shift and half a texel", .error = point_of_texture, .reps = 3 },
	{ .stage = "freckles", .keys = "max_size, candidates",
	  .more = { { "half", "600, 24" }, { "few_places", "1600, 8" } },  // texels no larger than the smallest freckle
	  .mtexel = 0.861, .unit = "mm", .error_of = "margins of freckles off the painted ones", .error = freckles_off, .reps = 3 },
	{ .stage = "refraction", .keys = "method, error_mm",
	  .more = { { "newton", "newton, 0.001" }, { "newton_fine", "newton, 0.0001" }, { "auto_coarse", "auto, 0.01" },
		    { "auto_fine", "auto, 0.0001" }, { "table", "table_linear, 0.001" }, },
	  .unit = "mm", .error_of = "K, worst", .error = k_off, .reps = 3 },
	{ .stage = "pigment", .keys = "bands, starts", .finest = { "finest", "8, 12" }, .after = "relief",
	  .more = { { "few_bands", "3, 4" }, { "fewest", "3, 1" } },
	  .unit = "mm", .error_of = "thickness of the relief, rms, against the finest", .error = thickness_off, .reps = 1 },
};

/* The photograph at a half of its width and height, and its focal length. */
static bool halve(const char *dir, const char *photo, struct err *err)
{
	uint8_t *px = 0, *jpeg = 0;
	int w, h;
	size_t size;
	bool ok = picture_read(&px, &w, &h, photo, 100, err);
	uint8_t *half = ok ? cv_resize8(px, w, h, 3, w / 2, h / 2) : 0;
	ok = ok && picture_jpeg_encode(&jpeg, &size, half, w / 2, h / 2, 3, 95, err) && file_write(photo, jpeg, size, err);
	char *conf = mem_printf("%s/capture.conf", dir);
	const char text[] = "camera.focal_px = 5913.045\nlight.illuminant = D65\n";
	ok = ok && file_write(conf, text, strlen(text), err);
	free(conf);
	free(half);
	free(jpeg);
	free(px);
	return ok;
}

/* The bundled capture, made as far as the stages here need it. */
static char *make_capture(const char *name, bool small)
{
	struct err err = { 0 };
	char *dir = mem_str(scratch_path("%s", name)), *photo = mem_printf("%s/photos/right_softbox.jpg", dir);
	char *command = mem_printf("mkdir -p '%s/photos' && cp samples/demo/capture.conf '%s' && cp samples/demo/photos/right_softbox.jpg '%s'", dir, dir, photo);
	bool ok = !system(command) && (!small || halve(dir, photo, &err));
	free(photo);
	free(command);
	if (!ok || !fronts_make(dir, "relief") || !fronts_make(dir, "refraction")) {
		fprintf(stderr, "%s\n", err.msg);
		free(dir);
		return 0;
	}
	return dir;
}

int main(int argc, char **argv)
{
	static const double mpx[2] = { 1.92, 0.48 };
	struct err err = { 0 };
	bench_open("fronts", argc, argv);
	if (fronts_left_out())
		return bench_close();
	scratch_open();
	char *big = make_capture("big", false), *small = make_capture("small", true);
	for (int i = 0; big && small && i < COUNT(stages); i++)
		fronts_measure(&stages[i], big, small, mpx);
	const char *data = bench_data("iris_mc/hazel");
	if (!data) {
		printf("iris_mc/hazel is not there: heightfield and relief are left out\n");
	} else {
		char *dir = mem_str(scratch_path("mc"));
		if (mc_iris_load(&iris, data, &err) && mc_iris_capture(&iris, dir, &(struct mc_case){ .told = true, .more = "photo.right_hazel.hint_px = 400 300 200" }, &err) && fronts_make(dir, "relief"))
			for (int i = 0; i < COUNT(mc_stages); i++)
				fronts_measure(&mc_stages[i], dir, 0, (const double[2]){ 0.48, 0 });
		if (err_is(&err))
			fprintf(stderr, "%s\n", err.msg);
		err = (struct err){ 0 };
		mc_iris_free(&iris);
		free(dir);
	}
	if (!fronts_write(bench_out(), "fronts", &err))
		fprintf(stderr, "%s\n", err.msg);
	scratch_close();
	free(big);
	free(small);
	return bench_close();
}
