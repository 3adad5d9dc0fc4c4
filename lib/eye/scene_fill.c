/* What no photograph saw of the iris (under a lid, behind a reflection) is continued from what was seen at the same
 * radius: the iris is made of radial fibres, so a neighbour round the axis is the best guess there is. The seen arc is
 * unfolded like a mirror from both ends of the gap, so that nothing is smeared, and the two are cross-faded. */
#include "eye/scene_impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { TURNS = 1024 };

/* Colour round the axis: rings of TURNS samples about the pupil's centre outwards. */
struct rings {
	int n;
	double step;         // mm between rings
	float (*rgb)[TURNS][4];
	short (*back)[TURNS], (*ahead)[TURNS];  // samples to the nearest seen one on either side; 0 where seen
	int *from;           // the ring to take colours from: itself, or the nearest with enough seen
};

static void ring_read(struct rings *r, int k, const float *rgba, int n, double extent, const double pupil[3])
{
	float per_mm = (float)(n / (2 * extent));
	for (int j = 0; j < TURNS; j++) {
		double turn = 2 * M_PI * j / TURNS, radius = (k + 0.5) * r->step;
		float x = (float)(pupil[0] + radius * cos(turn)), y = (float)(pupil[1] + radius * sin(turn));
		for (int c = 0; c < 4; c++)
			r->rgb[k][j][c] = channel_at(rgba, n, per_mm, x, y, 4, c);
		if (fabs(x) > extent || fabs(y) > extent)
			r->rgb[k][j][3] = 0;
	}
}

static int ring_gaps(struct rings *r, int k)
{
	int seen = 0;
	for (int pass = 0, back = TURNS, ahead = TURNS; pass < 2; pass++)  // twice round, so that gaps close over the seam
		for (int j = 0; j < TURNS; j++) {
			int i = TURNS - 1 - j;
			back = r->rgb[k][j][3] > 0.5f ? 0 : back < TURNS ? back + 1 : TURNS;
			ahead = r->rgb[k][i][3] > 0.5f ? 0 : ahead < TURNS ? ahead + 1 : TURNS;
			r->back[k][j] = (short)back;
			r->ahead[k][i] = (short)ahead;
			seen += pass == 0 && back == 0;
		}
	return seen;
}

/* The sample `over` past the edge of the seen arc at j, in direction way: mirrored to and fro within the arc. */
static int unfold(const struct rings *r, int k, int j, int way, int over)
{
	const short(*gap)[TURNS] = (const short(*)[TURNS])(way > 0 ? r->ahead : r->back);
	int edge = j + way * gap[k][(j % TURNS + TURNS) % TURNS], length = 0;
	while (length < over && length < TURNS / 2 && r->rgb[k][(edge + way * (length + 1) + 2 * TURNS) % TURNS][3] > 0.5f)
		length++;
	int fold = length ? over % (2 * length) : 0;
	return (edge + way * (fold > length ? 2 * length - fold : fold) + 4 * TURNS) % TURNS;
}

static void ring_fill(struct rings *r, int k)
{
	float(*out)[4] = mem_new(TURNS, sizeof *out);
	for (int j = 0; j < TURNS; j++) {
		int b = r->back[k][j], a = r->ahead[k][j];
		memcpy(out[j], r->rgb[k][j], sizeof out[j]);
		if (!b || !a)
			continue;
		const float *p = r->rgb[k][unfold(r, k, j, -1, b)], *q = r->rgb[k][unfold(r, k, j, 1, a)];
		float t = smooth(0, 1, (float)b / (float)(a + b));
		for (int c = 0; c < 3; c++)
			out[j][c] = p[c] + t * (q[c] - p[c]);
	}
	memcpy(r->rgb[k], out, TURNS * sizeof *out);
	free(out);
}

static void rings_make(struct rings *r, const float *rgba, int n, double extent, const double pupil[3])
{
	r->step = 2 * extent / n;
	r->n = (int)(1.05 * extent / r->step);
	r->rgb = mem_array((size_t)r->n, sizeof *r->rgb);
	r->back = mem_array((size_t)r->n, sizeof *r->back);
	r->ahead = mem_array((size_t)r->n, sizeof *r->ahead);
	r->from = mem_array((size_t)r->n, sizeof *r->from);
	bool *good = mem_new((size_t)r->n, sizeof *good);
#pragma omp parallel for schedule(dynamic, 8)
	for (int k = 0; k < r->n; k++) {
		ring_read(r, k, rgba, n, extent, pupil);
		good[k] = ring_gaps(r, k) > TURNS / 12;  // 30 degrees
		if (good[k])
			ring_fill(r, k);
	}
	for (int k = 0; k < r->n; k++) {
		int d = 0;
		while (d < r->n && !(k >= d && good[k - d]) && !(k + d < r->n && good[k + d]))
			d++;
		r->from[k] = d == r->n ? -1 : k >= d && good[k - d] ? k - d : k + d;
	}
	free(good);
}

static void texel_fill(float p[4], const struct rings *r, double x, double y)
{
	double radius = hypot(x, y) / r->step - 0.5, turn = atan2(y, x) / (2 * M_PI) * TURNS;
	int k = (int)fmin(fmax(radius, 0), r->n - 1), j = (int)floor(turn), from = r->from[k];
	float t = (float)(turn - j), w = smooth(0.15f, 0.6f, p[3]);
	if (from < 0) {  // nothing seen at all: grey
		p[0] = p[1] = p[2] = 0.2f;
		return;
	}
	const float *a = r->rgb[from][(j + TURNS) % TURNS], *b = r->rgb[from][(j + 1 + TURNS) % TURNS];
	for (int c = 0; c < 3; c++)
		p[c] = w * p[c] + (1 - w) * ((1 - t) * a[c] + t * b[c]);
}

void scene_fill(float *rgba, int n, double extent, const double pupil[3])
{
	struct rings r = { 0 };
	rings_make(&r, rgba, n, extent, pupil);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			float *p = rgba + 4 * ((long)y * n + x);
			if (p[3] < 0.6f)
				texel_fill(p, &r, (x + 0.5) * 2 * extent / n - extent - pupil[0],
				           (y + 0.5) * 2 * extent / n - extent - pupil[1]);
		}
	free(r.rgb);
	free(r.back);
	free(r.ahead);
	free(r.from);
}
