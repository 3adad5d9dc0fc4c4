/* A sheet of skin that poses fold is given some breadth again. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/make/unfold_impl.h"
#include "tests/lib/unit.h"

enum { ACROSS = 13, UP = 25 };  // vertices, a millimetre apart
static const double least = 0.25;

static void at(double out[2], int i)
{
	out[0] = i % ACROSS;
	out[1] = i / ACROSS;
}

/* One of the two faces of a cell. */
static struct leaf leaf_at(int cell, int which)
{
	const int from = cell / (ACROSS - 1) * ACROSS + cell % (ACROSS - 1);
	struct leaf l = { .v = { from, which ? from + ACROSS + 1 : from + 1, which ? from + ACROSS : from + ACROSS + 1 }, .area = 0.5 };
	for (int k = 0; k < 3; k++) {
		double a[2], b[2];
		at(a, l.v[(k + 1) % 3]);
		at(b, l.v[(k + 2) % 3]);
		l.slope[k][0] = a[1] - b[1];
		l.slope[k][1] = b[0] - a[0];
	}
	return l;
}

/* Rows below 5 stay; of every closing there is a pose, by how far a row comes down as all shut. */
static struct sheet sheet_of(int n_poses, const double *closed, double (*down)(double up, double closed))
{
	struct sheet s = { .n = ACROSS * UP, .n_poses = n_poses };
	s.may = mem_new((size_t)s.n, sizeof *s.may);
	s.move = mem_new((size_t)s.n, sizeof *s.move);
	s.added = mem_new((size_t)s.n, sizeof *s.added);
	s.leaf = mem_new(2 * (size_t)s.n, sizeof *s.leaf);
	s.pose = mem_new((size_t)n_poses, sizeof *s.pose);
	for (int i = 0; i < s.n; i++)
		s.may[i] = i / ACROSS >= 5;
	for (int cell = 0; cell < (ACROSS - 1) * (UP - 1); cell++)
		for (int which = 0; which < 2; which++)
			s.leaf[s.n_leaves++] = leaf_at(cell, which);
	for (int p = 0; p < n_poses; p++) {
		s.pose[p] = (struct sheet_pose){ closed[p], mem_new((size_t)s.n, sizeof *s.pose->at), mem_new((size_t)s.n_leaves, sizeof *s.pose->least) };
		for (int i = 0; i < s.n; i++) {
			at(s.pose[p].at[i], i);
			s.pose[p].at[i][1] -= down(i / ACROSS, closed[p]);
		}
		for (int f = 0; f < s.n_leaves; f++)
			s.pose[p].least[f] = least;
	}
	return s;
}

static double narrowest(const struct sheet *s, int p)
{
	double out = INFINITY;
	for (int f = 0; f < s->n_leaves; f++)
		out = fmin(out, sheet_breadth(s, &s->pose[p], &s->leaf[f]));
	return out;
}

static double furthest(const struct sheet *s, int from, int to)
{
	double most = 0;
	for (int i = from * ACROSS; i < to * ACROSS; i++)
		most = fmax(most, hypot(s->move[i][0], s->move[i][1]));
	return most;
}

/* What lies above the 12th row comes down by 5 mm, what lies below the 9th stays: three millimetres are turned over, to -2/3 of their breadth. */
static double folded(double up, double closed)
{
	return 5 * closed * fmin(fmax((up - 9) / 3, 0), 1);
}

static double straight(double up, double closed)
{
	return 0.7 * closed * up;
}

static void folds_get_breadth(void **state)
{
	(void)state;
	struct sheet s = sheet_of(1, (double[]){ 1 }, folded);
	NEAR(narrowest(&s, 0), -2.0 / 3, 1e-9);
	sheet_widen(&s);
	sheet_widen(&s);
	assert_true(narrowest(&s, 0) > least - 0.1);
	assert_true(furthest(&s, 0, 5) == 0);
	// What three rows lack, 3 (1/4 + 2/3) mm, is shared among those above and below: nothing goes further than that.
	assert_true(furthest(&s, 5, UP) > 0.5 && furthest(&s, 5, UP) < 2.75);
	// Rows are as they were from side to side: all that is lacking is lacking up and down.
	for (int i = 0; i < s.n; i++)
		NEAR(s.move[i][0], 0, 0.1);
	sheet_free(&s);
}

static void a_move_does_for_all_poses(void **state)
{
	(void)state;
	// Half shut it is narrowed to 1/6 and not turned over: half of the move gives more than it lacks.
	struct sheet s = sheet_of(2, (double[]){ 1, 0.5 }, folded);
	sheet_widen(&s);
	sheet_widen(&s);
	assert_true(narrowest(&s, 0) > least - 0.1 && narrowest(&s, 1) > least);
	// What poses have of it already is not added again.
	for (int p = 0; p < 2; p++)
		for (int i = 0; i < 2 * s.n; i++)
			s.pose[p].at[i / 2][i % 2] += s.pose[p].closed * s.move[i / 2][i % 2];
	const double was = narrowest(&s, 0), went = furthest(&s, 0, UP);
	memcpy(s.added, s.move, (size_t)s.n * sizeof *s.move);
	assert_true(narrowest(&s, 0) > least - 0.1);
	sheet_widen(&s);
	assert_true(narrowest(&s, 0) >= was - 0.02 && furthest(&s, 0, UP) < went + 0.3);
	sheet_free(&s);
}

static void what_is_not_folded_stays(void **state)
{
	(void)state;
	struct sheet s = sheet_of(1, (double[]){ 1 }, straight);
	NEAR(narrowest(&s, 0), 0.3, 1e-9);
	sheet_widen(&s);
	assert_true(furthest(&s, 0, UP) == 0);
	// Turned as a whole it is as broad as ever; in a mirror it is turned over.
	for (int i = 0; i < s.n; i++) {
		double x[2];
		at(x, i);
		s.pose[0].at[i][0] = 0.5 * x[0] - sqrt(0.75) * x[1];
		s.pose[0].at[i][1] = sqrt(0.75) * x[0] + 0.5 * x[1];
	}
	NEAR(narrowest(&s, 0), 1, 1e-9);
	for (int i = 0; i < s.n; i++)
		s.pose[0].at[i][0] *= -1;
	NEAR(narrowest(&s, 0), -1, 1e-9);
	// Left no narrower than it was, it may stay so.
	for (int f = 0; f < s.n_leaves; f++)
		s.pose[0].least[f] = -1;
	sheet_widen(&s);
	NEAR(furthest(&s, 0, UP), 0, 1e-9);
	sheet_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(folds_get_breadth),
		cmocka_unit_test(a_move_does_for_all_poses),
		cmocka_unit_test(what_is_not_folded_stays),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
