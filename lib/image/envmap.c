#include "image/envmap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/exr.h"

static void dir_of(double dir[3], double u, double v)
{
	double polar = v * M_PI, turn = (u - 0.5) * 2 * M_PI;
	dir[0] = -sin(polar) * sin(turn);
	dir[1] = -cos(polar);
	dir[2] = -sin(polar) * cos(turn);
}

static double lum(const float rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/* Real spherical harmonics to degree 2. */
static void harmonics(double y[9], const double d[3])
{
	y[0] = 0.282094791773878;
	y[1] = 0.488602511902920 * d[1];
	y[2] = 0.488602511902920 * d[2];
	y[3] = 0.488602511902920 * d[0];
	y[4] = 1.092548430592079 * d[0] * d[1];
	y[5] = 1.092548430592079 * d[1] * d[2];
	y[6] = 0.315391565252520 * (3 * d[2] * d[2] - 1);
	y[7] = 1.092548430592079 * d[0] * d[2];
	y[8] = 0.546274215296040 * (d[0] * d[0] - d[1] * d[1]);
}

/* The map averaged down to 64 rows: sharp enough for light on a rough surface. image_free. */
static struct image coarse(const struct image *map)
{
	int rows = map->height < 64 ? map->height : 64, k = map->height / rows;
	struct image out = image_new(2 * rows, rows, 3);
	for (int y = 0; y < rows; y++)
		for (int x = 0; x < 2 * rows; x++)
			for (int j = 0; j < k; j++)
				for (int i = 0; i < k; i++)
					for (int c = 0; c < 3; c++)
						image_at(&out, x, y)[c] += image_at(map, x * k + i, y * k + j)[c] / (float)(k * k);
	return out;
}

static double solid_angle(const struct image *map, int y)
{
	return (cos(M_PI * y / map->height) - cos(M_PI * (y + 1) / map->height)) * 2 * M_PI / map->width;
}

/* Ramamoorthi and Hanrahan 2001: the cosine lobe in degrees 0, 1, 2 is 1, 2/3, 1/4 (times pi). */
static void project(struct envmap *env)
{
	static const double lobe[9] = { 1, 2.0 / 3, 2.0 / 3, 2.0 / 3, 0.25, 0.25, 0.25, 0.25, 0.25 };
	struct image map = coarse(&env->map);
	memset(env->sh, 0, sizeof env->sh);
	for (int y = 0; y < map.height; y++)
		for (int x = 0; x < map.width; x++) {
			double d[3], h[9], w = solid_angle(&map, y);
			dir_of(d, (x + 0.5) / map.width, (y + 0.5) / map.height);
			harmonics(h, d);
			for (int k = 0; k < 9; k++)
				for (int c = 0; c < 3; c++)
					env->sh[k][c] += lobe[k] * h[k] * w * image_at(&map, x, y)[c];
		}
	image_free(&map);
}

/* How much of a box a direction is in: 1 inside, falling to 0 over half a degree outside. */
static double box_cover(const struct envmap_box *box, const double side[3], const double up[3], const double dir[3])
{
	double z = dir[0] * box->dir[0] + dir[1] * box->dir[1] + dir[2] * box->dir[2];
	if (z <= 0.1)
		return 0;
	double a = atan((dir[0] * side[0] + dir[1] * side[1] + dir[2] * side[2]) / z);
	double b = atan((dir[0] * up[0] + dir[1] * up[1] + dir[2] * up[2]) / z);
	double edge = 0.5 * M_PI / 180, out = fmax(fabs(a) - box->half[0], fabs(b) - box->half[1]);
	double t = 1 - fmin(fmax(out / edge + 0.5, 0), 1);
	return t * t * (3 - 2 * t);
}

static void box_axes(double side[3], double up[3], const double d[3])
{
	// Upwards is -y, except for a box straight above or below, where any direction will do.
	double ref[3] = { 0, fabs(d[1]) > 0.99 ? 0 : 1, fabs(d[1]) > 0.99 ? 1 : 0 };
	side[0] = d[1] * ref[2] - d[2] * ref[1];
	side[1] = d[2] * ref[0] - d[0] * ref[2];
	side[2] = d[0] * ref[1] - d[1] * ref[0];
	double n = sqrt(side[0] * side[0] + side[1] * side[1] + side[2] * side[2]);
	for (int i = 0; i < 3; i++)
		side[i] /= n;
	up[0] = d[1] * side[2] - d[2] * side[1];
	up[1] = d[2] * side[0] - d[0] * side[2];
	up[2] = d[0] * side[1] - d[1] * side[0];
}

static void paint_box(struct image *map, const struct envmap_box *box)
{
	double side[3], up[3];
	box_axes(side, up, box->dir);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < map->height; y++)
		for (int x = 0; x < map->width; x++) {
			double d[3];
			dir_of(d, (x + 0.5) / map->width, (y + 0.5) / map->height);
			double a = d[0] * box->dir[0] + d[1] * box->dir[1] + d[2] * box->dir[2];
			if (a < 0.3)
				continue;
			double t = box_cover(box, side, up, d);
			for (int c = 0; c < 3; c++) {
				float *p = &image_at(map, x, y)[c];
				*p += (float)(t * (box->rgb[c] - *p));
			}
		}
}

