#include "rig/skull_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "math/natural.h"

enum { FRAME = 24, WITH = 6 };  // sites added around the map; numbers of a site

struct sites {
	int n;
	double (*at)[2];
	double (*value)[WITH];
};

/* Least-squares fit value = a + b x + c y of every number, x and y relative to the sites' mean. */
struct affine {
	double mean[2], a[WITH], b[WITH], c[WITH];
};

static struct affine affine_fit(const struct sites *s)
{
	struct affine f = { 0 };
	double xx = 0, xy = 0, yy = 0, bx[WITH] = { 0 }, by[WITH] = { 0 };
	for (int i = 0; i < s->n; i++) {
		for (int k = 0; k < 2; k++)
			f.mean[k] += s->at[i][k] / s->n;
		for (int k = 0; k < WITH; k++)
			f.a[k] += s->value[i][k] / s->n;
	}
	for (int i = 0; i < s->n; i++) {
		double x = s->at[i][0] - f.mean[0], y = s->at[i][1] - f.mean[1];
		xx += x * x;
		xy += x * y;
		yy += y * y;
		for (int k = 0; k < WITH; k++) {
			bx[k] += x * (s->value[i][k] - f.a[k]);
			by[k] += y * (s->value[i][k] - f.a[k]);
		}
	}
	double det = xx * yy - xy * xy;
	for (int k = 0; k < WITH && det > 0; k++) {
		f.b[k] = (yy * bx[k] - xy * by[k]) / det;
		f.c[k] = (xx * by[k] - xy * bx[k]) / det;
	}
	return f;
}

/* Adds a site with the value of the nearest of the first n, extrapolated by the affine map's slope. */
static void frame_site(struct sites *s, int n, const struct affine *f, double x, double y)
{
	int best = 0;
	double least = INFINITY;
	for (int i = 0; i < n; i++) {
		double d = hypot(s->at[i][0] - x, s->at[i][1] - y);
		if (d < least) {
			least = d;
			best = i;
		}
	}
	s->at[s->n][0] = x;
	s->at[s->n][1] = y;
	for (int k = 0; k < WITH; k++)
		s->value[s->n][k] = s->value[best][k] + f->b[k] * (x - s->at[best][0]) + f->c[k] * (y - s->at[best][1]);
	s->n++;
}

static struct sites sites_make(int n, const double (*site)[2], const float (*position)[3], const float (*normal)[3],
                               const double box[4])
{
	struct sites s = { .n = n };
	s.at = mem_new((size_t)n + FRAME, sizeof *s.at);
	s.value = mem_new((size_t)n + FRAME, sizeof *s.value);
	double lo[2] = { box[0], box[1] }, hi[2] = { box[2], box[3] };
	for (int i = 0; i < n; i++)
		for (int k = 0; k < 3; k++) {
			if (k < 2) {
				s.at[i][k] = site[i][k];
				lo[k] = fmin(lo[k], site[i][k]);
				hi[k] = fmax(hi[k], site[i][k]);
			}
			s.value[i][k] = position[i][k];
			s.value[i][k + 3] = normal[i][k];
		}
	if (n < 3)
		return s;
	struct affine f = affine_fit(&s);
	double w = hi[0] - lo[0], h = hi[1] - lo[1];
	for (int i = 0; i < FRAME / 4; i++) {
		double t = (i + 0.5) / (FRAME / 4) * 1.4 - 0.2;
		frame_site(&s, n, &f, lo[0] + t * w, lo[1] - 0.2 * h);
		frame_site(&s, n, &f, lo[0] + t * w, hi[1] + 0.2 * h);
		frame_site(&s, n, &f, lo[0] - 0.2 * w, lo[1] + t * h);
		frame_site(&s, n, &f, hi[0] + 0.2 * w, lo[1] + t * h);
	}
	return s;
}

