/* Lid margins move as arcs: of a made face whose margins were learnt with waves in them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/drive.h"
#include "rig/make/make_impl.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/unit.h"

enum { POINTS = 12, ACROSS = 97, UP = 49 };  // of the made face

/* The face's rig; wave: of the upper lids' motion, as a share of it. */
static struct rig waved(double wave, double seal, double breadth)
{
	struct face face;
	struct rig rig;
	struct rig_conf conf = face_conf();
	struct err err = { 0 };
	face_make(&face, false);
	for (int lid = 0; lid < SKIN_LIDS; lid += 2)
		for (int i = 0; i < POINTS; i++)
			face.model.K[(2 * (lid * POINTS + i) + 1) * face.model.n_lid_pc + lid] += wave * sin(5 * M_PI * i / (POINTS - 1));
	conf.map_step = 4;
	conf.lid = 6;
	conf.seal = seal;
	conf.breadth[0] = conf.breadth[1] = breadth;
	assert_true(face_rig(&rig, 0, &face, &conf, &err));
	face_free(&face);
	return rig;
}

/* How far a chain leaves the nearer of its two hulls, as a share of its height over its ends. */
static double bend(int n, const double *y)
{
	double off[2] = { 0 }, most = 0;
	for (int i = 0; i < n; i++) {
		most = fmax(most, fabs(y[i] - y[0] - (y[n - 1] - y[0]) * i / (n - 1)));
		for (int a = 0; a < i; a++)
			for (int b = i + 1; b < n; b++) {
				double d = y[a] + (y[b] - y[a]) * (i - a) / (b - a) - y[i];
				off[0] = fmax(off[0], d);
				off[1] = fmax(off[1], -d);
			}
	}
	return fmin(off[0], off[1]) / most;
}

/* Motion of the skin at the upper margin as the eyes half close: in each column of the sheet the lowest vertex above the fissure's
 * ellipse; 8 of its 10 mm to each side. Returns how many. */
static int half_closing(double *y, const struct rig *rig, int side, int most)
{
	double closed[RIG_COMPONENTS], before = -INFINITY;
	const double *o = rig->globe[side].center;
	int n = 0;
	rig_closed_pose(closed, rig);
	for (int column = 0; column < ACROSS && n < most; column++) {
		int lowest = -1;
		for (int i = column; i < ACROSS * UP && lowest < 0; i += ACROSS) {
			double x = rig->rest[i][0] - o[0], up = rig->rest[i][1];
			if (up > 0 && fabs(x) < 8 && hypot(x / 10, up / 4.5) > 1 && rig->rest[i][0] > before)
				lowest = i;
		}
		if (lowest < 0)
			continue;
		before = rig->rest[lowest][0];
		y[n] = 0;
		for (int k = 0; k < RIG_COMPONENTS; k++)
			y[n] += 0.5 * rig->basis[lowest][RIG_COMPONENTS + k] * closed[k];
		n++;
	}
	return n;
}

static void margins_are_arcs(void **state)
{
	(void)state;
	struct rig rig = waved(1, -1, 0);
	for (int side = 0; side < 2; side++) {
		double y[64];
		int n = half_closing(y, &rig, side, 64);
		assert_true(n > 8);
		// The fissure's own outline is a staircase of 1.2 mm, which bends by 0.21.
		assert_true(bend(n, y) < 0.3);
	}
	rig_free(&rig);
}

static void closed_lids_meet(void **state)
{
	(void)state;
	struct rig rig = waved(1, 0.15, 0);
	for (int side = 0; side < 2; side++) {
		// Without the seal the made face's lids, whose skin moves by little, stay wide open.
		double closed[RIG_COMPONENTS], at[2] = { -INFINITY, INFINITY };
		rig_closed_pose(closed, &rig);
		for (int i = 0; i < rig.n; i++) {
			const double *o = rig.globe[side].center;
			bool lower = rig.rest[i][1] < 0;
			if (rig.part[i] != RIG_SKIN || rig.side[i] != side || fabs(rig.rest[i][0] - o[0]) > 0.7 || fabs(fabs(rig.rest[i][1]) - 4.667) > 0.1)
				continue;
			double y = rig.home[i][1];
			for (int k = 0; k < RIG_COMPONENTS; k++)
				y += rig.basis[i][RIG_COMPONENTS + k] * closed[k];
			at[lower] = lower ? fmin(at[1], y) : fmax(at[0], y);
		}
		assert_true(isfinite(at[0]) && isfinite(at[1]));
		// px of 0.12 mm; the grid's rows are 1.2 mm apart.
		assert_true(at[0] > at[1] - 2);
		assert_true(at[0] < at[1] + 15);
	}
	rig_free(&rig);
}