struct envmap envmap_room(int height, const double ceiling[3], const double floor[3], int n,
                          const struct envmap_box boxes[])
{
	struct envmap env = { .map = image_new(2 * height, height, 3) };
	for (int y = 0; y < height; y++) {
		double t = (1 - cos(M_PI * (y + 0.5) / height)) / 2;
		for (int x = 0; x < 2 * height; x++)
			for (int c = 0; c < 3; c++)
				image_at(&env.map, x, y)[c] = (float)(ceiling[c] + t * (floor[c] - ceiling[c]));
	}
	for (int i = 0; i < n; i++)
		paint_box(&env.map, &boxes[i]);
	project(&env);
	return env;
}

bool envmap_load(struct envmap *env, const char *path, struct err *err)
{
	static const char *const rgb[] = { "R", "G", "B" };
	*env = (struct envmap){ 0 };
	if (!exr_read(&env->map, path, 3, rgb, 1L << 26, 0, err))
		return false;
	int w = env->map.width, h = env->map.height;
	if (w != 2 * h || h < 8) {
		image_free(&env->map);
		return err_set(err, "%s: %d x %d px: a latitude-longitude map is twice as wide as high, 16 x 8 at least", path,
		               w, h);
	}
	for (long i = 0; i < 3L * w * h; i++) {
		float v = env->map.px[i];
		env->map.px[i] = v > 0 && isfinite(v) ? v : 0;
	}
	project(env);
	if (!(env->sh[0][0] + env->sh[0][1] + env->sh[0][2] > 0)) {
		image_free(&env->map);
		return err_set(err, "%s: the map is black", path);
	}
	return true;
}

void envmap_free(struct envmap *env)
{
	image_free(&env->map);
}

void envmap_irradiance(float rgb[3], const struct envmap *env, const float normal[3])
{
	double h[9], n[3] = { normal[0], normal[1], normal[2] };
	harmonics(h, n);
	for (int c = 0; c < 3; c++) {
		double sum = 0;
		for (int k = 0; k < 9; k++)
			sum += env->sh[k][c] * h[k];
		rgb[c] = (float)fmax(sum, 0);
	}
}

double envmap_level(const struct envmap *env)
{
	// Degrees 0 to 2 only approximate a narrow light's cosine; the plane's own irradiance is summed exactly.
	double sum = 0;
	struct image map = coarse(&env->map);
	for (int y = 0; y < map.height; y++)
		for (int x = 0; x < map.width; x++) {
			double d[3];
			dir_of(d, (x + 0.5) / map.width, (y + 0.5) / map.height);
			const float *p = image_at(&map, x, y);
			sum += fmax(-d[2], 0) * solid_angle(&map, y) * (p[0] + p[1] + p[2]) / (3 * M_PI);
		}
	image_free(&map);
	return sum;
}

void envmap_normalise(struct envmap *env)
{
	double level = envmap_level(env), k = level > 0 ? 1 / level : 1;
	for (long i = 0; i < 3L * env->map.width * env->map.height; i++)
		env->map.px[i] *= (float)k;
	for (int i = 0; i < 9; i++)
		for (int c = 0; c < 3; c++)
			env->sh[i][c] *= k;
}

