#include "track/eye/told.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static const double HALF = 0.5;   // chance of eye at the edge of an opening
static const double NEAR = 2.5;   // radii of the iris: an opening's middle lies no further, one standard deviation
static const double END = 0.35;   // radii: what lies so near an end tells how high it is
static const double LEAST = 0.5;  // squares of the radius: less is no eye

struct patch {
	int width, height;
	float *eye;            // chance of each pixel
	int *label;            // 0: none
};

static struct patch patch_of(const struct evidence *e)
{
	const int n = e->width * e->height;
	struct patch p = { e->width, e->height, mem_array((size_t)n, sizeof *p.eye), mem_new((size_t)n, sizeof *p.label) };
	for (int i = 0; i < n; i++)
		p.eye[i] = evidence_eye(e, i);
	return p;
}

/* Labels what is connected with pixel `from`; its weight, the more the nearer to the place. */
static double fill(struct patch *p, int *stack, int from, int label, const struct evidence *e, const double place[3])
{
	double weight = 0;
	int n = 0;
	stack[n++] = from;
	p->label[from] = label;
	while (n) {
		const int at = stack[--n], x = at % p->width, y = at / p->width;
		const double u = e->x0 + (x + 0.5) * e->scale - place[0], v = e->y0 + (y + 0.5) * e->scale - place[1];
		weight += (double)p->eye[at] * exp(-0.5 * (u * u + v * v) / pow(NEAR * place[2], 2));
		const int next[4] = { x > 0 ? at - 1 : -1, x + 1 < p->width ? at + 1 : -1, y > 0 ? at - p->width : -1, y + 1 < p->height ? at + p->width : -1 };
		for (int k = 0; k < 4; k++)
			if (next[k] >= 0 && !p->label[next[k]] && (double)p->eye[next[k]] > HALF) {
				p->label[next[k]] = label;
				stack[n++] = next[k];
			}
	}
	return weight;
}

/* The label of the patch that weighs most; 0: none. */
static int heaviest(struct patch *p, const struct evidence *e, const double place[3])
{
	const int n = p->width * p->height;
	int *stack = mem_array((size_t)n, sizeof *stack), best = 0, label = 0;
	double most = 0;
	for (int i = 0; i < n; i++) {
		if (p->label[i] || !((double)p->eye[i] > HALF))
			continue;
		const double weight = fill(p, stack, i, ++label, e, place);
		if (weight > most) {
			most = weight;
			best = label;
		}
	}
	free(stack);
	return best;
}

/* How far beyond its outermost pixel the chance falls to a half, in direction `sign` along `across`: less than a pixel. px */
static double beyond(const struct patch *p, int at, double sign, const double across[2], double scale)
{
	const double x = at % p->width + sign * across[0], y = at / p->width + sign * across[1];
	const int i = (int)lround(x), j = (int)lround(y);
	if (i < 0 || j < 0 || i >= p->width || j >= p->height)
		return 0;
	const double in = (double)p->eye[at], out = (double)p->eye[j * p->width + i];
	return in > out ? fmin(1, (in - HALF) / (in - out)) * scale : 0;
}

bool eye_told_of(struct eye_told *told, const struct evidence *e, const double place[3], const double across[2])
{
	struct patch p = patch_of(e);
	const int label = heaviest(&p, e, place);
	double end[2] = { INFINITY, -INFINITY }, high[2] = { 0 }, weight[2] = { 0 };
	int last[2] = { 0 }, n = 0;
	for (int i = 0; label && i < p.width * p.height; i++) {
		if (p.label[i] != label)
			continue;
		const double a = (i % p.width + 0.5) * e->scale * across[0] + (i / p.width + 0.5) * e->scale * across[1];
		n++;
		for (int k = 0; k < 2; k++)
			if (k ? a > end[k] : a < end[k]) {
				end[k] = a;
				last[k] = i;
			}
	}
	told->area = n * e->scale * e->scale / (place[2] * place[2]);
	for (int i = 0; label && i < p.width * p.height; i++) {
		const double x = (i % p.width + 0.5) * e->scale, y = (i / p.width + 0.5) * e->scale, a = x * across[0] + y * across[1];
		for (int k = 0; k < 2 && p.label[i] == label; k++)
			if (fabs(a - end[k]) < END * place[2]) {
				high[k] += (double)p.eye[i] * (y * across[0] - x * across[1]);
				weight[k] += (double)p.eye[i];
			}
	}
	for (int k = 0; label && k < 2; k++) {
		const double a = end[k] + (k ? 1 : -1) * beyond(&p, last[k], k ? 1 : -1, across, e->scale), v = high[k] / weight[k];
		told->corner[k][0] = e->x0 + a * across[0] - v * across[1];
		told->corner[k][1] = e->y0 + a * across[1] + v * across[0];
	}
	free(p.eye);
	free(p.label);
	return label && told->area > LEAST;
}
