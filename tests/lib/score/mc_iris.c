#include "tests/lib/score/mc_iris.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/run.h"
#include "bridge/cv_blur.h"
#include "bridge/imf_read.h"
#include "image/colour.h"
#include "image/envmap/envmap.h"
#include "image/exr.h"
#include "image/photo/photo.h"

enum { LIMIT_PX = 1 << 26 };
static const double inner = 2.3, outer = 5.3, smooth_mm = 0.1;
static const char *const keys[MC_NUMBERS][2] = {
	{ "abl", "melanin" }, { "abl", "eumelanin_ratio" }, { "stroma", "melanin" }, { "stroma", "eumelanin_ratio" }, { "stroma", "thickness_scale" },
};

static bool truth_load(struct mc_iris *m, struct err *err)
{
	char *path = mem_printf("%s/truth.json", m->from);
	json_t *root = json_read(path, 1 << 20, err), *eye = json_object_get(root, "eye"), *thick = json_object_get(root, "thickness");
	double size[2] = { 0 };
	bool ok = root && json_get_array(size, 2, root, "size", path, err) && json_get(&m->focal_px, root, "focal_px", path, err)
	          && json_get_array(m->pose[MC_OWN][0], 16, root, "cam_from_eye", path, err)
	          && json_get_array(m->pose[MC_TURNED][0], 16, root, "cam_from_eye_turned", path, err)
	          && json_get(&m->cornea.R, eye, "cornea_radius_mm", path, err) && json_get(&m->cornea.p, eye, "cornea_asphericity", path, err)
	          && json_get(&m->cornea.n, eye, "index", path, err) && json_get(&m->cornea.rim, eye, "limbus_radius_mm", path, err)
	          && json_get(&m->depth, eye, "iris_depth_mm", path, err) && json_get(&m->half_width, thick, "half_width_mm", path, err);
	for (int i = 0; ok && i < MC_NUMBERS; i++)
		ok = json_get(&m->truth[i], json_object_get(root, keys[i][0]), keys[i][1], path, err);
	memcpy(m->pose[MC_RELIT], m->pose[MC_OWN], sizeof m->pose[0]);
	m->width = (int)size[0];
	m->height = (int)size[1];
	json_decref(root);
	free(path);
	return ok;
}

static bool picture_load(struct image *out, const char *path, struct err *err)
{
	struct photo photo = { 0 };
	if (!photo_load(&photo, path, 100, err))
		return false;
	*out = photo_linear(&photo, 0, 0, photo.width, photo.height);
	photo_free(&photo);
	return true;
}

/* A 16-bit picture of multiples of 1e-4 mm, which the reader takes for sRGB. */
static bool thickness_load(struct mc_iris *m, struct err *err)
{
	char *path = mem_printf("%s/thickness.png", m->from);
	struct image rgb;
	bool ok = picture_load(&rgb, path, err);
	free(path);
	if (!ok)
		return false;
	m->thickness = image_new(rgb.width, rgb.height, 1);
	for (long i = 0; i < (long)rgb.width * rgb.height; i++)
		m->thickness.px[i] = srgb_from_linear(rgb.px[3 * i]) * 65535 * 1e-4f;
	image_free(&rgb);
	return true;
}

static const char *name_of(const struct mc_iris *m)
{
	const char *slash = strrchr(m->from, '/');
	return slash ? slash + 1 : m->from;
}

bool mc_iris_load(struct mc_iris *m, const char *from, struct err *err)
{
	*m = (struct mc_iris){ .from = from };
	char *photo = mem_printf("%s/photos/right_%s.png", from, name_of(m)), *relit = mem_printf("%s/relit.exr", from);
	char *turned = mem_printf("%s/turned.exr", from);
	bool ok = truth_load(m, err) && thickness_load(m, err) && picture_load(&m->picture[MC_OWN], photo, err)
	          && imf_read_rgb(&m->picture[MC_RELIT], relit, LIMIT_PX, err) && imf_read_rgb(&m->picture[MC_TURNED], turned, LIMIT_PX, err);
	free(photo);
	free(relit);
	free(turned);
	return ok;
}