static void row_make(struct skull_map *map, const struct natural *natural, const struct sites *s, int y)
{
	int id[NATURAL_MAX], hint = 0;
	double weight[NATURAL_MAX];
	for (int x = 0; x < map->width; x++) {
		double at[2] = { map->x0 + x * map->step, map->y0 + y * map->step }, sum[WITH] = { 0 };
		int n = natural_weights(id, weight, natural, at, &hint);
		float *texel = map->texel + ((long)y * map->width + x) * SKULL_CHANNELS;
		for (int i = 0; i < n; i++)
			for (int k = 0; k < WITH; k++)
				sum[k] += weight[i] * s->value[id[i]][k];
		if (!n && x)  // on the hull's edge, by rounding outside
			memcpy(texel, texel - SKULL_CHANNELS, SKULL_CHANNELS * sizeof *texel);
		for (int k = 0; n && k < WITH; k++)
			texel[k] = (float)sum[k];
	}
}

bool skull_map_make(struct skull_map *map, int n, const double (*site)[2], const float (*position)[3], const float (*normal)[3],
                    const double box[4], double step, struct err *err)
{
	struct sites s = sites_make(n, site, position, normal, box);
	struct natural *natural = natural_new(s.n, (const double(*)[2])s.at, err);
	*map = (struct skull_map){ .x0 = box[0], .y0 = box[1], .step = step };
	map->width = (int)ceil((box[2] - box[0]) / step) + 1;
	map->height = (int)ceil((box[3] - box[1]) / step) + 1;
	if (natural) {
		size_t size = (size_t)map->width * (size_t)map->height * SKULL_CHANNELS;
		map->texel = mem_array(size, sizeof *map->texel);
		memset(map->texel, 0, size * sizeof *map->texel);
#pragma omp parallel for schedule(dynamic, 8)
		for (int y = 0; y < map->height; y++)
			row_make(map, natural, &s, y);
	}
	natural_free(natural);
	free(s.at);
	free(s.value);
	return natural || err_wrap(err, "skull map");
}

void skull_map_smooth(struct skull_map *map, double px)
{
	const long n = px < map->step ? 0 : (long)map->width * map->height;
	float *of = mem_array((size_t)n + 1, sizeof *of);
	for (int k = 0; k < WITH && n; k++) {
		for (long i = 0; i < n; i++)
			of[i] = map->texel[i * SKULL_CHANNELS + k];
		plane_blur(of, map->width, map->height, px / map->step);
		for (long i = 0; i < n; i++)
			map->texel[i * SKULL_CHANNELS + k] = of[i];
	}
	free(of);
}

void skull_map_free(struct skull_map *map)
{
	free(map->texel);
	*map = (struct skull_map){ 0 };
}

void skull_map_at(float position[3], float normal[3], const struct skull_map *map, const float px[2])
{
	float u = (px[0] - (float)map->x0) / (float)map->step, v = (px[1] - (float)map->y0) / (float)map->step;
	u = fminf(fmaxf(u, 0), (float)map->width - 1.001f);
	v = fminf(fmaxf(v, 0), (float)map->height - 1.001f);
	int iu = (int)u, iv = (int)v;
	const float *p = map->texel + ((long)iv * map->width + iu) * SKULL_CHANNELS, *q = p + (long)map->width * SKULL_CHANNELS;
	u -= (float)iu;
	v -= (float)iv;
	for (int k = 0; k < 6; k++) {
		float top = p[k] + u * (p[k + SKULL_CHANNELS] - p[k]), bottom = q[k] + u * (q[k + SKULL_CHANNELS] - q[k]);
		*(k < 3 ? &position[k] : &normal[k - 3]) = top + v * (bottom - top);
	}
}

static struct image channels(const struct skull_map *map, int first)
{
	struct image image = image_new(map->width, map->height, 3);
	for (long i = 0; i < (long)map->width * map->height; i++)
		memcpy(image.px + 3 * i, map->texel + i * SKULL_CHANNELS + first, 3 * sizeof(float));
	return image;
}

struct image skull_map_positions(const struct skull_map *map)
{
	return channels(map, 0);
}

struct image skull_map_normals(const struct skull_map *map)
{
	return channels(map, 3);
}
