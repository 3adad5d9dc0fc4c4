/* Ridges linked into curves (Steger 1998), with control points on the skin. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "track/wrinkle/impl.h"

static const double seed = 1.5;     // a line contains a place of so many times the threshold
static const double step_mm = 1;    // between control points
static const double turn = 0.5;     // cosine of the sharpest turn from one place to the next

struct chain {
	int n, room;
	float (*at)[2], *half;
};

static void chain_add(struct chain *c, const struct wrinkle_ridges *r, long i)
{
	if (c->n == c->room) {
		c->room = c->room ? 2 * c->room : 64;
		c->at = mem_grow(c->at, (size_t)c->room, sizeof *c->at);
		c->half = mem_grow(c->half, (size_t)c->room, sizeof *c->half);
	}
	memcpy(c->at[c->n], r->at[i], sizeof *c->at);
	c->half[c->n++] = r->half[i];
}

/* True when no other line begins or runs within w of this place. */
static void claim(uint8_t *taken, const struct wrinkle_ridges *r, long i)
{
	int x = (int)(i % r->width), y = (int)(i / r->width), reach = (int)ceilf(1.5f * r->half[i]);
	for (int v = -reach; v <= reach; v++)
		for (int u = -reach; u <= reach; u++) {
			float side = fabsf((float)u * r->along[i][1] - (float)v * r->along[i][0]), on = fabsf((float)u * r->along[i][0] + (float)v * r->along[i][1]);
			if (side <= (float)reach && on <= 1 && x + u >= 0 && x + u < r->width && y + v >= 0 && y + v < r->height)
				taken[i + (long)v * r->width + u] = 1;
		}
}

/* The next place from i along dir, nearest to where the line points; -1: it ends. Gaps of two texels are bridged. */
static long next(const struct wrinkle_ridges *r, const uint8_t *taken, long i, const float dir[2], float least)
{
	int x = (int)(i % r->width), y = (int)(i / r->width);
	double best = INFINITY;
	long found = -1;
	for (int v = -3; v <= 3; v++)
		for (int u = -3; u <= 3; u++) {
			if (x + u < 0 || y + v < 0 || x + u >= r->width || y + v >= r->height)
				continue;
			long j = i + (long)v * r->width + u;
			if (!(r->trust[j] >= least) || taken[j])
				continue;
			double d[2] = { r->at[j][0] - r->at[i][0], r->at[j][1] - r->at[i][1] }, len = hypot(d[0], d[1]);
			double ahead = d[0] * dir[0] + d[1] * dir[1], same = fabs(r->along[j][0] * dir[0] + r->along[j][1] * dir[1]);
			if (!(ahead > 0.4) || ahead < 0.6 * len || same < turn)
				continue;
			double cost = len + 2 * (1 - ahead / len) + 2 * (1 - same);
			if (cost < best) {
				best = cost;
				found = j;
			}
		}
	return found;
}

/* Goes on from place i, the chain's last, as long as the next is `least` times the threshold. Returns the last place; dir: where the line points, in and out. */
static long walk(struct chain *c, const struct wrinkle_ridges *r, uint8_t *taken, long i, float dir[2], float least)
{
	for (long j; (j = next(r, taken, i, dir, least)) >= 0; i = j) {
		float s = r->along[j][0] * dir[0] + r->along[j][1] * dir[1] < 0 ? -1 : 1;
		claim(taken, r, i);
		for (int k = 0; k < 2; k++)
			dir[k] = s * r->along[j][k];
		chain_add(c, r, j);
	}
	claim(taken, r, i);
	return i;
}

static void reverse(struct chain *c)
{
	for (int a = 0, b = c->n - 1; a < b; a++, b--) {
		float at[2] = { c->at[a][0], c->at[a][1] }, half = c->half[a];
		memcpy(c->at[a], c->at[b], sizeof at);
		memcpy(c->at[b], at, sizeof at);
		c->half[a] = c->half[b];
		c->half[b] = half;
	}
}

bool wrinkle_on_surface(struct wrinkle_point *p, double normal[3], const struct wrinkle_ground *g, const double px[2])
{
	double ray[3], zero[3] = { 0 }, from[3], to[3];
	camera_ray(ray, g->camera, px);
	for (int j = 0; j < 3; j++) {
		from[j] = to[j] = 0;
		for (int i = 0; i < 3; i++) {
			from[j] += g->cam_from_head[i][j] * (zero[i] - g->cam_from_head[i][3]);
			to[j] += g->cam_from_head[i][j] * ray[i];
		}
		normal[j] = 0;
	}
	vec_unit(to, to);
	const float o[3] = { (float)from[0], (float)from[1], (float)from[2] }, d[3] = { (float)to[0], (float)to[1], (float)to[2] };
	struct ray_hit hit = ray_first(g->rays, o, d, 0, 1e5f);
	if (hit.face < 0)
		return false;
	const int32_t *v = g->mesh->faces[hit.face];
	p->face = hit.face;
	p->bary[0] = hit.u;
	p->bary[1] = hit.v;
	for (int k = 0; k < 3; k++) {
		p->mm[k] = from[k] + (double)hit.t * to[k];
		normal[k] = (1 - hit.u - hit.v) * g->normals[v[0]][k] + hit.u * g->normals[v[1]][k] + hit.v * g->normals[v[2]][k];
	}
	vec_unit(normal, normal);
	return vec_dot(normal, to) < -0.1;
}

