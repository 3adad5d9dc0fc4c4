/* unrefract: maps of the iris plane against an independent ray tracer's, the inverse against the forward map, masks and
 * merging against labelled renderings. */
#include <omp.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "iris/iris_map.h"
#include "iris/unrefract/unrefract.h"
#include "image/exr.h"
#include "image/plane.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/iris.h"
#include "tests/lib/unit.h"

enum { CAPTURES = 32 };

static struct unrefract_conf plain;  // as configured, at most 768 texels a side

static struct truth eye_at(double theta_deg, bool two_surface)
{
	double t = theta_deg * M_PI / 180;
	struct truth truth = { .eye = { 7.8, 0.75, 1.336, 5.85, 1, 3.3, two_surface, 6.5, 0.75, 0.55, 1.376 },
		               .focal_px = 8000, .center_px = { 800, 600 } };
	double pose[4][4] = { { cos(t), 0, sin(t), 0.4 }, { 0, 1, 0, -0.3 }, { -sin(t), 0, cos(t), 110 }, { 0, 0, 0, 1 } };
	for (int i = 0; i < 16; i++)
		truth.cam_from_eye[i / 4][i % 4] = pose[i / 4][i % 4];
	return truth;
}

/* Without refraction (index 1) the pixel is the plain projection. */
static void flat_limit(void **state)
{
	(void)state;
	struct truth truth = eye_at(30, false);
	truth.eye.index = 1;
	struct fit fit = truth_fit(&truth);
	struct iris_view view = iris_view_new(&fit, &truth.eye);
	double P[2] = { 2.5, -1.5 }, px[2], straight[2], at[3] = { P[0], P[1], truth.eye.iris_depth };
	assert_true(iris_find(px, 0, &view, P));
	assert_true(fit_project(straight, &fit, at));
	assert_float_equal(px[0], straight[0], 1e-6);
	assert_float_equal(px[1], straight[1], 1e-6);
}

/* On the axis of a frontal eye nothing bends; and magnification near it is that of paraxial optics: an object s
 * behind a surface of power (n - 1) / R appears n / (n - s (n - 1) / R) times as large. */
static void paraxial(void **state)
{
	(void)state;
	struct truth truth = eye_at(0, false);
	truth.cam_from_eye[0][3] = truth.cam_from_eye[1][3] = 0;
	truth.cam_from_eye[2][3] = 1e5;
	truth.focal_px = 1e7;
	struct fit fit = truth_fit(&truth);
	struct iris_view view = iris_view_new(&fit, &truth.eye);
	double small[2] = { 0.01, 0 }, px[2], zero[2] = { 0, 0 };
	assert_true(iris_find(px, 0, &view, zero));
	assert_float_equal(px[0], 800, 1e-9);
	assert_true(iris_find(px, 0, &view, small));
	double n = 1.336, s = 3.3, seen = (px[0] - 800) / 1e7 * 1e5 / small[0];
	// 1e-4: third-order terms at 0.01 mm, and the camera at 100 m
	assert_float_equal(seen, n / (n - s * (n - 1) / 7.8), 1e-4);
}

/* There and back through the whole map, one and two surfaces, 0 to 50 degrees. */
static void round_trip(void **state)
{
	(void)state;
	for (int k = 0; k < 12; k++) {
		struct truth truth = eye_at(10 * (k / 2), k % 2);
		struct fit fit = truth_fit(&truth);
		struct iris_view view = iris_view_new(&fit, &truth.eye);
		int seen = 0;
		for (int i = 0; i < 400; i++) {
			double r = 5.5 * sqrt((i + 0.5) / 400), a = 2.4 * i, P[2] = { r * cos(a), r * sin(a) }, px[2], back[2], rim;
			if (!iris_find(px, &rim, &view, P) || rim > truth.eye.limbus_radius)
				continue;
			seen++;
			assert_true(iris_see(back, 0, &view, px));
			// the two-surface search stops at 1e-6 mm, the single-surface solver at 1e-13
			assert_true(hypot(back[0] - P[0], back[1] - P[1]) < 2e-6);
		}
		assert_true(seen > 340);  // the far side leaves beyond the limbus
	}
}

static double map_difference(const struct iris_map *a, const struct iris_map *b, double limbus)
{
	double worst = 0;
	for (long i = 0; i < (long)a->size * a->size; i++)
		if (b->rim[i] < limbus && isfinite(b->u[i])) {
			assert_true(isfinite(a->u[i]));
			worst = fmax(worst, hypot(a->u[i] - b->u[i], a->v[i] - b->v[i]));
		}
	return worst;
}

