#include "iris/iris_map.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath/lightpath.h"

struct iris_view iris_view_new(const struct fit *fit, const struct eye *eye)
{
	struct iris_view view = { fit, eye_cornea(eye), eye->iris_depth, { { 1, 0, 0 }, { 0, 1, 0 } } };
	view.cornea.rim = 1e3;
	return view;
}

bool iris_see(double P[2], double *rim, const struct iris_view *view, const double px[2])
{
	double origin[3], dir[3], K[3], from[3], inside[3];
	fit_ray(origin, dir, view->fit, px);
	if (!cornea_sight(K, from, inside, &view->cornea, origin, dir) || !(inside[2] > 0))
		return false;
	double t = (view->depth - from[2]) / inside[2];
	P[0] = from[0] + t * inside[0];
	P[1] = from[1] + t * inside[1];
	if (rim)
		*rim = hypot(K[0], K[1]);
	// the posterior surface of a two-surface cornea reaches behind the iris root: its paths are followed backwards
	return t > (view->cornea.two_surface ? -1 : 0);
}

/* With two surfaces there is no single point K: Newton's method on iris_see, from the single-surface pixel. */
static bool find_two_surface(double px[2], double *rim, const struct iris_view *view, const double P[2])
{
	const double h = 0.25;  // px; the map is smooth over many
	double size = INFINITY;
	for (int i = 0; i < 12 && size > 1e-9; i++) {
		double f[2], fu[2], fv[2], u[2] = { px[0] + h, px[1] }, v[2] = { px[0], px[1] + h };
		if (!iris_see(f, rim, view, px) || !iris_see(fu, 0, view, u) || !iris_see(fv, 0, view, v))
			return false;
		double a = (fu[0] - f[0]) / h, b = (fv[0] - f[0]) / h, c = (fu[1] - f[1]) / h, d = (fv[1] - f[1]) / h;
		double det = a * d - b * c, rx = P[0] - f[0], ry = P[1] - f[1];
		px[0] += (d * rx - b * ry) / det;
		px[1] += (a * ry - c * rx) / det;
		size = hypot(rx, ry);
	}
	return size < 1e-6;
}

static bool find(double px[2], double *rim, const struct iris_view *view, const double P[2],
                 const struct algorithm1_conf *paper)
{
	double C[3], K[3], point[3] = { P[0], P[1], view->depth };
	fit_camera_in_eye(C, view->fit);
	enum lightpath_status status = paper ? lightpath_algorithm1(K, &view->cornea, point, C, paper)
	                                     : lightpath_solve(K, &view->cornea, point, C);
	if (status == LIGHTPATH_NONE || status == LIGHTPATH_GRAZING || !fit_project(px, view->fit, K))
		return false;
	if (rim)
		*rim = hypot(K[0], K[1]);
	return paper || !view->cornea.two_surface || find_two_surface(px, rim, view, P);
}

bool iris_find(double px[2], double *rim, const struct iris_view *view, const double P[2])
{
	return find(px, rim, view, P, 0);
}

/* u, v and rim of the map's point (x, y); NAN where no path leads. */
static void find_texel(float out[3], const struct iris_view *view, double x, double y,
                       const struct algorithm1_conf *paper)
{
	double P[2], px[2], rim;
	for (int i = 0; i < 2; i++)
		P[i] = view->a[i][0] * x + view->a[i][1] * y + view->a[i][2];
	bool ok = find(px, &rim, view, P, paper);
	out[0] = ok ? (float)px[0] : NAN;
	out[1] = ok ? (float)px[1] : NAN;
	out[2] = ok ? (float)rim : NAN;
}

