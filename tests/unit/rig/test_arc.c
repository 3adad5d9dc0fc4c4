/* arc: hulls of chains in closed form; the opening of a made face, whose rows are known; a margin that is a staircase at rest is left. */
#include "rig/deform/arc.h"
#include "rig/deform/slide.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/unit.h"

#include <string.h>

static void hulls(void **state)
{
	(void)state;
	// A parabola is its own hull; with a dip of 0.3 at its top that is filled up to the line between its neighbours.
	double y[21], hull[21];
	for (int i = 0; i < 21; i++)
		y[i] = 4 - 0.04 * (i - 10) * (i - 10);
	NEAR(deform_hull(hull, 21, y), 0, 1e-12);
	y[10] -= 0.3;
	NEAR(deform_hull(hull, 21, y), 0.3 - 0.04, 1e-12);
	NEAR(hull[10], 3.96, 1e-12);
	for (int i = 0; i < 21; i++)
		assert_true(i == 10 || fabs(hull[i] - y[i]) < 1e-12);
	// Turned over, the straight line between its ends.
	for (int i = 0; i < 21; i++)
		y[i] = 0.04 * (i - 10) * (i - 10);
	NEAR(deform_hull(hull, 21, y), 4, 1e-12);
	for (int i = 0; i < 21; i++)
		NEAR(hull[i], 4, 1e-12);
}

/* The made fissure, 10 by 4.5 mm, is cut from rows 7/6 mm apart: open up to the fourth in the middle, to the third further out. */
static void opening_of_a_made_face(void **state)
{
	const struct driven *m = *state;
	struct deform_near near = deform_near_of(&m->rig);
	for (int side = 0; side < 2; side++) {
		struct deform_opening o;
		deform_open(&o, &m->rig, &near, side, (const float(*)[3])m->rig.rest, (double[]){ -6, 6 });
		const int middle = DEFORM_COLUMNS / 2, aside = middle + (int)(6 / o.step);
		assert_true(o.first < middle - 5 / o.step && o.last > middle + 5 / o.step);
		NEAR(o.top[middle], 4 * 7.0 / 6, 1e-3);
		NEAR(o.bottom[middle], -4 * 7.0 / 6, 1e-3);
		NEAR(o.top[aside], 3 * 7.0 / 6, 1e-3);
	}
	deform_near_free(&near);
}

static void what_was_drawn_so_is_left(void **state)
{
	const struct driven *m = *state;
	struct deform_near near = deform_near_of(&m->rig);
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x), (*was)[3] = calloc((size_t)m->rig.n, sizeof *was);
	double turn[2][3][3];
	driven_pose(x, turn, m, 10, -10, 0.5);
	memcpy(was, x, (size_t)m->rig.n * sizeof *x);
	deform_settle(x, &m->rig, &near, (const double(*)[3][3])turn, 0);
	deform_clear(was, &m->rig, &near, (const double(*)[3][3])turn);
	for (int i = 0; i < m->rig.n; i++)
		for (int c = 0; c < 3; c++)
			NEAR(x[i][c], was[i][c], 1e-6);
	free(x);
	free(was);
	deform_near_free(&near);
}

/* The made fissure, squeezed to a slit so high in its middle: by its rows' heights, as the globe has it, mm. Returns the height of what deform_shut leaves. */
static double left_of_slit(double *was, const struct driven *m, struct deform_near *near, double high)
{
	const double half = 4 * 7.0 / 6;  // mm: the fourth row
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x);
	double most[2] = { 0 };
	for (int side = 0; side < 2; side++) {
		double turn[3][3];
		rig_globe_rotation(turn, &m->rig, (double[]){ 0, 0, 0 });
		memcpy(x, m->rig.rest, (size_t)m->rig.n * sizeof *x);
		for (int i = 0; i < m->rig.n; i++) {
			double p[3];
			deform_in_head(p, &m->rig, side, x[i]);
			near->upper[i] = m->rig.side[i] == side && !rig_is_globe(m->rig.part[i]) && p[1] > 0;
			if (m->rig.side[i] == side && !rig_is_globe(m->rig.part[i]))
				deform_slide(x[i], &m->rig, side, (const double(*)[3])turn, -(p[1] > 0 ? fmin(p[1], half) : fmax(p[1], -half)) * (1 - 0.5 * high / half));
		}
		for (int after = 0; after < 2; after++) {
			struct deform_opening o;
			deform_open(&o, &m->rig, near, side, (const float(*)[3])x, near->within[side]);
			for (int i = 0; i < DEFORM_COLUMNS; i++)
				most[after] = fmax(most[after], o.top[i] - o.bottom[i]);
			if (!after)
				deform_shut(x, &m->rig, near, side, (const double(*)[3])turn);
		}
	}
	free(x);
	*was = most[0];
	return most[1];
}

/* Lids that are all but shut meet, others stay, and between those a lid that opens goes on opening. */
static void all_but_shut_is_shut(void **state)
{
	const struct driven *m = *state;
	struct deform_near near = deform_near_of(&m->rig);
	const double unit = m->rig.globe[0].radius / 12;
	double before = 0;
	for (int k = 1; k <= 16; k++) {
		const double high = 0.1 * k * unit;
		double was, left = left_of_slit(&was, m, &near, high);
		NEAR(was, high, 0.15 * high);  // skin keeps its distance from the globe, not from its middle plane
		if (was < 0.59 * unit)
			assert_true(left < 0.01);
		if (was > 1.2 * unit)
			NEAR(left, was, 1e-9);
		assert_true(left >= before - 1e-3);
		before = left;
	}
	deform_near_free(&near);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(hulls), cmocka_unit_test(opening_of_a_made_face), cmocka_unit_test(what_was_drawn_so_is_left),
		                                cmocka_unit_test(all_but_shut_is_shut) };
	return cmocka_run_group_tests(tests, driven_setup, driven_teardown);
}