void mc_iris_free(struct mc_iris *m)
{
	for (int i = 0; i < MC_PICTURES; i++)
		image_free(&m->picture[i]);
	image_free(&m->thickness);
}

/* Radius at which the ray of a pixel meets the iris plane; NAN beside the cornea. */
static double radius_at(const struct mc_iris *m, const double pose[4][4], int x, int y)
{
	double cam[3] = { (x + 0.5 - 0.5 * m->width) / m->focal_px, (y + 0.5 - 0.5 * m->height) / m->focal_px, 1 }, o[3] = { 0 }, d[3] = { 0 };
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++) {
			o[j] -= pose[i][j] * pose[i][3];
			d[j] += pose[i][j] * cam[i];
		}
	double len = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), K[3], from[3], in[3];
	for (int j = 0; j < 3; j++)
		d[j] /= len;
	if (!cornea_sight(K, from, in, &m->cornea, o, d) || in[2] < 0.05)
		return NAN;
	double t = (m->depth - from[2]) / in[2];
	return hypot(from[0] + t * in[0], from[1] + t * in[1]);
}

/* r, g, b times weight, and the weight, smoothed: the mean over what counts. */
static struct image smoothed(const struct image *in, const float *weight, double sigma)
{
	struct image out = image_new(in->width, in->height, 4);
	struct err err = { 0 };
	for (long i = 0; i < (long)in->width * in->height; i++) {
		for (int c = 0; c < 3; c++)
			out.px[4 * i + c] = weight[i] * in->px[in->channels * i + c];
		out.px[4 * i + 3] = weight[i];
	}
	cv_blur(out.px, out.px, out.width, out.height, 4, sigma, &err);
	return out;
}

double mc_iris_difference(const struct mc_iris *m, enum mc_picture which, const struct image *got)
{
	long n = (long)m->width * m->height, count = 0;
	if (got->width != m->width || got->height != m->height)
		return NAN;
	float *weight = mem_array((size_t)n, sizeof *weight);
	unsigned char *in = mem_array((size_t)n, 1);
	for (long i = 0; i < n; i++) {
		double r = radius_at(m, m->pose[which], (int)(i % m->width), (int)(i / m->width));
		const float *p = m->picture[which].px + 3 * i;
		bool lit = p[0] + p[1] + p[2] > 0;
		weight[i] = lit && r > inner - 0.2 && r < outer + 0.2;
		in[i] = lit && r > inner && r < outer;
	}
	double sigma = smooth_mm * m->focal_px / (m->pose[which][2][3] + m->depth), sum = 0;
	struct image a = smoothed(&m->picture[which], weight, sigma), b = smoothed(got, weight, sigma);
	for (long i = 0; i < n; i++) {
		float p[3], q[3];
		for (int c = 0; in[i] && c < 3; c++) {
			p[c] = a.px[4 * i + c] / a.px[4 * i + 3];
			q[c] = b.px[4 * i + c] / b.px[4 * i + 3];
		}
		sum += in[i] ? colour_difference(p, q) : 0;
		count += in[i];
	}
	image_free(&a);
	image_free(&b);
	free(weight);
	free(in);
	return count ? sum / (double)count : NAN;
}

static bool copy(const char *to_dir, const char *to, const char *from_dir, const char *from, struct err *err)
{
	char *in = mem_printf("%s/%s", from_dir, from), *out = mem_printf("%s/%s", to_dir, to), *bytes = 0;
	size_t size;
	bool ok = file_read(&bytes, &size, in, 1 << 26, err) && file_write(out, bytes, size, err);
	free(bytes);
	free(in);
	free(out);
	return ok;
}

