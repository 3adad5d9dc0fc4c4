/* The skin paper's three samplers of the screen-space distance field, as printed: what distance_band is compared with. */
#include "tests/peers/distance_samplers.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static bool is_skin(const struct distance_scene *s, const double u[2])
{
	int x = (int)floor(u[0]), y = (int)floor(u[1]);
	return x >= 0 && y >= 0 && x < s->width && y < s->height && s->material[(size_t)y * (size_t)s->width + (size_t)x] == DISTANCE_SKIN;
}

static double depth_at(const struct distance_scene *s, const double u[2])
{
	return s->depth ? s->depth[(size_t)floor(u[1]) * (size_t)s->width + (size_t)floor(u[0])] : 1;
}

/* Eq. 4.3: the surface drawn at u, in the world. A flat scene's world is its pixels. */
static void surface(double p[3], const struct distance_scene *s, const double u[2])
{
	double z = depth_at(s, u), scale = s->depth ? z / s->focal_px : 1;
	p[0] = (u[0] - (s->depth ? s->center_px[0] : 0)) * scale;
	p[1] = (u[1] - (s->depth ? s->center_px[1] : 0)) * scale;
	p[2] = z;
}

static double between(const struct distance_scene *s, const double u[2], const double v[2])
{
	double a[3], b[3];
	surface(a, s, u);
	surface(b, s, v);
	return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Pixels of one unit in the plane through a texel's surface, parallel to the screen (the paper's Psi). */
static double px_per_unit(const struct distance_scene *s, const double u[2])
{
	return s->depth ? s->focal_px / depth_at(s, u) : 1;
}

