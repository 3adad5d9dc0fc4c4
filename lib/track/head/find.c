/* The openings' outlines, in a range of sizes and rolls, slid over a reduced picture. */
#include "track/head/find.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"

static const double pair = 1.5;  // factor of the score of two eyes over one

enum { SMALL = 160, SIZES = 16, ROLLS = 5, ROWS = 128, CHANNELS = 4 };

/* Prefix sums along rows of the small picture: share of red, its square, brightness, its square. */
struct small {
	int width, height;
	double factor;          // px of the picture a small pixel
	double *sum;            // [height][width + 1][CHANNELS]
};

/* Columns from x0[y] to x1[y] (not included) of each row y0 + y, about the template's origin. */
struct spans {
	int y0, rows;
	int x0[ROWS], x1[ROWS];
};

struct shape {
	bool open;
	struct spans in, out;   // the opening; it and the skin round it
	double at[2];           // its centre from the origin, small px
};

static struct small shrink(const uint8_t *rgb, int width, int height)
{
	struct small s = { .width = width < SMALL ? width : SMALL };
	s.factor = (double)width / s.width;
	s.height = (int)(height / s.factor);
	s.height = s.height < 1 ? 1 : s.height;
	s.sum = mem_new((size_t)s.height * (size_t)(s.width + 1) * CHANNELS, sizeof *s.sum);
	for (int y = 0; y < s.height; y++)
		for (int x = 0; x < s.width; x++) {
			int xa = (int)(x * s.factor), xb = (int)((x + 1) * s.factor), ya = (int)(y * s.factor), yb = (int)((y + 1) * s.factor);
			double c[3] = { 0 }, n = 0;
			for (int v = ya; v < (yb > ya ? yb : ya + 1) && v < height; v++)
				for (int u = xa; u < (xb > xa ? xb : xa + 1) && u < width; u++, n++)
					for (int k = 0; k < 3; k++)
						c[k] += rgb[3 * ((long)v * width + u) + k];
			double all = (c[0] + c[1] + c[2]) / fmax(n, 1), red = c[0] / fmax(n, 1) / (all + 30), grey = log(all / 3 + 10);
			double *to = s.sum + ((long)y * (s.width + 1) + x + 1) * CHANNELS;
			const double add[CHANNELS] = { red, red * red, grey, grey * grey };
			for (int k = 0; k < CHANNELS; k++)
				to[k] = to[k - CHANNELS] + add[k];
		}
	return s;
}

/* Rows of a closed outline, grown by a factor about its centre. */
static void rasterise(struct spans *s, int n, double (*xy)[2], const double center[2], double grow)
{
	double top = INFINITY, low = -INFINITY;
	for (int i = 0; i < n; i++) {
		double y = center[1] + grow * (xy[i][1] - center[1]);
		top = fmin(top, y);
		low = fmax(low, y);
	}
	s->y0 = (int)floor(top);
	s->rows = (int)fmin(ROWS, floor(low) - s->y0 + 1);
	for (int r = 0; r < s->rows; r++) {
		double y = s->y0 + r + 0.5, left = INFINITY, right = -INFINITY;
		for (int i = 0; i < n; i++) {
			const double *p = xy[i], *q = xy[(i + 1) % n];
			double a = center[1] + grow * (p[1] - center[1]), b = center[1] + grow * (q[1] - center[1]);
			if ((a > y) == (b > y))
				continue;
			double x = center[0] + grow * (p[0] + (y - a) / (b - a) * (q[0] - p[0]) - center[0]);
			left = fmin(left, x);
			right = fmax(right, x);
		}
		s->x0[r] = right > left ? (int)floor(left + 0.5) : 0;
		s->x1[r] = right > left ? (int)floor(right + 0.5) : 0;
	}
}