/* A light of the data at the level that it has by truth.json, where both are 1 on a plane that faces the camera: the map's pixels miss 2.7 % of
 * light B's disc of 9 degrees (its radiance times that disc is the level), and the picture was made with all of it. */
static bool light_put(const char *dir, const char *name, const char *from, struct err *err)
{
	static const char *const rgb[] = { "R", "G", "B" };
	char *in = mem_printf("%s/%s", from, name), *out = mem_printf("%s/%s", dir, name);
	struct image map = { 0 };
	struct envmap env = { 0 };
	bool ok = imf_read_rgb(&map, in, LIMIT_PX, err) && envmap_take(&env, &map, in, err);
	if (ok) {
		envmap_normalise(&env);
		ok = exr_write(out, &env.map, rgb, EXR_FLOAT, 0, err);
	}
	envmap_free(&env);
	free(in);
	free(out);
	return ok;
}

static bool capture_make(const struct mc_iris *m, const char *dir, const struct mc_case *how, struct err *err)
{
	char *photo = mem_printf("photos/right_%s.png", name_of(m)), *photos = mem_printf("%s/photos", dir), *shots = mem_printf("%s/shots.json", dir);
	const double *p = m->pose[MC_TURNED][0];
	mkdir(dir, 0777);
	mkdir(photos, 0777);
	bool ok = copy(dir, photo, m->from, photo, err) && light_put(dir, "light_A.exr", m->from, err)
	          && light_put(dir, "light_B.exr", m->from, err);
	FILE *f = ok ? fopen(shots, "w") : 0;
	if (f) {
		fprintf(f, "[{\"name\": \"own\"}, {\"name\": \"relit\", \"environment\": \"light_B.exr\"}, {\"name\": \"turned\", \"cam_from_eye\": [");
		for (int i = 0; i < 16; i++)
			fprintf(f, "%s%.12g", i ? ", " : "", p[i]);
		fprintf(f, "]}]\n");
		fclose(f);
	}
	free(photo);
	free(photos);
	free(shots);
	(void)how;
	return ok && (f || err_set(err, "%s: cannot be written", dir));
}

static bool conf_write(const struct mc_iris *m, const char *dir, const struct mc_case *how, double detail, struct err *err)
{
	char *text = mem_printf("camera.focal_px = %g\nlight.illuminant = D65\nlight.polarised = yes\neye.limbus_aspect = 1\n%s%s%s"
	                        "render.shots = shots.json\nrender.detail = %g\n",
	                        m->focal_px, how->told ? "light.environment = light_A.exr\n" : "", how->more ? how->more : "", how->more ? "\n" : "", detail);
	char *path = mem_printf("%s/capture.conf", dir);
	bool ok = file_write(path, text, strlen(text), err);
	free(text);
	free(path);
	return ok;
}

static bool make(const char *dir, const char *stage, struct err *err)
{
	char *capture = mem_printf("CAPTURE=%s", dir), *log = mem_printf("%s.log", dir);
	const char *const argv[] = { "make", "--no-print-directory", capture, stage, 0 };
	struct run run = { .argv = argv, .log = log, .install = "apt-get install make" };
	bool ok = run_program(&run, err);
	free(capture);
	free(log);
	return ok;
}

static bool pictures_score(double out[MC_PICTURES], const struct mc_iris *m, const char *dir, struct err *err)
{
	static const char *const names[MC_PICTURES] = { "own", "relit", "turned" };
	bool ok = true;
	for (int i = 0; ok && i < MC_PICTURES; i++) {
		char *path = mem_printf("%s/work/render/shot_%s.exr", dir, names[i]);
		struct image got = { 0 };
		ok = imf_read_rgb(&got, path, LIMIT_PX, err);
		out[i] = ok ? mc_iris_difference(m, (enum mc_picture)i, &got) : NAN;
		image_free(&got);
		free(path);
	}
	return ok;
}