/* The paper asks for a number that looks random on the screen: [0, 1) from a texel, a draw and a seed. */
static double noise(int x, int y, int draw, unsigned seed)
{
	uint32_t h = (uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u ^ (uint32_t)draw * 0xc2b2ae3du ^ seed * 0x27d4eb2fu;
	h ^= h >> 15;
	h *= 0x2c1b3c6du;
	h ^= h >> 12;
	h *= 0x297a2d39u;
	h ^= h >> 15;
	return h * 0x1p-32;
}

struct method {
	const struct distance_scene *scene;
	double reach;
	int n;
	struct distance_line line;
	const float *first;  // the first pass of two; null in it
	/* Distance of the texel centred at u, at most `reach` or INFINITY; adds what it reads. */
	double (*texel)(const struct method *m, const double u[2], double *reads);
};

static double equiangular(const struct method *m, const double u[2], double *reads)
{
	const struct distance_scene *s = m->scene;
	int x = (int)u[0], y = (int)u[1];
	double best = INFINITY, px = px_per_unit(s, u), turn = noise(x, y, 0, m->line.seed);
	for (int i = 0; i < m->n; i++) {
		double t = 2 * M_PI * (i + turn) / m->n, far = m->reach * (1 - noise(x, y, 1 + i, m->line.seed)) * px;
		double v[2] = { u[0] + far * cos(t), u[1] + far * sin(t) };
		++*reads;
		if (!is_skin(s, v))
			continue;
		*reads += s->depth != 0;
		best = fmin(best, between(s, u, v));
	}
	return best;
}

static double backtracking(const struct method *m, const double u[2], double *reads)
{
	const struct distance_scene *s = m->scene;
	double best = INFINITY, px = px_per_unit(s, u);
	double turn = m->line.turned ? noise((int)u[0], (int)u[1], 0, m->line.seed) : 0;
	for (int i = 0; i < m->n; i++) {
		double t = 2 * M_PI * (i + turn) / m->n, d[2] = { cos(t) * px, sin(t) * px };
		double near = 0, far = m->reach, v[2] = { u[0] + far * d[0], u[1] + far * d[1] };
		++*reads;
		if (!is_skin(s, v))
			continue;
		for (int k = 1; k < m->line.steps; k++) {
			double middle = (near + far) / 2, w[2] = { u[0] + middle * d[0], u[1] + middle * d[1] };
			++*reads;
			*(is_skin(s, w) ? &far : &near) = middle;
		}
		v[0] = u[0] + far * d[0];
		v[1] = u[1] + far * d[1];
		*reads += s->depth != 0;
		best = fmin(best, between(s, u, v));
	}
	return best;
}

/* A sample of the second pass counts as found where the first pass found skin in its column. */
static double found(const struct method *m, const double u[2], const double v[2], double *reads)
{
	const struct distance_scene *s = m->scene;
	if (v[0] < 0 || v[1] < 0 || v[0] >= s->width || v[1] >= s->height)
		return INFINITY;
	*reads += 1 + (s->depth != 0);
	if (!m->first || is_skin(s, v))
		return is_skin(s, v) ? between(s, u, v) : INFINITY;
	double before = m->first[(size_t)v[1] * (size_t)s->width + (size_t)v[0]];
	return hypot(between(s, u, v), before);
}

/* Eqs. 4.8 to 4.12: growing steps until skin is found (or, over a first pass, until it gets worse), then shrinking
 * ones that turn round whenever what they look for comes or goes. */
static double one_way(const struct method *m, const double u[2], const double dir[2], double *reads)
{
	double step = m->line.first, at = 0, best = INFINITY, last = m->first ? found(m, u, u, reads) : INFINITY, px = px_per_unit(m->scene, u);
	int way = 1;
	bool shrinking = false;
	for (int k = 0; k < m->line.steps; k++) {
		at += way * step;
		if (at > m->reach || at <= 0) {
			way = -way;
			shrinking = true;
			step /= m->line.growth;
			continue;
		}
		double v[2] = { u[0] + at * dir[0] * px, u[1] + at * dir[1] * px }, d = found(m, u, v, reads);
		best = fmin(best, d);
		bool inside = m->first ? d > last : isfinite(d);
		if (!shrinking && inside)
			shrinking = true;
		if (shrinking)
			way = inside ? (m->first ? -way : -1) : (m->first ? way : 1);
		step = shrinking ? step / m->line.growth : step * m->line.growth;
		last = d;
	}
	return best;
}

static double exponential(const struct method *m, const double u[2], double *reads)
{
	double t = m->line.turned ? (noise((int)u[0], (int)u[1], 0, m->line.seed) - 0.5) * M_PI / 2 : 0;
	t += m->first ? 0 : M_PI / 2;
	double dir[2][2] = { { cos(t), sin(t) }, { -cos(t), -sin(t) } }, best = m->first ? found(m, u, u, reads) : INFINITY;
	for (int i = 0; i < 2; i++)
		best = fmin(best, one_way(m, u, dir[i], reads));
	return best;
}

/* Asks the method about every texel of the globe. */
static void every_texel(float *out, const struct method *m, struct distance_cost *cost)
{
	const struct distance_scene *s = m->scene;
	double reads = 0, texels = 0;
#pragma omp parallel for schedule(dynamic, 8) reduction(+ : reads, texels)
	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++) {
			size_t i = (size_t)y * (size_t)s->width + (size_t)x;
			if (s->material[i] != DISTANCE_GLOBE)
				continue;
			double d = m->texel(m, (double[2]){ x + 0.5, y + 0.5 }, &reads);
			texels++;
			out[i] = d <= m->reach ? (float)d : INFINITY;
		}
	if (cost) {
		cost->texels = texels;
		cost->reads += reads;
	}
}

void distance_equiangular(float *out, const struct distance_scene *scene, double reach, int n, unsigned seed,
                          struct distance_cost *cost)
{
	struct method m = { .scene = scene, .reach = reach, .n = n, .line.seed = seed, .texel = equiangular };
	if (cost)
		cost->reads = 0;
	every_texel(out, &m, cost);
}

void distance_backtracking(float *out, const struct distance_scene *scene, double reach, int n,
                           const struct distance_line *line, struct distance_cost *cost)
{
	struct method m = { .scene = scene, .reach = reach, .n = n, .line = *line, .texel = backtracking };
	if (cost)
		cost->reads = 0;
	every_texel(out, &m, cost);
}

void distance_exponential(float *out, const struct distance_scene *scene, double reach, const struct distance_line *line,
                          struct distance_cost *cost)
{
	struct method m = { .scene = scene, .reach = reach, .line = *line, .texel = exponential };
	float *first = mem_array((size_t)scene->width * (size_t)scene->height, sizeof *first);
	if (cost)
		cost->reads = 0;
	every_texel(first, &m, cost);
	m.first = first;
	every_texel(out, &m, cost);
	free(first);
}