/* px between the row of vertices at the upper margin's middle and the next one, 1.2 mm above it at rest, with the eyes closed. */
static double rows_apart(const struct rig *rig, int side)
{
	double closed[RIG_COMPONENTS], sum[2] = { 0 };
	int n[2] = { 0 };
	rig_closed_pose(closed, rig);
	for (int i = 0; i < rig->n; i++) {
		const double up = rig->rest[i][1], x = rig->rest[i][0] - rig->globe[side].center[0];
		const int row = fabs(up - 4.667) < 0.1 ? 0 : fabs(up - 5.833) < 0.1 ? 1 : -1;
		if (rig->part[i] != RIG_SKIN || rig->side[i] != side || fabs(x) > 0.7 || row < 0)
			continue;
		sum[row] += rig->home[i][1];
		for (int k = 0; k < RIG_COMPONENTS; k++)
			sum[row] += rig->basis[i][RIG_COMPONENTS + k] * closed[k];
		n[row]++;
	}
	assert_true(n[0] > 0 && n[0] == n[1]);
	return (sum[0] - sum[1]) / n[0];
}

static void the_edges_of_broad_margins_meet(void **state)
{
	(void)state;
	struct rig thin = waved(0, 0.15, 0), broad = waved(0, 0.15, 1.5);
	for (int side = 0; side < 2; side++) {
		// px of 0.12 mm.
		assert_true(rows_apart(&thin, side) > 2);
		assert_true(fabs(rows_apart(&broad, side)) < 0.5);
	}
	rig_free(&thin);
	rig_free(&broad);
}

/* Motion, px, of the skin nearest to `up` mm above the middle of an eye, with the eyes closed. */
static double closing_at(const struct rig *rig, int side, double up)
{
	double closed[RIG_COMPONENTS], sum = 0, least = INFINITY;
	rig_closed_pose(closed, rig);
	for (int i = 0; i < rig->n; i++) {
		const double off = hypot(rig->rest[i][0] - rig->globe[side].center[0], rig->rest[i][1] - up);
		if (rig->part[i] != RIG_SKIN || rig->side[i] != side || off >= least)
			continue;
		least = off;
		sum = 0;
		for (int k = 0; k < RIG_COMPONENTS; k++)
			sum += rig->basis[i][RIG_COMPONENTS + k] * closed[k];
	}
	assert_true(least < 1);
	return sum;
}

/* Where shutting was not learnt (this face's lids move by a millimetre), skin on the tarsus, which bears the lashes, comes down with the
 * margin, by what that does on average so far to either side; skin higher up comes less far the higher it is, so that none folds over. */
static void the_tarsus_shuts_as_one(void **state)
{
	(void)state;
	struct rig rig = waved(0, 0.15, 0);
	for (int side = 0; side < 2; side++) {
		const double margin = closing_at(&rig, side, 4.667);
		double before = margin;
		for (double up = 5.833; up < 20; up += 1.167) {
			const double here = closing_at(&rig, side, up);
			assert_true(here < before + 0.1 * margin);
			before = here;
		}
		print_message("shut: margin %.1f px, 3.5 mm above it %.1f, 14 mm %.1f\n", margin, closing_at(&rig, side, 8.167), closing_at(&rig, side, 18.667));
		assert_true(margin > 50 && closing_at(&rig, side, 8.167) > 0.75 * margin && closing_at(&rig, side, 18.667) < 0.25 * margin);
	}
	rig_free(&rig);
}

/* Motion, px, of the skin at the middle of an eye's upper margin, from both eyes open to eye `shut` alone shut (2: both). */
static double margin_moves(const struct rig *rig, int side, int shut)
{
	double *c = mem_new(2 * (size_t)rig->n_inputs + 1, sizeof *c), *all = c + rig->n_inputs, e[2][RIG_COMPONENTS], moved = NAN, least = INFINITY;
	drive_look(c, rig, 0, 0, 1);
	rig_components(e[0], rig, c);
	drive_look(all, rig, 0, 0, 0);
	for (int eye = 0; eye < 2; eye++)
		for (int k = 3; k < 5 && (shut == 2 || shut == eye); k++)
			c[5 * eye + k] = all[5 * eye + k];
	rig_components(e[1], rig, c);
	for (int i = 0; i < rig->n; i++) {
		const double off = hypot(rig->rest[i][0] - rig->globe[side].center[0], rig->rest[i][1] - 4.667);
		if (rig->part[i] != RIG_SKIN || rig->side[i] != side || off >= least)
			continue;
		least = off;
		moved = 0;
		for (int k = 0; k < RIG_COMPONENTS; k++)
			moved += rig->basis[i][RIG_COMPONENTS + k] * (e[1][k] - e[0][k]);
	}
	free(c);
	return moved;
}

static void a_wink_shuts_one_eye(void **state)
{
	(void)state;
	struct rig rig = waved(0, 0.15, 0);
	for (int side = 0; side < 2; side++) {
		const double both = margin_moves(&rig, side, 2), own = margin_moves(&rig, side, side), other = margin_moves(&rig, side, !side);
		print_message("upper margin: both shut %.1f px, this one alone %.1f, the other alone %.1f\n", both, own, other);
		assert_true(both > 50);
		assert_true(fabs(own - both) < 0.05 * both);
		assert_true(fabs(other) < 0.05 * both);
	}
	rig_free(&rig);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(margins_are_arcs), cmocka_unit_test(closed_lids_meet), cmocka_unit_test(the_edges_of_broad_margins_meet), cmocka_unit_test(the_tarsus_shuts_as_one),
		                                cmocka_unit_test(a_wink_shuts_one_eye) };
	return cmocka_run_group_tests(tests, 0, 0);
}