static bool numbers_score(struct mc_score *s, const char *dir, struct err *err)
{
	char *path = mem_printf("%s/work/iris/pigment.json", dir);
	json_t *root = json_read(path, 1 << 22, err);
	bool ok = root;
	for (int i = 0; ok && i < MC_NUMBERS; i++) {
		const json_t *e = json_object_get(json_object_get(root, keys[i][0]), keys[i][1]);
		ok = json_get(&s->value[i], e, "value", path, err) && json_get(&s->sigma[i], e, "sigma", path, err);
		if (i != MC_ABL_RATIO && i != MC_STROMA_RATIO)
			s->sigma[i] /= s->value[i];
	}
	json_decref(root);
	free(path);
	return ok;
}

/* The difference of two Gaussians of a map whose other channel is its weight; [n][n]. */
static void band(float *out, const struct image *map, double low, double high)
{
	struct image fine = image_new(map->width, map->height, 2), coarse = image_new(map->width, map->height, 2);
	struct err err = { 0 };
	cv_blur(fine.px, map->px, map->width, map->height, 2, low, &err);
	cv_blur(coarse.px, map->px, map->width, map->height, 2, high, &err);
	for (long i = 0; i < (long)map->width * map->height; i++)
		out[i] = fine.px[2 * i] / fmaxf(fine.px[2 * i + 1], 1e-3f) - coarse.px[2 * i] / fmaxf(coarse.px[2 * i + 1], 1e-3f);
	image_free(&fine);
	image_free(&coarse);
}

static void relate(double *amplitude, double *correlation, const float *got, const float *truth, const float *counts, long n)
{
	double s[6] = { 0 };
	for (long i = 0; i < n; i++)
		if (counts[i] > 0) {
			s[0]++;
			s[1] += got[i];
			s[2] += truth[i];
			s[3] += got[i] * got[i];
			s[4] += truth[i] * truth[i];
			s[5] += got[i] * truth[i];
		}
	double vg = s[3] - s[1] * s[1] / s[0], vt = s[4] - s[2] * s[2] / s[0];
	*amplitude = sqrt(vg / vt);
	*correlation = (s[5] - s[1] * s[2] / s[0]) / sqrt(vg * vt);
}

/* Takes the mean over each radius away. */
static void without_rings(float *map, const float *counts, int n)
{
	enum { RINGS = 400 };
	double sum[RINGS] = { 0 }, weight[RINGS] = { 0 };
	for (int turn = 0; turn < 2; turn++)
		for (int i = 0; i < n * n; i++) {
			int k = (int)(hypot(i % n + 0.5 - 0.5 * n, i / n + 0.5 - 0.5 * n) / (0.5 * n) * (RINGS / 1.5));
			if (counts[i] > 0 && !turn) {
				sum[k] += map[i];
				weight[k]++;
			} else if (counts[i] > 0) {
				map[i] -= (float)(sum[k] / weight[k]);
			}
		}
}

/* A map of thickness (its channel of that name) and the truth on the truth's grid, each beside its weight; counts[n*n]: 1 where they are
 * compared. image_free(&pair[0]), image_free(&pair[1]); free(*counts). */