static void map_texels(struct iris_map *map, const struct iris_view *view, double radius,
                       const struct algorithm1_conf *paper)
{
	int size = map->size;
	double mm = 2 * map->extent / size;
#pragma omp parallel for schedule(dynamic, 4)
	for (int row = 0; row < size; row++)
		for (int col = 0; col < size; col++) {
			double x = (col + 0.5) * mm - map->extent, y = (row + 0.5) * mm - map->extent;
			float f[3] = { NAN, NAN, NAN };
			if (x * x + y * y <= radius * radius)
				find_texel(f, view, x, y, paper);
			long i = (long)row * size + col;
			map->u[i] = f[0], map->v[i] = f[1], map->rim[i] = f[2];
		}
}

/* Catmull-Rom weights of four nodes at -1, 0, 1, 2 for t in 0..1. */
static void cubic(float w[4], double t)
{
	w[0] = (float)(t * (-0.5 + t * (1 - 0.5 * t)));
	w[1] = (float)(1 + t * t * (-2.5 + 1.5 * t));
	w[2] = (float)(t * (0.5 + t * (2 - 1.5 * t)));
	w[3] = (float)(t * t * (-0.5 + 0.5 * t));
}

/* Quadratic extrapolation to a node without a path, from the three nodes beyond it in direction (di, dj); NAN where they
 * lack one too. */
static float extrapolate(const float *f, int n, int i, int j, int di, int dj)
{
	int far_i = i + 3 * di, far_j = j + 3 * dj;
	if (far_i < 0 || far_i >= n || far_j < 0 || far_j >= n)
		return NAN;
	const float *p = f + (long)i * n + j;
	long step = (long)di * n + dj;
	return 3 * p[step] - 3 * p[2 * step] + p[3 * step];
}

/* Interpolation next to the last path that leads out needs nodes beyond it: extrapolates them smoothly, two nodes deep. */
static void extend_lattice(float *f, int n)
{
	float *next = mem_array((size_t)n * (size_t)n, sizeof *next);
	for (int pass = 0; pass < 2; pass++) {
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++) {
				float sum = 0;
				int count = 0;
				next[i * n + j] = f[i * n + j];
				for (int k = 0; k < 9 && !isfinite(f[i * n + j]); k++) {
					float v = k == 4 ? NAN : extrapolate(f, n, i, j, k / 3 - 1, k % 3 - 1);
					if (isfinite(v))
						sum += v, count++;
				}
				if (count)
					next[i * n + j] = sum / (float)count;
			}
		for (long i = 0; i < (long)n * n; i++)
			f[i] = next[i];
	}
	free(next);
}

/* n nodes a side; node i is at texel coordinate (i - 1) step, so that each texel has four around it. */
static float *lattice_new(const struct iris_view *view, int n, int step, int size, double extent, double radius)
{
	float *nodes = mem_array((size_t)n * n * 3, sizeof *nodes);
	double mm = 2 * extent / size, reach = radius + 3 * step * mm;
#pragma omp parallel for schedule(dynamic, 2)
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			double x = (j - 1) * step * mm - extent, y = (i - 1) * step * mm - extent;
			float f[3] = { NAN, NAN, NAN };
			if (x * x + y * y < reach * reach)
				find_texel(f, view, x, y, 0);
			for (int c = 0; c < 3; c++)
				nodes[((long)c * n + i) * n + j] = f[c];
		}
	for (int c = 0; c < 3; c++)
		extend_lattice(nodes + (long)c * n * n, n);
	return nodes;
}

/* One row of one channel: `line` holds the lattice interpolated to this row, w the weights within a cell. */
static void lattice_row(float *restrict out, const float *restrict line, int size, int step, const float (*w)[4])
{
	for (int cell = 0; cell * step < size + step; cell++) {
		const float *restrict f = line + cell;
		for (int k = 0; k < step; k++) {
			// texel centres sit half a texel past the node
			int col = cell * step + k;
			if (col >= size)
				return;
			out[col] = w[k][0] * f[0] + w[k][1] * f[1] + w[k][2] * f[2] + w[k][3] * f[3];
		}
	}
}

