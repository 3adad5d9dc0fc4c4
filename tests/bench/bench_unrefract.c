/* Unrefracting: ways to find each texel's photo pixel, speed and error together; the position on the iris against an
 * independent ray tracer; textures of whole photographs.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "iris/iris_map.h"
#include "image/exr.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/iris.h"

enum { CAPTURES = 64 };

/* A generic eye, 30 degrees from the side, 110 mm away. */
static struct truth side_view(bool two_surface)
{
	double t = M_PI / 6;
	struct truth truth = { .eye = { 7.8, 0.75, 1.336, 5.85, 1, 3.3, two_surface, 6.5, 0.75, 0.55, 1.376 },
		               .focal_px = 9000, .center_px = { 800, 600 } };
	double pose[4][4] = { { cos(t), 0, sin(t), 0.4 }, { 0, 1, 0, -0.3 }, { -sin(t), 0, cos(t), 110 }, { 0, 0, 0, 1 } };
	memcpy(truth.cam_from_eye, pose, sizeof pose);
	return truth;
}

struct job {
	struct iris_view view;
	struct iris_map_conf conf;
	int size;
	struct iris_map map;
};

static void make_map(void *ctx)
{
	struct job *job = ctx;
	iris_map_free(&job->map);
	job->map = iris_map_new(&job->view, job->size, 6, 5.85, &job->conf);
}

/* Forward: the exact point of the iris that each photo pixel sees, then every pixel's quadrilateral as two triangles
 * into the texels it covers, the pixel coordinate linear on each. */
