/* The opening of an eye between faces that fold, overlap and turn their backs, against its definition: of each column the longest gap in the union of what
 * its faces cover. */
#include "tests/lib/unit.h"

#include <stdlib.h>

#include "base/mem.h"
#include "math/rng.h"
#include "rig/deform/opening.h"
#include "tests/lib/scenes/driven.h"

struct cover { double low, high; };

static int upwards(const void *a, const void *b)
{
	const struct cover *p = a, *q = b;
	return (p->low > q->low) - (p->low < q->low);
}

/* What a triangle covers of the line at x. */
static bool covers(struct cover *c, double p[3][3], double x)
{
	*c = (struct cover){ INFINITY, -INFINITY };
	for (int k = 0; k < 3; k++) {
		const double *a = p[k], *b = p[(k + 1) % 3], t = (x - a[0]) / (b[0] - a[0]);
		if (!(t >= 0 && t <= 1))
			continue;
		c->low = fmin(c->low, a[1] + t * (b[1] - a[1]));
		c->high = fmax(c->high, a[1] + t * (b[1] - a[1]));
	}
	return c->high >= c->low;
}

/* Length of the longest gap at x whose middle lies within 6 mm of the eyeball's middle, before it. */
static double gap_at(struct cover *cover, const struct rig *rig, const struct deform_near *near, int side, const float (*at)[3], double x)
{
	const double radius = rig->globe[side].radius;
	int n = 0;
	for (int k = 0; k < near->n + near->n_beside; k++) {
		const int32_t *v = rig->faces[deform_near_face(near, k)];
		double p[3][3], nearest = INFINITY;
		for (int j = 0; j < 3; j++) {
			deform_in_head(p[j], rig, side, at[v[j]]);
			nearest = fmin(nearest, p[j][2]);
		}
		if (rig->side[v[0]] == side && nearest > 0.2 * radius)
			n += covers(&cover[n], p, x);
	}
	qsort(cover, (size_t)n, sizeof *cover, upwards);
	double longest = 0, high = n ? cover[0].high : 0;
	for (int k = 1; k < n; k++) {
		const double middle = 0.5 * (high + cover[k].low);
		if (middle > -6 && middle < 6 && hypot(x, middle) < radius)
			longest = fmax(longest, cover[k].low - high);
		high = fmax(high, cover[k].high);
	}
	return longest;
}

static void gaps_are_those_of_the_union(void **state)
{
	const struct driven *m = *state;
	enum { MESHES = SANITISED ? 2 : 8 };
	struct deform_near near = deform_near_of(&m->rig);
	float (*x)[3] = mem_array((size_t)m->rig.n, sizeof *x);
	struct cover *cover = mem_array((size_t)m->rig.n_faces, sizeof *cover);
	struct rng rng = { 4 };
	int open = 0, columns = 0;
	for (int k = 0; k < MESHES; k++) {
		for (int i = 0; i < m->rig.n; i++)
			for (int c = 0; c < 3; c++)  // less than a row of faces, or several
				x[i][c] = m->rig.rest[i][c] + (float)(0.7 * k * (rng_uniform(&rng) - 0.5));
		for (int side = 0; side < 2; side++) {
			struct deform_opening o;
			deform_open(&o, &m->rig, &near, side, (const float(*)[3])x, (double[]){ -6, 6 });
			for (int i = 1; i < DEFORM_COLUMNS; i += 3, columns++) {
				const double want = gap_at(cover, &m->rig, &near, side, (const float(*)[3])x, o.step * (i - DEFORM_COLUMNS / 2));
				NEAR(o.top[i] - o.bottom[i], want, 1e-9);
				open += want > 0;
			}
		}
	}
	assert_true(open > columns / 4);
	free(x);
	free(cover);
	deform_near_free(&near);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(gaps_are_those_of_the_union) };
	return cmocka_run_group_tests(tests, driven_setup, driven_teardown);
}