static void lattice_is_exact(void **state)
{
	(void)state;
	for (int k = 0; k < 4; k++) {
		struct truth truth = eye_at(15 * k, k == 2);
		struct fit fit = truth_fit(&truth);
		struct iris_view view = iris_view_new(&fit, &truth.eye);
		struct iris_map_conf conf = plain.map;
		struct iris_map quick = iris_map_new(&view, 300, 6, 5.85, &(struct iris_map_conf){ .node = 5 });
		conf.method = IRIS_NEWTON;
		struct iris_map exact = iris_map_new(&view, 300, 6, 5.85, &conf);
		// a twentieth of a pixel: what bicubic sampling itself is good to
		assert_true(map_difference(&quick, &exact, truth.eye.limbus_radius) < 0.05);
		iris_map_free(&quick);
		iris_map_free(&exact);
	}
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Every second pixel's point against the renderer's own; inside 0.9 of the iris. */
static void against_renderer(void **state)
{
	(void)state;
	static const char *const channels[] = { "R", "G", "A" };
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES), checked = 0;
	for (int i = 0; i < n; i++) {
		struct err err = { 0 };
		struct truth truth;
		struct image map = { 0 };
		char *path = mem_printf("%s/map.exr", dirs[i]);
		assert_true(truth_load(&truth, dirs[i], &err));
		if (exr_read(&map, path, 3, channels, 1L << 24, 0, &err)) {
			struct fit fit = truth_fit(&truth);
			struct iris_view view = iris_view_new(&fit, &truth.eye);
			double *error = mem_array((size_t)map.width * (size_t)map.height, sizeof *error);
			long count = 0;
			for (int y = 0; y < map.height; y++)
				for (int x = 0; x < map.width; x++) {
					const float *t = image_at(&map, x, y);
					double at[2] = { t[0], t[1] }, here[2], px[2] = { 2 * x + 0.5, 2 * y + 0.5 };
					if (t[2] != 1 || hypot(at[0], at[1]) > 0.9 * truth.iris_radius)
						continue;
					assert_true(iris_see(here, 0, &view, px));
					truth_turn(at, &truth, at);
					error[count++] = hypot(at[0] - here[0], at[1] - here[1]);
				}
			assert_true(count > 10000);
			qsort(error, (size_t)count, sizeof *error, by_value);
			print_message("%s: median %.4f mm, 95 %% %.4f mm\n", truth.name, error[count / 2], error[count * 95 / 100]);
			assert_true(error[count / 2] < 0.03);
			assert_true(error[count * 95 / 100] < 0.1);
			free(error);
			image_free(&map);
			checked++;
		}
		free(path);
		free(dirs[i]);
	}
	if (!checked) {
		print_message("no rendered captures here: skipped\n");
		skip();
	}
}

static struct unrefract_texture texture_of(const struct truth *truth, struct fit *fit, struct unrefract_view *view)
{
	struct unrefract_texture texture;
	struct err err = { 0 };
	assert_true(iris_texture(&texture, view, fit, truth, &plain, &err));
	return texture;
}

struct label_count {
	long kept, wrong, iris, missed;
};

/* Weights against the renderer's labels: 4 is iris; the margins of pupil and limbus left out. */
static struct label_count count_labels(const struct unrefract_texture *texture, const struct unrefract_view *view,
                                       const struct truth *truth, const uint8_t *labels, int width, int height)
{
	struct label_count n = { 0 };
	int size = texture->rgbw.width;
	double mm = 2 * texture->extent / size;
	for (int row = 0; row < size; row += 2)
		for (int col = 0; col < size; col += 2) {
			double P[2] = { (col + 0.5) * mm - texture->extent, (row + 0.5) * mm - texture->extent }, px[2];
			if (hypot(P[0], P[1]) > 0.9 * truth->iris_radius || hypot(P[0], P[1]) < truth->pupil_radius + 0.3
			    || !iris_find(px, 0, &view->iris, P) || px[0] < 0 || px[1] < 0 || px[0] >= width || px[1] >= height)
				continue;
			bool iris = labels[3 * ((long)px[1] * width + (long)px[0])] == 4;
			bool kept = image_at(&texture->rgbw, col, row)[3] > 0.1f;
			n.kept += kept, n.wrong += kept && !iris;
			n.iris += iris, n.missed += iris && !kept;
		}
	return n;
}

