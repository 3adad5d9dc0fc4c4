#include "image/envmap/impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

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

/* The Legendre series, to degree 4, of c (1 - F(c)) (3 - c') for c > 0 and 0 below, c' the cosine of the bent ray, over its mean and times that of c:
 * 0.25, 0.507135, 0.325901, -0.0049, -0.126919. Degree 3 is left out. */
const double envmap_wet_lobe[4] = { 0.25 - 0.325901 / 2 - 3 * 0.126919 / 8, 0.507135, 3 * 0.325901 / 2 + 30 * 0.126919 / 8, -35 * 0.126919 / 8 };

enum { QUARTIC = ENVMAP_WET - 3 };
static const int power[QUARTIC][3] = { { 4, 0, 0 }, { 3, 1, 0 }, { 3, 0, 1 }, { 2, 2, 0 }, { 2, 1, 1 }, { 2, 0, 2 }, { 1, 3, 0 }, { 1, 2, 1 },
	                                   { 1, 1, 2 }, { 1, 0, 3 }, { 0, 4, 0 }, { 0, 3, 1 }, { 0, 2, 2 }, { 0, 1, 3 }, { 0, 0, 4 } };

/* Adds up a direction's coordinates and their quartic products. */
static void moments_add(double sum[ENVMAP_WET][3], const double d[3], double angle, const float rgb[3])
{
	double of[3][5];
	for (int i = 0; i < 3; i++) {
		of[i][0] = 1;
		for (int j = 0; j < 4; j++)
			of[i][j + 1] = of[i][j] * d[i];
	}
	for (int k = 0; k < ENVMAP_WET; k++) {
		const int *p = power[k < 3 ? 0 : k - 3];
		double share = angle / M_PI * (k < 3 ? d[k] : of[0][p[0]] * of[1][p[1]] * of[2][p[2]]);
		for (int c = 0; c < 3; c++)
			sum[k][c] += share * (double)rgb[c];
	}
}

/* Of the moments: that of the product with those powers, of degree 4, 2 or 0. Directions are unit: a missing pair of powers is any axis'. */
static double moment(const double sum[ENVMAP_WET][3], int c, int x, int y, int z)
{
	if (x < 0 || y < 0 || z < 0)
		return 0;
	if (x + y + z < 4)
		return moment(sum, c, x + 2, y, z) + moment(sum, c, x, y + 2, z) + moment(sum, c, x, y, z + 2);
	for (int k = 0; k < QUARTIC; k++)
		if (power[k][0] == x && power[k][1] == y)
			return sum[3 + k][c];
	return 0;
}

static double multinomial(int x, int y, int z)
{
	static const double factorial[] = { 1, 1, 2, 6, 24 };
	return x < 0 || y < 0 || z < 0 ? 0 : factorial[x + y + z] / (factorial[x] * factorial[y] * factorial[z]);
}

/* env->wet: the lobe summed over all directions. n . n = 1 makes up for the powers that its lower terms lack. */
static void wet_make(struct envmap *env, const double sum[ENVMAP_WET][3])
{
	for (int c = 0; c < 3; c++) {
		const double all = moment(sum, c, 0, 0, 0);
		for (int k = 0; k < 3; k++)
			env->wet[k][c] = (float)(envmap_wet_lobe[1] * sum[k][c]);
		for (int k = 0; k < QUARTIC; k++) {
			const int x = power[k][0], y = power[k][1], z = power[k][2];
			double v = envmap_wet_lobe[3] * multinomial(x, y, z) * sum[3 + k][c];
			for (int i = 0; i < 3; i++) {
				const int a = x - 2 * (i == 0), b = y - 2 * (i == 1), d = z - 2 * (i == 2);
				v += envmap_wet_lobe[2] * multinomial(a, b, d) * moment(sum, c, a, b, d);
			}
			if (x % 2 == 0 && y % 2 == 0 && z % 2 == 0)
				v += envmap_wet_lobe[0] * multinomial(x / 2, y / 2, z / 2) * all;
			env->wet[3 + k][c] = (float)v;
		}
	}
}

