/* Inpainting of what a texture lacks, beyond the limbus and at the pupil's margin, and of what no photograph saw in one that is not
 * filled: continued round the axis
 * at the same radius, and outwards along the same fibre, cross-faded by distance. Both mirror the seen part at its edge, so that
 * nothing is smeared, and keep the mean brightness of the ring. */
#include "draw/eye/fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/batch_impl.h"

enum { TURNS = 1024, ENOUGH = TURNS / 12 };  // samples round a ring; 30 degrees of it must be seen to be copied from

/* Colour round the axis: rings of TURNS samples about the pupil's centre, outwards. */
struct rings {
	int n;
	double step;               // mm between rings
	float (*rgb)[TURNS][4];
	float (*filled)[TURNS][3];
	float (*mean)[3];          // of what was seen of a ring; of the nearest ring where that is too little
	int *from;                 // the ring to take colours from: itself, or the nearest with enough seen; -1: none
	int outer[TURNS];          // outermost ring seen at each angle; -1: none
};

static bool seen(const struct rings *r, int k, int j)
{
	return r->rgb[k][(j + 4 * TURNS) % TURNS][3] > 0.5f;
}

/* Reads one ring; returns how much of it was seen. */
static int ring_read(struct rings *r, int k, const float *rgba, int n, double extent, const double pupil[3])
{
	float per_mm = (float)(n / (2 * extent));
	double sum[3] = { 0 }, radius = (k + 0.5) * r->step;
	int count = 0;
	for (int j = 0; j < TURNS; j++) {
		double turn = 2 * M_PI * j / TURNS;
		float x = (float)(pupil[0] + radius * cos(turn)), y = (float)(pupil[1] + radius * sin(turn)), *p = r->rgb[k][j];
		for (int c = 0; c < 4; c++)
			p[c] = channel_at(rgba, n, per_mm, x, y, 4, c);
		if (fabs(x) > extent || fabs(y) > extent)
			p[3] = 0;
		for (int c = 0; c < 3 && p[3] > 0.5f; c++)
			sum[c] += p[c];
		count += p[3] > 0.5f;
	}
	for (int c = 0; c < 3; c++)
		r->mean[k][c] = (float)fmax(count ? sum[c] / count : 0, 1e-4);
	return count;
}

/* Finds for each ring the nearest one of which enough was seen, and at each angle the edge of what was seen, its minimum over
 * neighbouring angles, so that neighbouring fibres are continued alike. */
static void rings_relate(struct rings *r, const int *count)
{
	for (int k = 0; k < r->n; k++) {
		int d = 0;
		while (d < r->n && !(k >= d && count[k - d] > ENOUGH) && !(k + d < r->n && count[k + d] > ENOUGH))
			d++;
		r->from[k] = d == r->n ? -1 : k >= d && count[k - d] > ENOUGH ? k - d : k + d;
	}
	for (int k = 0; k < r->n; k++)
		if (r->from[k] >= 0 && r->from[k] != k)
			memcpy(r->mean[k], r->mean[r->from[k]], sizeof r->mean[k]);
	int raw[TURNS];
	for (int j = 0; j < TURNS; j++)
		for (raw[j] = r->n - 1; raw[j] >= 0 && !seen(r, raw[j], j); raw[j]--)
			;
	for (int j = 0; j < TURNS; j++) {
		r->outer[j] = raw[j];
		for (int i = -8; i <= 8; i++) {
			int near = raw[(j + i + TURNS) % TURNS];
			r->outer[j] = near >= 0 && near < r->outer[j] ? near : r->outer[j];
		}
	}
}

/* Mirrors `over` steps past an edge into the seen part behind it, which is `length` long: to and fro. */
static int fold(int over, int length)
{
	int at = length > 0 ? over % (2 * length) : 0;
	return at > length ? 2 * length - at : at;
}

/* The sample `over` past the edge of the seen arc, in direction way. */
static const float *unfold(const struct rings *r, int k, int edge, int way, int over)
{
	int length = 0;
	while (length < over && length < TURNS / 2 && seen(r, k, edge + way * (length + 1)))
		length++;
	return r->rgb[k][(edge + way * fold(over, length) + 4 * TURNS) % TURNS];
}