/* Where the chart's direction `side` lies on the skin, and how long a millimetre of it is seen. */
static bool set_across(struct wrinkle_point *p, const double normal[3], const struct wrinkle_ground *g, const double side[2])
{
	double cam[3], ray[3], next[2] = { p->px[0] + side[0], p->px[1] + side[1] }, n[3], at[3];
	for (int i = 0; i < 3; i++) {
		n[i] = vec_dot(g->cam_from_head[i], normal);
		at[i] = vec_dot(g->cam_from_head[i], p->mm) + g->cam_from_head[i][3];
	}
	camera_ray(ray, g->camera, next);
	double t = vec_dot(n, at) / vec_dot(n, ray);
	for (int i = 0; i < 3; i++)
		cam[i] = t * ray[i] - at[i];
	double mm = vec_norm(cam);
	for (int j = 0; j < 3; j++) {
		p->across[j] = 0;
		for (int i = 0; i < 3; i++)
			p->across[j] += g->cam_from_head[i][j] * cam[i] / mm;
	}
	for (int k = 0; k < 2; k++)
		p->across_px[k] = side[k] / mm;
	return mm > 0 && isfinite(mm);
}

/* Mean place and width over a mm on each side, to reduce noise. */
static void smooth(double px[2], double *half, const struct chain *c, double i, double reach)
{
	double sum = 0;
	px[0] = px[1] = *half = 0;
	reach = fmin(reach, fmin(i, c->n - 1 - i) + 0.5);
	for (int j = (int)fmax(0, ceil(i - reach)); j <= i + reach && j < c->n; j++) {
		for (int k = 0; k < 2; k++)
			px[k] += c->at[j][k];
		*half += c->half[j];
		sum++;
	}
	for (int k = 0; k < 2; k++)
		px[k] /= sum;
	*half /= sum;
}

/* Control points step_mm apart. False where too little of it lies on the mesh, or it is too short. */
static bool line_of(struct wrinkle_line *line, const struct chain *c, const struct wrinkle_ground *g, const struct wrinkle_conf *conf)
{
	double length = 0, step = step_mm * g->px_per_mm, done = 0;
	for (int i = 1; i < c->n; i++)
		length += hypot((double)(c->at[i][0] - c->at[i - 1][0]), (double)(c->at[i][1] - c->at[i - 1][1]));
	int n = (int)fmax(2, floor(length / step) + 1);
	*line = (struct wrinkle_line){ .point = mem_new((size_t)n, sizeof *line->point) };
	for (int k = 0, i = 0; k < n; k++) {
		double want = length * k / (n - 1), px[2], before[2], after[2], half, other, normal[3], seg = 0;
		for (; i < c->n - 2; i++) {
			seg = hypot((double)(c->at[i + 1][0] - c->at[i][0]), (double)(c->at[i + 1][1] - c->at[i][1]));
			if (done + seg >= want)
				break;
			done += seg;
		}
		double at = fmin(i + (seg > 0 ? (want - done) / seg : 0), c->n - 1), reach = fmin(step, c->n / 4.0);
		smooth(px, &half, c, at, reach);
		smooth(before, &other, c, fmax(0, at - reach), reach);
		smooth(after, &other, c, fmin(c->n - 1, at + reach), reach);
		double along[2] = { after[0] - before[0], after[1] - before[1] }, len = hypot(along[0], along[1]);
		struct wrinkle_point *p = &line->point[line->n];
		*p = (struct wrinkle_point){ .px = { px[0] + g->x0, px[1] + g->y0 }, .width = half / g->px_per_mm };
		if (!(len > 0) || !wrinkle_on_surface(p, normal, g, p->px) || !set_across(p, normal, g, (double[]){ -along[1] / len, along[0] / len }))
			continue;
		double d[3] = { 0 };
		if (line->n)
			vec_add(d, p->mm, -1, p[-1].mm);
		line->length += vec_norm(d);
		line->n++;
	}
	return line->length >= conf->length_mm;
}

struct start {
	float trust;
	long at;
};

static int by_trust(const void *a, const void *b)
{
	const struct start *p = a, *q = b;
	return p->trust != q->trust ? (p->trust < q->trust) - (p->trust > q->trust) : (p->at > q->at) - (p->at < q->at);
}

int wrinkle_link(struct wrinkle_line **lines, const struct wrinkle_ridges *r, double least, const struct wrinkle_ground *g, const struct wrinkle_conf *conf)
{
	long area = (long)r->width * r->height, n_starts = 0;
	int n = 0;
	struct start *start = mem_new((size_t)area + 1, sizeof *start);
	uint8_t *taken = mem_new((size_t)area, 1);
	struct chain c = { 0 };
	for (long i = 0; i < area; i++)
		if (r->trust[i] >= (float)seed)
			start[n_starts++] = (struct start){ r->trust[i], i };
	qsort(start, (size_t)n_starts, sizeof *start, by_trust);
	*lines = 0;
	for (long k = 0; k < n_starts; k++) {
		long i = start[k].at;
		if (taken[i])
			continue;
		c.n = 0;
		chain_add(&c, r, i);
		float ahead[2] = { r->along[i][0], r->along[i][1] }, back[2] = { -ahead[0], -ahead[1] };
		const long last = walk(&c, r, taken, i, ahead, 1);
		reverse(&c);
		const long first = walk(&c, r, taken, i, back, 1);
		struct wrinkle_line line;
		if (c.n < 4)
			continue;
		bool found = line_of(&line, &c, g, conf);
		if (found && least < 1) {
			free(line.point);
			walk(&c, r, taken, first, back, (float)least);
			reverse(&c);
			walk(&c, r, taken, last, ahead, (float)least);
			found = line_of(&line, &c, g, conf);
		}
		if (found) {
			*lines = mem_grow(*lines, (size_t)n + 1, sizeof **lines);
			(*lines)[n++] = line;
		} else {
			free(line.point);
		}
	}
	free(start);
	free(taken);
	free(c.at);
	free(c.half);
	return n;
}
