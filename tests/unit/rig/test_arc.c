/* arc: hulls of chains in closed form; the opening of a made face, whose rows are known; a margin that is a staircase at rest is left. */
#include "rig/deform/along.h"
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

/* Mean height of an upper or lower margin in its middle third, mm. */
static double middle_of(const struct driven *m, const struct deform_near *near, const float (*x)[3], bool upper)
{
	struct deform_opening o;
	double sum = 0;
	int n = 0;
	deform_open(&o, &m->rig, near, 0, x, near->within[0]);
	for (int i = o.first + (o.last - o.first) / 3; i <= o.last - (o.last - o.first) / 3; i++, n++)
		sum += upper ? o.top[i] : o.bottom[i];
	return sum / n;
}

/* An eye that looks 25 degrees down, of a person whose lids are known to 10: the upper lid goes on with it, nine tenths of the way, the lower one leaves as much
 * of the iris free as the person's own, as far as it is told; in the filmed range neither does. */
static void lids_go_along(void **state)
{
	struct driven *m = *state;
	struct deform_near near = deform_near_of(&m->rig);
	const struct known was = m->rig.known;
	const struct own_low low = m->rig.own_low;
	const double unit = m->rig.globe[0].radius / 12, degree = M_PI / 180;
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x), (*moved)[3] = calloc((size_t)m->rig.n, sizeof *moved);
	double turn[2][3][3];
	for (int i = 0; i < m->rig.n; i++) {
		double p[3];
		deform_in_head(p, &m->rig, 0, m->rig.rest[i]);
		const bool lid = m->rig.side[i] == 0 && !rig_is_globe(m->rig.part[i]);
		near.upper[i] = lid && p[1] > 0;
		near.lower[i] = lid && p[1] < 0;
	}
	for (int k = 0; k < KNOWN_CORNERS; k++)
		for (int s = 0; s < 2; s++) {
			m->rig.known.corner[s][k][0] = 10 * cos(2 * M_PI * k / KNOWN_CORNERS);
			m->rig.known.corner[s][k][1] = 10 * sin(2 * M_PI * k / KNOWN_CORNERS);
		}
	m->rig.known.beyond = 0;
	for (int k = 0; k < 2 * OWN_LOW_V * OWN_LOW_H; k++)
		(&m->rig.own_low.share[0][0][0])[k] = 1;
	for (int down = 0; down <= 25; down += 5) {
		driven_pose(x, turn, m, 0, -down, 1);
		memcpy(moved, x, (size_t)m->rig.n * sizeof *x);
		deform_along(moved, &m->rig, &near, 0, (const double(*)[3])turn[0], 0);
		const double fell = middle_of(m, &near, (const float(*)[3])x, true) - middle_of(m, &near, (const float(*)[3])moved, true);
		const double want = down <= 10 ? 0 : 0.9 * 10.6 * unit * (sin(down * degree) - sin(10 * degree));
		NEAR(fell, want, 0.02 + 0.2 * want);  // less beside the middle
	}
	driven_pose(x, turn, m, 0, -15, 1);
	double before = 0, lowered[2] = { 0 };
	for (int k = 0; k < 2; k++) {
		for (int i = 0; i < 2 * OWN_LOW_V * OWN_LOW_H; i++)
			(&m->rig.own_low.share[0][0][0])[i] = k ? 0.05f : 1;
		memcpy(moved, x, (size_t)m->rig.n * sizeof *x);
		before = middle_of(m, &near, (const float(*)[3])x, false);
		deform_along(moved, &m->rig, &near, 0, (const double(*)[3])turn[0], 0);
		lowered[k] = before - middle_of(m, &near, (const float(*)[3])moved, false);
	}
	assert_true(lowered[1] > lowered[0] + 0.1 * unit && lowered[1] < 9 * unit);
	m->rig.known = was;
	m->rig.own_low = low;
	free(x);
	free(moved);
	deform_near_free(&near);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(hulls), cmocka_unit_test(opening_of_a_made_face), cmocka_unit_test(what_was_drawn_so_is_left),
		                                cmocka_unit_test(all_but_shut_is_shut), cmocka_unit_test(lids_go_along) };
	return cmocka_run_group_tests(tests, driven_setup, driven_teardown);
}