/* Continues both sides of the gap on the same ring; returns the distance to its nearer end, mm. */
static double fill_round(float rgb[3], const struct rings *r, int k, int j)
{
	int from = r->from[k], back = 0, ahead = 0;
	while (back < TURNS && !seen(r, from, j - back))
		back++;
	while (ahead < TURNS && !seen(r, from, j + ahead))
		ahead++;
	const float *p = unfold(r, from, j - back, -1, back), *q = unfold(r, from, j + ahead, 1, ahead);
	float t = back + ahead ? smooth(0, 1, (float)back / (float)(back + ahead)) : 0;
	for (int c = 0; c < 3; c++)
		rgb[c] = (p[c] + t * (q[c] - p[c])) * r->mean[k][c] / r->mean[from][c];
	return (back < ahead ? back : ahead) * 2 * M_PI / TURNS * (k + 0.5) * r->step;
}

/* Continues outwards along the fibre; returns the distance to the edge of what was seen, mm; INFINITY inside of it. */
static double fill_outwards(float rgb[3], const struct rings *r, int k, int j)
{
	int edge = r->outer[j], length = 0;
	if (edge < 0 || k <= edge)
		return INFINITY;
	while (length < k - edge && edge - length - 1 >= 0 && seen(r, edge - length - 1, j))
		length++;
	int from = edge - fold(k - edge, length);
	for (int c = 0; c < 3; c++)
		rgb[c] = r->rgb[from][j][c] * fminf(fmaxf(r->mean[k][c] / r->mean[from][c], 0.2f), 3);
	return (k - edge) * r->step;
}

static void ring_fill(struct rings *r, int k)
{
	for (int j = 0; j < TURNS; j++) {
		float *out = r->filled[k][j], round[3], outwards[3] = { 0 };
		memcpy(out, r->rgb[k][j], 3 * sizeof *out);
		if (seen(r, k, j))
			continue;
		double a = fill_round(round, r, k, j), b = fill_outwards(outwards, r, k, j);
		float t = isfinite(b) ? (float)(a * a / (a * a + b * b + 1e-9)) : 0;
		for (int c = 0; c < 3; c++)
			out[c] = round[c] + t * (outwards[c] - round[c]);
	}
}

static void texel_fill(float p[4], const struct rings *r, double x, double y)
{
	double radius = hypot(x, y) / r->step - 0.5, turn = atan2(y, x) / (2 * M_PI) * TURNS;
	int k = (int)fmin(fmax(radius, 0), r->n - 1), j = (int)floor(turn);
	float t = (float)(turn - j), w = smooth(0.15f, 0.6f, p[3]);
	const float *a = r->filled[k][(j + TURNS) % TURNS], *b = r->filled[k][(j + 1 + TURNS) % TURNS];
	for (int c = 0; c < 3; c++)
		p[c] = w * p[c] + (1 - w) * ((1 - t) * a[c] + t * b[c]);
}

static void rings_make(struct rings *r, const float *rgba, int n, double extent, const double pupil[3])
{
	r->step = 2 * extent / n;
	r->n = (int)(1.05 * extent / r->step);
	r->rgb = mem_array((size_t)r->n, sizeof *r->rgb);
	r->filled = mem_array((size_t)r->n, sizeof *r->filled);
	r->mean = mem_array((size_t)r->n, sizeof *r->mean);
	r->from = mem_array((size_t)r->n, sizeof *r->from);
	int *count = mem_new((size_t)r->n, sizeof *count);
#pragma omp parallel for schedule(dynamic, 8)
	for (int k = 0; k < r->n; k++)
		count[k] = ring_read(r, k, rgba, n, extent, pupil);
	rings_relate(r, count);
	free(count);
}

/* Unseen, but filled already where the texture was made (iris/unrefract). */
static bool is_filled(const float p[4])
{
	return p[3] < 0.6f && p[0] + p[1] + p[2] > 0;
}

void scene_fill(float *rgba, int n, double extent, const double pupil[3])
{
	struct rings r = { 0 };
	long all = (long)n * n;
	float *known = mem_array(4 * (size_t)all, sizeof *known);
	memcpy(known, rgba, 4 * (size_t)all * sizeof *known);
	for (long i = 0; i < all; i++)
		if (is_filled(known + 4 * i))
			known[4 * i + 3] = 1;
	rings_make(&r, known, n, extent, pupil);
	bool any = r.from[0] >= 0;
#pragma omp parallel for schedule(dynamic, 8)
	for (int k = 0; k < r.n; k++)
		if (any)
			ring_fill(&r, k);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			float *p = rgba + 4 * ((long)y * n + x);
			if (any && p[3] < 0.6f && !is_filled(p))
				texel_fill(p, &r, (x + 0.5) * 2 * extent / n - extent - pupil[0],
				           (y + 0.5) * 2 * extent / n - extent - pupil[1]);
			else if (!any)
				p[0] = p[1] = p[2] = 0.2f;  // nothing seen at all: grey
		}
	free(known);
	free(r.rgb);
	free(r.filled);
	free(r.mean);
	free(r.from);
}