/* Ramamoorthi and Hanrahan 2001: the cosine lobe in degrees 0, 1, 2 is 1, 2/3, 1/4 (times pi). */
static void project(struct envmap *env)
{
	static const double lobe[9] = { 1, 2.0 / 3, 2.0 / 3, 2.0 / 3, 0.25, 0.25, 0.25, 0.25, 0.25 };
	struct image map = envmap_coarse(&env->map, ENVMAP_ROWS);
	double moments[ENVMAP_WET][3] = { 0 };
	memset(env->sh, 0, sizeof env->sh);
	for (int y = 0; y < map.height; y++) {
		double w = envmap_solid_angle(&map, y);
		for (int x = 0; x < map.width; x++) {
			double d[3], h[9];
			envmap_dir(d, (x + 0.5) / map.width, (y + 0.5) / map.height);
			harmonics(h, d);
			for (int k = 0; k < 9; k++)
				for (int c = 0; c < 3; c++)
					env->sh[k][c] += lobe[k] * h[k] * w * image_at(&map, x, y)[c];
			moments_add(moments, d, w, image_at(&map, x, y));
		}
	}
	image_free(&map);
	wet_make(env, moments);
	// harmonics() again, sorted by powers.
	static const double factor[9] = { 0.282094791773878, 0.488602511902920, 0.488602511902920, 0.488602511902920,
		                              1.092548430592079, 1.092548430592079, 0.946174695757560, 1.092548430592079,
		                              0.546274215296040 };
	static const int from[9] = { 0, 3, 1, 2, 4, 5, 6, 7, 8 };
	for (int k = 0; k < 9; k++)
		for (int c = 0; c < 3; c++)
			env->quadric[k][c] = (float)(factor[k] * env->sh[from[k]][c] - (k ? 0 : 0.315391565252520 * env->sh[6][c]));
}

/* Coverage of a direction by a box: 1 inside, falling to 0 over half a degree outside. bright: its radiance there over its mean. */
static double box_cover(double *bright, const struct envmap_box *box, const double side[3], const double up[3], const double dir[3])
{
	double z = dir[0] * box->dir[0] + dir[1] * box->dir[1] + dir[2] * box->dir[2];
	*bright = 1;
	if (z <= 0.1)
		return 0;
	double a = atan((dir[0] * side[0] + dir[1] * side[1] + dir[2] * side[2]) / z);
	double b = atan((dir[0] * up[0] + dir[1] * up[1] + dir[2] * up[2]) / z);
	double edge = 0.5 * M_PI / 180, out = fmax(fabs(a) - box->half[0], fabs(b) - box->half[1]);
	double t = 1 - fmin(fmax(out / edge + 0.5, 0), 1);
	if (box->hot > 0) {
		// A Gaussian of the mean 1 over the box.
		const double fade = 1.5, u = a / box->half[0], v = b / box->half[1], mean = M_PI * pow(erf(sqrt(fade)), 2) / (4 * fade);
		*bright += box->hot * (exp(-fade * (u * u + v * v)) / mean - 1);
	}
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
			envmap_dir(d, (x + 0.5) / map->width, (y + 0.5) / map->height);
			double a = d[0] * box->dir[0] + d[1] * box->dir[1] + d[2] * box->dir[2];
			if (a < 0.3)
				continue;
			double bright, t = box_cover(&bright, box, side, up, d);
			for (int c = 0; c < 3; c++) {
				float *p = &image_at(map, x, y)[c];
				*p += (float)(t * (bright * box->rgb[c] - *p));
			}
		}
}

struct envmap envmap_room(int height, const double ceiling[3], const double floor[3], double back, int n,
                          const struct envmap_box boxes[])
{
	struct envmap env = { .map = image_new(2 * height, height, 3) };
	for (int y = 0; y < height; y++) {
		double t = (1 - cos(M_PI * (y + 0.5) / height)) / 2, d[3];
		for (int x = 0; x < 2 * height; x++) {
			envmap_dir(d, (x + 0.5) / (2 * height), (y + 0.5) / height);
			double away = fmin(fmax(0.5 + 1.2 * d[2], 0), 1), k = 1 + away * away * (3 - 2 * away) * (back - 1);
			for (int c = 0; c < 3; c++)
				image_at(&env.map, x, y)[c] = (float)(k * (ceiling[c] + t * (floor[c] - ceiling[c])));
		}
	}
	for (int i = 0; i < n; i++)
		paint_box(&env.map, &boxes[i]);
	project(&env);
	envmap_unfold(&env);
	return env;
}