/* The shapes of both openings for a head that faces the camera, px_per_mm small px a mm, rolled. Origin: between them. */
static void shapes(struct shape out[2], const struct eye_opening opening[2], const double origin[3], double px_per_mm, double roll)
{
	for (int e = 0; e < 2; e++) {
		double xy[OPENING_POINTS][2];
		out[e].open = opening[e].open;
		if (!out[e].open)
			continue;
		out[e].at[0] = out[e].at[1] = 0;
		for (int i = 0; i < OPENING_POINTS; i++) {
			double x = px_per_mm * (opening[e].edge[i][0] - origin[0]), y = -px_per_mm * (opening[e].edge[i][1] - origin[1]);
			xy[i][0] = cos(roll) * x - sin(roll) * y;
			xy[i][1] = sin(roll) * x + cos(roll) * y;
			for (int k = 0; k < 2; k++)
				out[e].at[k] += xy[i][k] / OPENING_POINTS;
		}
		rasterise(&out[e].in, OPENING_POINTS, xy, out[e].at, 1);
		rasterise(&out[e].out, OPENING_POINTS, xy, out[e].at, 1.6);
	}
}

/* Adds a shape at (x, y) to total[CHANNELS]; returns how many small pixels of it are in the picture, *whole of how many. */
SIMD_INLINE double add(double total[CHANNELS], double *whole, const struct small *s, const struct spans *p, int x, int y)
{
	double n = 0;
	*whole = 0;
	for (int r = 0; r < p->rows; r++) {
		int row = y + p->y0 + r, a = x + p->x0[r], b = x + p->x1[r];
		*whole += b - a;
		a = a < 0 ? 0 : a;
		b = b > s->width ? s->width : b;
		if (row < 0 || row >= s->height || b <= a)
			continue;
		const double *line = s->sum + (long)row * (s->width + 1) * CHANNELS;
		for (int k = 0; k < CHANNELS; k++)
			total[k] += line[(long)b * CHANNELS + k] - line[(long)a * CHANNELS + k];
		n += b - a;
	}
	return n;
}

/* Contrast of an opening: how much less red it is than the skin round it, in units of that skin's spread, and how much more its
 * brightness varies. NAN when it is not in the picture. */
SIMD_INLINE double contrast(const struct small *s, const struct shape *p, int x, int y)
{
	double in[CHANNELS] = { 0 }, out[CHANNELS] = { 0 }, whole, most;
	double n = add(in, &whole, s, &p->in, x, y);
	if (n < 0.97 * whole || n < 4)
		return NAN;
	double m = add(out, &most, s, &p->out, x, y) - n;
	if (m < 0.7 * (most - whole))
		return NAN;
	for (int k = 0; k < CHANNELS; k++) {
		out[k] = (out[k] - in[k]) / m;
		in[k] /= n;
	}
	double spread = sqrt(fmax(0, out[1] - out[0] * out[0]) + 1e-4), vary_in = fmax(0, in[3] - in[2] * in[2]);
	double vary_out = fmax(0, out[3] - out[2] * out[2]) + 0.003;
	return fmin(4, (out[0] - in[0]) / spread) + 0.5 * log((vary_in + 0.003) / vary_out);
}

struct best {
	double score, px_per_mm, roll, at[2];
	bool seen[2];
};

SIMD_INLINE bool inside(const struct small *s, const struct shape *p, int x, int y)
{
	return p->open && x + p->at[0] > 0 && x + p->at[0] < s->width && y + p->in.y0 >= 0 && y + p->in.y0 + p->in.rows <= s->height;
}

SIMD_CLONES static void slide(struct best *best, const struct small *s, const struct shape shape[2], double px_per_mm, double roll)
{
	int step = (int)fmax(1, (shape[0].open ? shape[0] : shape[1]).in.rows / 6);
	for (int y = -s->height / 2; y < s->height + s->height / 2; y += step)
		for (int x = -s->width / 2; x < s->width + s->width / 2; x += step) {
			double c[2], score = 0;
			int n = 0;
			for (int e = 0; e < 2; e++) {
				c[e] = inside(s, &shape[e], x, y) ? contrast(s, &shape[e], x, y) : NAN;
				score += isnan(c[e]) ? 0 : c[e];
				n += !isnan(c[e]);
			}
			// an eye missing inside the picture counts against the other; two eyes score higher than one whose partner lies
			// beyond the border
			score = n == 2 ? fmin(0.5 * score, fmin(c[0], c[1]) + 0.5) + pair : score;
			if (n && score > best->score)
				*best = (struct best){ score, px_per_mm, roll, { x, y }, { !isnan(c[0]), !isnan(c[1]) } };
		}
}