static bool pair_load(struct image pair[2], float **counts, const struct mc_iris *m, const char *path, const char *channel, struct err *err)
{
	struct exr_info info = { 0 };
	struct image got = { 0 };
	if (!exr_read(&got, path, 1, &channel, LIMIT_PX, &info, err))
		return false;
	const int n = m->thickness.width;
	const double mm = 2 * m->half_width / n;
	const long all = (long)n * n;
	*counts = mem_array((size_t)all, sizeof **counts);
	for (int k = 0; k < 2; k++)
		pair[k] = image_new(n, n, 2);
	for (long i = 0; i < all; i++) {
		double x = ((double)(i % n) + 0.5) * mm - m->half_width, y = ((double)(i / n) + 0.5) * mm - m->half_width, r = hypot(x, y);
		double u = (x / info.extent_mm + 1) / 2 * got.width - 0.5, v = (y / info.extent_mm + 1) / 2 * got.height - 0.5;
		int a = (int)fmin(fmax(u, 0), got.width - 2), b = (int)fmin(fmax(v, 0), got.height - 2);
		double p = u - a, q = v - b;
		const float *g = got.px + (long)b * got.width + a;
		float w = r > inner - 0.25 && r < outer + 0.25;
		(*counts)[i] = r > inner && r < outer;
		pair[0].px[2 * i] = w * (float)((1 - q) * ((1 - p) * g[0] + p * g[1]) + q * ((1 - p) * g[got.width] + p * g[got.width + 1]));
		pair[1].px[2 * i] = w * m->thickness.px[i];
		pair[0].px[2 * i + 1] = pair[1].px[2 * i + 1] = w;
	}
	image_free(&got);
	return true;
}

/* Both between Gaussians of 0.12 and 0.6 mm; free(of[0]), free(of[1]). */
static void bands_of(float *of[2], const struct mc_iris *m, const struct image pair[2])
{
	const int n = m->thickness.width;
	const double mm = 2 * m->half_width / n;
	for (int k = 0; k < 2; k++) {
		of[k] = mem_array((size_t)n * (size_t)n, sizeof(float));
		band(of[k], &pair[k], 0.12 / mm, 0.6 / mm);
	}
}

static bool relief_score(struct mc_score *s, const struct mc_iris *m, const char *dir, struct err *err)
{
	char *path = mem_printf("%s/work/iris/relief.exr", dir);
	struct image pair[2];
	float *of[2], *counts;
	bool ok = pair_load(pair, &counts, m, path, "T", err);
	free(path);
	if (!ok)
		return false;
	const int n = m->thickness.width;
	const long all = (long)n * n;
	double unused;
	bands_of(of, m, pair);
	relate(&s->amplitude, &s->correlation, of[0], of[1], counts, all);
	for (int k = 0; k < 2; k++) {
		for (long i = 0; i < all; i++)
			of[k][i] = pair[k].px[2 * i];
		without_rings(of[k], counts, n);
	}
	relate(&unused, &s->whole_correlation, of[0], of[1], counts, all);
	for (int k = 0; k < 2; k++) {
		image_free(&pair[k]);
		free(of[k]);
	}
	free(counts);
	return true;
}

bool mc_iris_capture(const struct mc_iris *m, const char *dir, const struct mc_case *how, struct err *err)
{
	return capture_make(m, dir, how, err) && conf_write(m, dir, how, 1, err);
}

double mc_iris_detail_off(const struct mc_iris *m, const char *path, const char *channel)
{
	struct err err = { 0 };
	struct image pair[2];
	float *of[2], *counts;
	double sum = 0, count = 0;
	if (!pair_load(pair, &counts, m, path, channel, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		return NAN;
	}
	bands_of(of, m, pair);
	for (long i = 0; i < (long)m->thickness.width * m->thickness.height; i++)
		if (counts[i] > 0) {
			sum += pow((double)of[0][i] - (double)of[1][i], 2);
			count++;
		}
	for (int k = 0; k < 2; k++) {
		image_free(&pair[k]);
		free(of[k]);
	}
	free(counts);
	return sqrt(sum / count);
}

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool mc_iris_score(struct mc_score *s, const struct mc_iris *m, const char *dir, const struct mc_case *how, struct err *err)
{
	*s = (struct mc_score){ 0 };
	if (!mc_iris_capture(m, dir, how, err))
		return false;
	double start = now_s();
	if (!make(dir, 0, err))
		return false;
	s->seconds = now_s() - start;
	return numbers_score(s, dir, err) && relief_score(s, m, dir, err) && pictures_score(s->shown, m, dir, err)
	       && conf_write(m, dir, how, 0, err) && make(dir, "render", err) && pictures_score(s->bare, m, dir, err);
}