static void masks_against_labels(void **state)
{
	(void)state;
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES);
	for (int i = 0; i < n; i += SANITISED ? 3 : 1) {
		struct err err = { 0 };
		struct truth truth;
		struct fit fit;
		struct unrefract_view view;
		uint8_t *labels = 0;
		int width, height;
		char *path = mem_printf("%s/labels.png", dirs[i]);
		assert_true(truth_load(&truth, dirs[i], &err));
		if (picture_read(&labels, &width, &height, path, 10, &err)) {
			struct unrefract_texture texture = texture_of(&truth, &fit, &view);
			struct label_count c = count_labels(&texture, &view, &truth, labels, width, height);
			print_message("%s: %.3f %% of what is kept is no iris, %.1f %% of the iris is missed\n", truth.name,
			              100. * (double)c.wrong / (double)c.kept, 100. * (double)c.missed / (double)c.iris);
			// a lash is a few texels wide, so that a few in a thousand are left; reflections and the dark under a lid are
			// iris by label and yet not to be used
			assert_true((double)c.wrong < 0.005 * (double)c.kept);
			// and a checkerboard's black squares at the limbus are none that an iris has
			double may_miss = truth.covered > 0 ? 0.4 : truth.name[0] == 'C' ? 0.05 : 0.01;
			assert_true((double)c.missed < may_miss * (double)c.iris);
			// where a circle of the true size lies, in the plane
			assert_float_equal(texture.pupil.r, truth.pupil_radius, 0.05);
			image_free(&texture.rgbw);
			unrefract_view_free(&view);
			free(labels);
		}
		free(path);
	}
	for (int i = 0; i < n; i++)
		free(dirs[i]);
	if (!n) {
		print_message("no rendered captures here: skipped\n");
		skip();
	}
}

/* Where lids were found to take a good part of the light: the median by which the logarithm of its green is off the painted iris, over what it is off where
 * they take none. *n: such texels. */
static double shaded_bias(int *n, const struct unrefract_texture *texture, const struct unrefract_view *view, const struct truth *truth, const struct image *painted,
                          double extent, bool given_back)
{
	const struct unrefract_survey *s = &view->survey;
	const long all = (long)painted->width * painted->height;
	double *in = mem_array((size_t)all, sizeof *in), *out = mem_array((size_t)all, sizeof *out);
	int n_in = 0, n_out = 0;
	for (long i = 0; i < all && s->shade; i++) {
		const double to = 2 * extent / painted->width, at[2] = { ((double)(i % painted->width) + 0.5) * to - extent, ((double)(i / painted->width) + 0.5) * to - extent };
		double p[2];
		truth_turn(p, truth, at);
		const double u = (p[0] + texture->extent) / (2 * texture->extent) * texture->rgbw.width, v = (p[1] + texture->extent) / (2 * texture->extent) * texture->rgbw.width;
		if (!(painted->px[4 * i + 3] > 0.9F) || u < 0 || v < 0 || u >= texture->rgbw.width || v >= texture->rgbw.width)
			continue;
		const float *px = image_at(&texture->rgbw, (int)u, (int)v);
		const double k = s->size / (2 * s->extent);
		const double shade = (double)plane_sample(s->shade + (long)s->size * s->size, s->size, s->size, (p[0] + s->extent) * k, (p[1] + s->extent) * k);
		if (px[3] < 0.3F || px[1] < 1e-4F || painted->px[4 * i + 1] < 1e-3F)
			continue;
		const double off = log((double)px[1] / (double)painted->px[4 * i + 1]) + (given_back ? 0 : shade);
		if (shade < -0.3)
			in[n_in++] = off;
		else if (shade > -1e-6)
			out[n_out++] = off;
	}
	const double bias = n_in && n_out ? stats_median(n_in, in) - stats_median(n_out, out) : NAN;
	*n = n_in;
	free(in);
	free(out);
	return bias;
}

/* Path-traced lids: what they take is given back; where the renderer let light through them nothing is. */
static void lids_give_their_light_back(void **state)
{
	(void)state;
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES), shaded = 0;
	for (int i = 0; i < n; i++) {
		struct err err = { 0 };
		struct truth truth;
		struct image painted;
		double extent;
		const char *name = strrchr(dirs[i], '/') + 1;
		const bool lids = !strncmp(name, "G08", 3) || !strncmp(name, "L0", 2);
		if (lids && truth_load(&truth, dirs[i], &err) && iris_painted(&painted, &extent, &truth, dirs[i], 256)) {
			struct fit fit;
			struct unrefract_view view;
			struct unrefract_texture texture = texture_of(&truth, &fit, &view);
			int texels;
			const double was = shaded_bias(&texels, &texture, &view, &truth, &painted, extent, false), is = shaded_bias(&texels, &texture, &view, &truth, &painted, extent, true);
			if (*name == 'G')
				assert_null(view.survey.shade);  // lit evenly from all sides
			if (texels > 500) {
				print_message("%s: %d texels, %.2f off, %.2f with the light given back\n", name, texels, was, is);
				assert_true(fabs(is) < 0.5 * fabs(was) + 0.05);
				shaded++;
			}
			image_free(&painted);
			image_free(&texture.rgbw);
			unrefract_view_free(&view);
		}
		free(dirs[i]);
	}
	if (!shaded) {
		print_message("no rendered captures with shaded lids here: skipped\n");
		skip();
	}
}