void envmap_at(float rgb[3], const struct envmap *env, const float d[3])
{
	const struct image *map = &env->map;
	float len = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	float c = len > 0 ? fminf(fmaxf(-d[1] / len, -1), 1) : 0;
	float u = (0.5f + atan2f(-d[0], -d[2]) * (float)(0.5 / M_PI)) * (float)map->width - 0.5f;
	float v = acosf(c) * (float)(1 / M_PI) * (float)map->height - 0.5f;
	float fu = floorf(u), fv = floorf(v);
	int w = map->width, h = map->height, x0 = ((int)fu + w) % w, x1 = (x0 + 1) % w;
	int y0 = (int)fv, y1 = y0 + 1;
	y0 = y0 < 0 ? 0 : y0;
	y1 = y1 > h - 1 ? h - 1 : y1;
	u -= fu;
	v -= fv;
	const float *a = image_at(map, x0, y0), *b = image_at(map, x1, y0), *e = image_at(map, x0, y1),
	            *f = image_at(map, x1, y1);
	for (int k = 0; k < 3; k++)
		rgb[k] = (1 - v) * ((1 - u) * a[k] + u * b[k]) + v * ((1 - u) * e[k] + u * f[k]);
}

struct region {
	int x0, y0, x1, y1;
};

static double region_energy(const struct image *map, struct region r)
{
	double sum = 0;
	for (int y = r.y0; y < r.y1; y++)
		for (int x = r.x0; x < r.x1; x++)
			sum += lum(image_at(map, x, y)) * solid_angle(map, y);
	return sum;
}

/* Cuts across the longer side (in angle) where half of the energy lies on each side. */
static void cut(const struct image *map, struct region r, struct region out[2])
{
	double width = (r.x1 - r.x0) * sin(M_PI * 0.5 * (r.y0 + r.y1) / map->height);
	bool across = (width >= r.y1 - r.y0 && r.x1 - r.x0 > 1) || r.y1 - r.y0 < 2;
	int lo = across ? r.x0 : r.y0, hi = across ? r.x1 : r.y1, at = lo + 1;
	double half = region_energy(map, r) / 2, sum = 0;
	for (int i = lo; i < hi - 1; i++) {
		struct region line = across ? (struct region){ i, r.y0, i + 1, r.y1 } : (struct region){ r.x0, i, r.x1, i + 1 };
		sum += region_energy(map, line);
		at = i + 1;
		if (sum >= half)
			break;
	}
	out[0] = out[1] = r;
	*(across ? &out[0].x1 : &out[0].y1) = at;
	*(across ? &out[1].x0 : &out[1].y0) = at;
}

static bool region_light(struct envmap_light *light, const struct image *map, struct region r)
{
	double dir[3] = { 0 }, rgb[3] = { 0 };
	for (int y = r.y0; y < r.y1; y++)
		for (int x = r.x0; x < r.x1; x++) {
			double d[3], w = solid_angle(map, y);
			const float *p = image_at(map, x, y);
			dir_of(d, (x + 0.5) / map->width, (y + 0.5) / map->height);
			for (int c = 0; c < 3; c++) {
				dir[c] += d[c] * w * lum(p);
				rgb[c] += w * p[c] / M_PI;
			}
		}
	double n = sqrt(dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2]);
	for (int c = 0; c < 3; c++) {
		light->dir[c] = (float)(n > 0 ? dir[c] / n : c == 2 ? -1 : 0);
		light->rgb[c] = (float)rgb[c];
	}
	return n > 0;
}

int envmap_lights(struct envmap_light lights[], int n, const struct envmap *env)
{
	struct image map = coarse(&env->map);
	struct region regions[ENVMAP_LIGHTS_MAX] = { { 0, 0, map.width, map.height } };
	int made = 1, out = 0;
	while (2 * made <= n && 2 * made <= ENVMAP_LIGHTS_MAX) {
		for (int i = made - 1; i >= 0; i--) {
			struct region two[2];
			cut(&map, regions[i], two);
			regions[2 * i] = two[0];
			regions[2 * i + 1] = two[1];
		}
		made *= 2;
	}
	for (int i = 0; i < made; i++)
		out += region_light(&lights[out], &map, regions[i]);
	image_free(&map);
	return out;
}