static void origin_of(double origin[3], const struct eye_opening opening[2])
{
	int n = opening[0].open + opening[1].open;
	for (int k = 0; k < 3; k++) {
		origin[k] = 0;
		for (int e = 0; e < 2; e++)
			origin[k] += opening[e].open ? opening[e].center[k] / n : 0;
	}
}

/* Facing the camera, rolled, the origin seen at px at that scale. */
static void facing(double m[4][4], const struct camera *camera, const double origin[3], const double px[2], double px_per_mm, double roll)
{
	double c = cos(roll), s = sin(roll), z = camera->focal_px / px_per_mm, ray[3];
	const double R[3][3] = { { c, s, 0 }, { s, -c, 0 }, { 0, 0, -1 } };
	camera_ray(ray, camera, px);
	memset(m, 0, 16 * sizeof(double));
	m[3][3] = 1;
	for (int i = 0; i < 3; i++) {
		m[i][3] = ray[i] / ray[2] * z;
		for (int k = 0; k < 3; k++) {
			m[i][k] = R[i][k];
			m[i][3] -= R[i][k] * origin[k];
		}
	}
}

bool head_find(struct head_found *found, const uint8_t *rgb, int width, int height, const struct camera *camera,
               const struct eye_opening opening[2], bool upside_down, const struct head_find_conf *conf)
{
	struct small s = shrink(rgb, width, height);
	struct best each[ROLLS * SIZES];
	double origin[3], wide = 0;
	origin_of(origin, opening);
	*found = (struct head_found){ .score = -INFINITY, .edge_px = NAN };
	for (int e = 0; e < 2; e++)
		if (opening[e].open)
			wide = fmax(wide, fabs(opening[e].canthus[1][0] - opening[e].canthus[0][0]));
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < ROLLS * SIZES; i++) {
		double size = conf->width[0] * pow(conf->width[1] / conf->width[0], (double)(i % SIZES) / (SIZES - 1)) * s.width / wide;
		double roll = conf->roll * M_PI / 180 * (i / SIZES - ROLLS / 2) / (ROLLS / 2) + (upside_down ? M_PI : 0);
		struct shape shape[2];
		each[i] = (struct best){ .score = -INFINITY };
		shapes(shape, opening, origin, size, roll);
		slide(&each[i], &s, shape, size, roll);
	}
	const struct best *best = each;
	for (int i = 1; i < ROLLS * SIZES; i++)
		best = each[i].score > best->score ? &each[i] : best;
	free(s.sum);
	found->score = best->score - (best->seen[0] && best->seen[1] ? pair : 0);
	if (!(found->score >= conf->min_score))
		return false;
	memcpy(found->seen, best->seen, sizeof found->seen);
	const double px[2] = { s.factor * best->at[0], s.factor * best->at[1] };
	facing(found->cam_from_head, camera, origin, px, best->px_per_mm * s.factor, best->roll);
	return true;
}

bool head_find_from_eyes(struct head_found *found, const double eye[2][2], const struct camera *camera, const struct eye_opening opening[2])
{
	double origin[3], mm = hypot(opening[0].center[0] - opening[1].center[0], opening[0].center[1] - opening[1].center[1]);
	const double across[2] = { eye[0][0] - eye[1][0], eye[0][1] - eye[1][1] };
	const double middle[2] = { 0.5 * (eye[0][0] + eye[1][0]), 0.5 * (eye[0][1] + eye[1][1]) };
	if (!opening[0].open || !opening[1].open)
		return false;
	origin_of(origin, opening);
	*found = (struct head_found){ .seen = { true, true }, .score = INFINITY, .edge_px = NAN };
	facing(found->cam_from_head, camera, origin, middle, hypot(across[0], across[1]) / mm, atan2(across[1], across[0]));
	return true;
}