static void triangle(struct iris_map *map, const float p[3][2], const double px[3][2])
{
	double to = map->size / (2 * map->extent), x[3], y[3];
	for (int i = 0; i < 3; i++) {
		if (!isfinite(p[i][0]))
			return;
		x[i] = (p[i][0] + map->extent) * to - 0.5;
		y[i] = (p[i][1] + map->extent) * to - 0.5;
	}
	double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
	int x0 = (int)fmax(0, ceil(fmin(x[0], fmin(x[1], x[2])))), y0 = (int)fmax(0, ceil(fmin(y[0], fmin(y[1], y[2]))));
	int x1 = (int)fmin(map->size - 1, fmax(x[0], fmax(x[1], x[2])));
	int y1 = (int)fmin(map->size - 1, fmax(y[0], fmax(y[1], y[2])));
	for (int r = y0; r <= y1; r++)
		for (int c = x0; c <= x1; c++) {
			double b = ((c - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (r - y[0])) / area;
			double d = ((x[1] - x[0]) * (r - y[0]) - (c - x[0]) * (y[1] - y[0])) / area;
			if (b < -1e-9 || d < -1e-9 || b + d > 1 + 1e-9)
				continue;
			long i = (long)r * map->size + c;
			map->u[i] = (float)(px[0][0] + b * (px[1][0] - px[0][0]) + d * (px[2][0] - px[0][0]));
			map->v[i] = (float)(px[0][1] + b * (px[1][1] - px[0][1]) + d * (px[2][1] - px[0][1]));
		}
}

static void make_forward(void *ctx)
{
	struct job *job = ctx;
	struct image see = iris_map_forward(&job->view, 6.2, 6);
	size_t n = (size_t)job->size * (size_t)job->size;
	iris_map_free(&job->map);
	job->map = (struct iris_map){ job->size, 6, mem_array(n, sizeof(float)), mem_array(n, sizeof(float)),
		                      mem_array(n, sizeof(float)) };
	for (size_t i = 0; i < n; i++)
		job->map.u[i] = job->map.v[i] = job->map.rim[i] = NAN;
	for (int y = 0; y + 1 < see.height; y++)
		for (int x = 0; x + 1 < see.width; x++) {
			float p[4][2];
			double px[4][2];
			for (int k = 0; k < 4; k++) {
				memcpy(p[k], image_at(&see, x + k % 2, y + k / 2), sizeof p[k]);
				px[k][0] = x + k % 2 + 0.5;
				px[k][1] = y + k / 2 + 0.5;
			}
			float q[3][2] = { { p[3][0], p[3][1] }, { p[1][0], p[1][1] }, { p[2][0], p[2][1] } };
			double qx[3][2] = { { px[3][0], px[3][1] }, { px[1][0], px[1][1] }, { px[2][0], px[2][1] } };
			triangle(&job->map, p, px);
			triangle(&job->map, q, qx);
		}
	image_free(&see);
}

/* Largest distance on the iris, mm, from the exact map, among texels seen inside the limbus; counts what is missing
 * there as infinite. */
static double worst_mm(const struct iris_map *map, const struct iris_map *exact, const struct iris_view *view)
{
	double worst = 0, scale = iris_view_px_per_mm(view);
	for (long i = 0; i < (long)map->size * map->size; i++)
		if (exact->rim[i] < 5.6 && isfinite(exact->u[i]))
			worst = fmax(worst, isfinite(map->u[i]) ? hypot(map->u[i] - exact->u[i], map->v[i] - exact->v[i]) / scale
			                                        : INFINITY);
	return worst;
}

static void row(const char *method, const char *setting, void (*fn)(void *), struct job *job,
                const struct iris_map *exact, const struct iris_view *view, int reps)
{
	struct bench_time t = bench_time(fn, job, reps);
	double texels = M_PI / 4 * (5.85 / 6) * (5.85 / 6) * job->size * job->size;
	t.median /= texels, t.low /= texels, t.high /= texels;
	bench_row("inverse map", method, setting, t, "texel", worst_mm(&job->map, exact, view), "mm",
	          "position on the iris, worst");
	iris_map_free(&job->map);
}

static void inverse_maps(bool two_surface)
{
	struct truth truth = side_view(two_surface);
	struct fit fit = truth_fit(&truth);
	fit.width = 1600, fit.height = 1200;
	struct job job = { .view = iris_view_new(&fit, &truth.eye), .size = bench_quick() ? 256 : 1024 };
	job.conf = (struct iris_map_conf){ .method = IRIS_NEWTON };
	struct iris_map exact = iris_map_new(&job.view, job.size, 6, 5.85, &job.conf);
	int reps = bench_quick() ? 3 : 9;
	static const int nodes[] = { 4, 8, 16, 32, 64 };
	char text[64];
	for (int i = 0; i < COUNT(nodes); i++) {
		job.conf = (struct iris_map_conf){ .method = IRIS_LATTICE, .node = nodes[i] };
		snprintf(text, sizeof text, "%d texels between nodes%s", nodes[i], two_surface ? ", two surfaces" : "");
		row("lattice", text, make_map, &job, &exact, &job.view, reps);
	}
	job.conf = (struct iris_map_conf){ .method = IRIS_NEWTON };
	row("Newton, each texel", two_surface ? "two surfaces" : "double", make_map, &job, &exact, &job.view, 3);
	if (two_surface) {
		iris_map_free(&exact);
		return;
	}
	row("forward, each pixel", "triangles", make_forward, &job, &exact, &job.view, 3);
	iris_map_free(&exact);
	job.size = 64;
	job.conf.method = IRIS_NEWTON;
	exact = iris_map_new(&job.view, job.size, 6, 5.85, &job.conf);
	static const int steps[] = { 10, 100, 1000 };
	for (int i = 0; i < (bench_quick() ? 2 : 3); i++) {
		job.conf = (struct iris_map_conf){ IRIS_ALGORITHM1, 0, 0.5, 1e-4, 1e-4, steps[i], 100 };
		snprintf(text, sizeof text, "%d steps a plane", steps[i]);
		row("algorithm 1 (paper)", text, make_map, &job, &exact, &job.view, i < 2 ? 3 : 1);
	}
	iris_map_free(&exact);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct spread {
	double median, most;  // most: 95 %
};

/* Of the difference, with the exact pose, to the renderer's own points inside 0.9 of the iris. */
static struct spread position(const struct truth *truth, const struct eye *eye, const struct image *map)
{
	struct fit fit = truth_fit(truth);
	struct iris_view view = iris_view_new(&fit, eye);
	double *error = mem_array((size_t)map->width * (size_t)map->height, sizeof *error);
	long n = 0;
	for (int y = 0; y < map->height; y++)
		for (int x = 0; x < map->width; x++) {
			const float *t = image_at(map, x, y);
			double at[2] = { t[0], t[1] }, here[2], px[2] = { 2 * x + 0.5, 2 * y + 0.5 };
			if (t[2] != 1 || hypot(at[0], at[1]) > 0.9 * truth->iris_radius)
				continue;
			truth_turn(at, truth, at);
			error[n++] = iris_see(here, 0, &view, px) ? hypot(at[0] - here[0], at[1] - here[1]) : INFINITY;
		}
	qsort(error, (size_t)n, sizeof *error, by_value);
	struct spread s = { n ? error[n / 2] : NAN, n ? error[n * 95 / 100] : NAN };
	free(error);
	return s;
}

static void positions(int n, char *const dirs[])
{
	static const char *const channels[] = { "R", "G", "A" };
	const struct bench_time untimed = { NAN, NAN, NAN };
	double median = 0, most = 0;
	int maps = 0;
	for (int i = 0; i < n; i++) {
		struct err err = { 0 };
		struct truth truth;
		struct image map = { 0 };
		char *path = mem_printf("%s/map.exr", dirs[i]);
		if (truth_load(&truth, dirs[i], &err) && exr_read(&map, path, 3, channels, 1L << 26, 0, &err)) {
			struct spread exact = position(&truth, &truth.eye, &map);
			struct eye generic = { 7.8, 0.75, 1.336, truth.eye.limbus_radius, 1, 3.3, false, 6.5, 0.75, 0.55, 1.376 };
			struct spread guess = position(&truth, &generic, &map);
			bench_row("position", "as rendered", truth.name, untimed, "photograph", exact.median, "mm", "median");
			bench_row("position", "as rendered", truth.name, untimed, "photograph", exact.most, "mm", "95 %");
			bench_row("position", "generic cornea", truth.name, untimed, "photograph", guess.median, "mm", "median");
			bench_row("position", "generic cornea", truth.name, untimed, "photograph", guess.most, "mm", "95 %");
			median = fmax(median, exact.median);
			most = fmax(most, exact.most);
			maps++;
			image_free(&map);
		}
		free(path);
	}
	if (!maps)
		return;
	bench_goal("unrefracted position, pose known, worst capture: median", "<= 0.03 mm", median, "mm", median <= 0.03);
	bench_goal("unrefracted position, pose known, worst capture: 95 %", "<= 0.1 mm", most, "mm", most <= 0.1);
}

struct whole {
	struct truth truth;
	struct unrefract_conf conf;
	double seen;
};

static void make_texture(void *ctx)
{
	struct whole *w = ctx;
	struct err err = { 0 };
	struct fit fit;
	struct unrefract_view view;
	struct unrefract_texture texture;
	if (!iris_texture(&texture, &view, &fit, &w->truth, &w->conf, &err))
		return;
	w->seen = texture.seen;
	image_free(&texture.rgbw);
	unrefract_view_free(&view);
}

static void textures(int n, char *const dirs[])
{
	for (int i = 0; i < n; i += bench_quick() ? 5 : 2) {
		struct whole w = { .conf = iris_unrefract_conf("review") };
		struct err err = { 0 };
		if (!truth_load(&w.truth, dirs[i], &err))
			continue;
		struct bench_time t = bench_time(make_texture, &w, bench_quick() ? 1 : 5);
		bench_row("texture of a photograph", "review", w.truth.name, t, "photograph", 100 * (1 - w.seen), "%",
		          "of the iris not seen");
		w.conf = iris_unrefract_conf("draft");
		t = bench_time(make_texture, &w, bench_quick() ? 1 : 5);
		bench_row("texture of a photograph", "draft", w.truth.name, t, "photograph", 100 * (1 - w.seen), "%",
		          "of the iris not seen");
	}
}

int main(int argc, char **argv)
{
	bench_open("unrefract", argc, argv);
	inverse_maps(false);
	inverse_maps(true);
	char *dirs[CAPTURES];
	int n = truth_captures(dirs, CAPTURES);
	positions(n, dirs);
	textures(n, dirs);
	for (int i = 0; i < n; i++)
		free(dirs[i]);
	return bench_close();
}