/* Photographs of one eye, each in an eye frame turned by its own camera's roll: the turns are found again, and points
 * of one land on the same point of another. */
static void photographs_meet(void **state)
{
	(void)state;
	enum { N = 3 };
	static const char *const names[N] = { "G01_blue_00", "G03_blue_20", "G05_blue_40" };
	const char *data = bench_data("eyes");
	struct truth truth[N];
	struct fit fit[N];
	struct unrefract_view view[N] = { 0 };
	for (int i = 0; i < N; i++) {
		struct err err = { 0 };
		struct photo photo = { 0 };
		char *dir = mem_printf("%s/%s", data ? data : "", names[i]);
		if (!truth_load(&truth[i], dir, &err)) {
			print_message("no rendered captures here: skipped\n");
			free(dir);
			skip();
		}
		fit[i] = truth_fit(&truth[i]);
		view[i].name = names[i];
		assert_true(photo_load(&photo, truth[i].photo, 100, &err));
		assert_true(unrefract_survey(&view[i], &photo, &fit[i], 0, 0, &truth[i].eye, &plain, &err));
		photo_free(&photo);
		free(dir);
	}
	int best = unrefract_align(N, view, &plain);
	for (int i = 0; i < N; i++) {
		double turn = truth[i].turn - truth[best].turn;
		print_message("%s: turned by %.3f degrees, found %.3f, correlation %.2f\n", names[i], turn * 180 / M_PI,
		              view[i].rotation * 180 / M_PI, view[i].correlation);
		assert_true(view[i].used);
		double worst = 0;
		for (int k = 0; k < 12; k++) {
			double in[2] = { 4 * cos(k), 4 * sin(k) }, a[2], b[2];
			truth_turn(a, &truth[best], in);
			truth_turn(b, &truth[i], in);
			double x = view[i].iris.a[0][0] * a[0] + view[i].iris.a[0][1] * a[1] + view[i].iris.a[0][2];
			double y = view[i].iris.a[1][0] * a[0] + view[i].iris.a[1][1] * a[1] + view[i].iris.a[1][2];
			worst = fmax(worst, hypot(x - b[0], y - b[1]));
		}
		print_message("    worst %.4f mm\n", worst);
		// half a texel of the surveys, 0.024 mm each
		assert_true(worst < 0.012);
		unrefract_view_free(&view[i]);
	}
}

/* The same bytes on any number of threads. */
static void threads_do_not_matter(void **state)
{
	(void)state;
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES), threads = omp_get_max_threads();
	if (n) {
		struct err err = { 0 };
		struct truth truth;
		struct fit fit;
		struct unrefract_view view;
		assert_true(truth_load(&truth, dirs[n - 1], &err));
		struct unrefract_texture textures[2];
		for (int i = 0; i < 2; i++) {
			omp_set_num_threads(i ? 5 : 1);
			textures[i] = texture_of(&truth, &fit, &view);
			unrefract_view_free(&view);
		}
		omp_set_num_threads(threads);
		size_t bytes = (size_t)textures[0].rgbw.width * (size_t)textures[0].rgbw.height * 4 * sizeof(float);
		assert_memory_equal(textures[0].rgbw.px, textures[1].rgbw.px, bytes);
		image_free(&textures[0].rgbw);
		image_free(&textures[1].rgbw);
	}
	for (int i = 0; i < n; i++)
		free(dirs[i]);
	if (!n) {
		print_message("no rendered captures here: skipped\n");
		skip();
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(flat_limit),      cmocka_unit_test(paraxial),
		cmocka_unit_test(round_trip),      cmocka_unit_test(lattice_is_exact),
		cmocka_unit_test(against_renderer), cmocka_unit_test(masks_against_labels),
		cmocka_unit_test(lids_give_their_light_back),
		cmocka_unit_test(photographs_meet), cmocka_unit_test(threads_do_not_matter),
	};
	plain = iris_unrefract_conf("review");
	plain.max_size = 768;
	return cmocka_run_group_tests(tests, 0, 0);
}