static void map_lattice(struct iris_map *map, const struct iris_view *view, double radius, int step)
{
	int size = map->size, n = size / step + 4;
	float *nodes = lattice_new(view, n, step, size, map->extent, radius);
	float(*w)[4] = mem_array((size_t)step, sizeof *w);
	for (int k = 0; k < step; k++)
		cubic(w[k], (k + 0.5) / step);
	double mm = 2 * map->extent / size;
#pragma omp parallel
	{
		float *line = mem_array((size_t)n, sizeof *line);
#pragma omp for schedule(static)
		for (int row = 0; row < size; row++) {
			float *out[3] = { map->u, map->v, map->rim };
			const float *wy = w[row % step];
			for (int c = 0; c < 3; c++) {
				const float *f = nodes + ((long)c * n + row / step) * n;
				for (int j = 0; j < n; j++)
					line[j] = wy[0] * f[j] + wy[1] * f[j + n] + wy[2] * f[j + 2 * n] + wy[3] * f[j + 3 * n];
				lattice_row(out[c] + (long)row * size, line, size, step, w);
			}
			double y = (row + 0.5) * mm - map->extent;
			for (int col = 0; col < size; col++) {
				double x = (col + 0.5) * mm - map->extent;
				if (x * x + y * y > radius * radius)
					map->u[(long)row * size + col] = map->v[(long)row * size + col] = NAN;
			}
		}
		free(line);
	}
	free(w);
	free(nodes);
}

struct iris_map iris_map_new(const struct iris_view *view, int size, double extent, double radius,
                             const struct iris_map_conf *conf)
{
	size_t n = (size_t)size * (size_t)size;
	struct iris_map map = { size, extent, mem_array(n, sizeof(float)), mem_array(n, sizeof(float)),
	                        mem_array(n, sizeof(float)) };
	struct algorithm1_conf paper = { conf->alpha, conf->eps_inner, conf->eps_outer, conf->max_inner, conf->max_outer };
	if (conf->method == IRIS_LATTICE)
		map_lattice(&map, view, radius, conf->node);
	else
		map_texels(&map, view, radius, conf->method == IRIS_ALGORITHM1 ? &paper : 0);
	return map;
}

void iris_map_free(struct iris_map *map)
{
	free(map->u);
	free(map->v);
	free(map->rim);
	*map = (struct iris_map){ 0 };
}

struct image iris_map_forward(const struct iris_view *view, double radius, double rim)
{
	struct image map = image_new(view->fit->width, view->fit->height, 2);
	const double(*a)[3] = view->a;
	double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
#pragma omp parallel for schedule(dynamic, 8)
	for (int row = 0; row < map.height; row++)
		for (int col = 0; col < map.width; col++) {
			float *out = image_at(&map, col, row);
			double px[2] = { col + 0.5, row + 0.5 }, P[2], r;
			out[0] = out[1] = NAN;
			if (!iris_see(P, &r, view, px) || r > rim)
				continue;
			double dx = P[0] - a[0][2], dy = P[1] - a[1][2];
			double x = (a[1][1] * dx - a[0][1] * dy) / det, y = (a[0][0] * dy - a[1][0] * dx) / det;
			if (x * x + y * y > radius * radius)
				continue;
			out[0] = (float)x;
			out[1] = (float)y;
		}
	return map;
}

double iris_view_px_per_mm(const struct iris_view *view)
{
	const double h = 0.5, at[3][2] = { { 0, 0 }, { h, 0 }, { 0, h } };
	double px[3][2];
	for (int i = 0; i < 3; i++)
		if (!iris_find(px[i], 0, view, at[i]))
			return NAN;
	double a = (px[1][0] - px[0][0]) / h, b = (px[2][0] - px[0][0]) / h;
	double c = (px[1][1] - px[0][1]) / h, d = (px[2][1] - px[0][1]) / h;
	return sqrt(fabs(a * d - b * c));
}