bool envmap_take(struct envmap *env, struct image *map, const char *name, struct err *err)
{
	int w = map->width, h = map->height;
	*env = (struct envmap){ .map = *map };
	*map = (struct image){ 0 };
	if (w != 2 * h || h < 8 || env->map.channels != 3) {
		envmap_free(env);
		return err_set(err, "%s: %d x %d px: a latitude-longitude map is twice as wide as high, 16 x 8 at least", name,
		               w, h);
	}
	for (long i = 0; i < 3L * w * h; i++) {
		float v = env->map.px[i];
		env->map.px[i] = v > 0 && isfinite(v) ? v : 0;
	}
	project(env);
	envmap_unfold(env);
	if (!(env->sh[0][0] + env->sh[0][1] + env->sh[0][2] > 0)) {
		envmap_free(env);
		return err_set(err, "%s: the map is black", name);
	}
	return true;
}

void envmap_free(struct envmap *env)
{
	image_free(&env->map);
	image_free(&env->sharp);
	image_free(&env->rough);
	image_free(&env->bend);
}

void envmap_irradiance(float rgb[3], const struct envmap *env, const float n[3])
{
	float x = n[0], y = n[1], z = n[2], terms[9] = { 1, x, y, z, x * y, y * z, z * z, x * z, x * x - y * y };
	for (int c = 0; c < 3; c++) {
		float sum = 0;
		for (int k = 0; k < 9; k++)
			sum += env->quadric[k][c] * terms[k];
		rgb[c] = sum > 0 ? sum : 0;
	}
}

void envmap_wet(float rgb[3], const struct envmap *env, const float n[3])
{
	for (int c = 0; c < 3; c++)
		rgb[c] = envmap_wet_at(&env->wet[0][c], 3, n[0], n[1], n[2]);
}

double envmap_level(const struct envmap *env)
{
	// Degrees 0 to 2 approximate the irradiance of a narrow light badly; here the cosine is summed exactly.
	double sum = 0;
	struct image map = envmap_coarse(&env->map, ENVMAP_ROWS);
	for (int y = 0; y < map.height; y++)
		for (int x = 0; x < map.width; x++) {
			double d[3];
			envmap_dir(d, (x + 0.5) / map.width, (y + 0.5) / map.height);
			const float *p = image_at(&map, x, y);
			sum += fmax(-d[2], 0) * envmap_solid_angle(&map, y) * (p[0] + p[1] + p[2]) / (3 * M_PI);
		}
	image_free(&map);
	return sum;
}

void envmap_scale(struct envmap *env, double k)
{
	struct image *const all[] = { &env->map, &env->sharp, &env->rough, &env->bend };
	for (int j = 0; j < 4; j++)
		for (long i = 0; i < (long)all[j]->channels * all[j]->width * all[j]->height; i++)
			all[j]->px[i] *= (float)k;
	for (int i = 0; i < 9; i++)
		for (int c = 0; c < 3; c++) {
			env->sh[i][c] *= k;
			env->quadric[i][c] *= (float)k;
		}
	for (int i = 0; i < ENVMAP_WET; i++)
		for (int c = 0; c < 3; c++)
			env->wet[i][c] *= (float)k;
}

static struct image tinted(const struct image *from, const double k[3])
{
	struct image out = image_new(from->width, from->height, from->channels);
	for (long i = 0; i < (long)from->width * from->height; i++)
		for (int c = 0; c < from->channels; c++)
			out.px[i * from->channels + c] = from->px[i * from->channels + c] * (float)(c < 3 ? k[c] : 1);
	return out;
}

struct envmap envmap_tinted(const struct envmap *env, const double k[3])
{
	// a bend is a sum over the channels: no greater than the largest factor makes it
	const double most = fmax(k[0], fmax(k[1], k[2])), bend[3] = { most, most, most };
	struct envmap out = { tinted(&env->map, k), tinted(&env->sharp, k), tinted(&env->rough, k), tinted(&env->bend, bend), { { 0 } }, { { 0 } }, { { 0 } } };
	for (int i = 0; i < 9; i++)
		for (int c = 0; c < 3; c++) {
			out.sh[i][c] = env->sh[i][c] * k[c];
			out.quadric[i][c] = env->quadric[i][c] * (float)k[c];
		}
	for (int i = 0; i < ENVMAP_WET; i++)
		for (int c = 0; c < 3; c++)
			out.wet[i][c] = env->wet[i][c] * (float)k[c];
	return out;
}

void envmap_normalise(struct envmap *env)
{
	double level = envmap_level(env);
	envmap_scale(env, level > 0 ? 1 / level : 1);
}
