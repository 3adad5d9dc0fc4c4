/* Hairs as a film shows them, on a made face that is the person's own: brows that hide as much where the film's do, and lashes that reach as far; what
 * hides and reaches is measured here anew, on the hairs' points. */
#include "math/vec.h"
#include "rig/hair/hair.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/unit.h"

static const struct hair_conf average = { .lash_mm = 9, .brow_mm = 8, .lashes = 100, .brow_hairs = 200, .margin_mm = 1.1 };
static const double patch_x[2] = { -6, 10 }, patch_y[2] = { 14, 19 }, part = 0.5, combed = 0.4;

struct filmed {
	struct driven on;
	struct hair_film film;
	struct hair_conf conf;
};

static int setup(void **state)
{
	struct filmed *m = calloc(1, sizeof *m);
	struct err err = { 0 };
	*state = m;
	if (!driven_make(&m->on, &average, &err))
		return 1;
	const struct rig *rig = &m->on.rig;
	m->conf = average;
	m->conf.film = &m->film;
	m->conf.place = (const float(*)[3])rig->rest;
	m->film.radius = rig->globe[0].radius;
	for (int s = 0; s < 2; s++) {
		memcpy(m->film.eye[s], rig->globe[s].center, sizeof m->film.eye[s]);
		m->film.brow[s] = true;
		for (int j = 0; j < HAIR_CELLS_Y; j++)
			for (int i = 0; i < HAIR_CELLS_X; i++) {
				const double x = HAIR_FROM_X + HAIR_CELL * i, y = HAIR_FROM_Y + HAIR_CELL * j;
				m->film.cover[s][j][i] = x > patch_x[0] && x < patch_x[1] && y > patch_y[0] && y < patch_y[1] ? (float)part : 0;
				m->film.way[s][j][i] = (float)combed;
			}
	}
	return 0;
}

static int teardown(void **state)
{
	struct filmed *m = *state;
	driven_free(&m->on);
	free(m);
	return 0;
}

/* A hair's points in the front of its eye, mm of an eyeball of 12 mm: x outward, y up. */
static void front(double p[HAIR_LASH_POINTS][2], const struct hairs *h, const struct hair *hair, const struct rig *rig)
{
	float at[HAIR_LASH_POINTS][3];
	hair_place(at, h, hair, rig, (const float(*)[3])rig->rest);
	for (int k = 0; k < hair->n; k++)
		for (int c = 0; c < 2; c++)
			p[k][c] = (c == 0 && hair->side ? -1 : 1) * ((double)at[k][c] - rig->globe[hair->side].center[c]) * 12 / rig->globe[hair->side].radius;
}

/* Area of a hair there. */
static double area_of(const struct hair *hair, const double p[HAIR_LASH_POINTS][2], double unit, int k)
{
	return (double)(hair_half(hair, k) + hair_half(hair, k + 1)) / unit * hypot(p[k + 1][0] - p[k][0], p[k + 1][1] - p[k][1]);
}

static void brows_hide_what_the_film_shows(void **state)
{
	const struct filmed *m = *state;
	const struct rig *rig = &m->on.rig;
	struct hairs h;
	double area[2] = { 0 }, within = 0, all = 0, way = 0;
	hairs_grow(&h, rig, 0, &m->conf);
	for (int i = 0; i < h.n; i++) {
		const struct hair *hair = &h.hair[i];
		double p[HAIR_LASH_POINTS][2];
		if (hair->kind != HAIR_BROW)
			continue;
		front(p, &h, hair, rig);
		for (int k = 0; k + 1 < hair->n; k++) {
			const double a = area_of(hair, (const double(*)[2])p, rig->globe[hair->side].radius / 12, k), x = 0.5 * (p[k][0] + p[k + 1][0]), y = 0.5 * (p[k][1] + p[k + 1][1]);
			area[hair->side] += a;
			all += a;
			within += x > patch_x[0] - 1 && x < patch_x[1] + 1 && y > patch_y[0] - 1 && y < patch_y[1] + 1 ? a : 0;
			way += a * remainder(atan2(p[k + 1][1] - p[k][1], p[k + 1][0] - p[k][0]) - combed, 2 * M_PI);
		}
	}
	const double want = -log(1 - part) * (patch_x[1] - patch_x[0]) * (patch_y[1] - patch_y[0]);
	print_message("brows: %.1f and %.1f mm2 of hair for %.1f, %.0f %% in the film's place, combed %.3f rad off\n", area[0], area[1], want, 100 * within / all, way / all);
	for (int s = 0; s < 2; s++)
		NEAR(area[s] / want, 1, 0.12);
	assert_true(within > 0.85 * all);
	NEAR(way / all, -0.07, 0.1);  // hairs bend down a little
	hairs_free(&h);
}

/* Of a lid's lashes: area on a mm of the margin, which the eyeball's rims are, and mean distance from it. */
static struct hair_lid look(int *count, const struct hairs *h, const struct rig *rig, int kind)
{
	double area = 0, sum = 0, length = 0;
	*count = 0;
	for (int s = 0; s < 2; s++) {
		double rim[HAIR_RIMS][2];
		int n = 0;
		for (int i = 0; i < h->n_rims; i++) {
			const struct hair_rim *r = &h->rim[i];
			if (r->side != s)
				continue;
			for (int c = 0; c < 2; c++) {
				rim[n][c] = 0;
				for (int k = 0; k < 3; k++)
					rim[n][c] += (double)(r->weight[kind == HAIR_UPPER][k] * rig->rest[r->vertex[kind == HAIR_UPPER][k]][c]);
				rim[n][c] = (c == 0 && s ? -1 : 1) * (rim[n][c] - rig->globe[s].center[c]) * 12 / rig->globe[s].radius;
			}
			length += n ? hypot(rim[n][0] - rim[n - 1][0], rim[n][1] - rim[n - 1][1]) : 0;
			n++;
		}
		for (int i = 0; i < h->n; i++) {
			const struct hair *hair = &h->hair[i];
			double p[HAIR_LASH_POINTS][2];
			if (hair->kind != kind || hair->side != s)
				continue;
			++*count;
			front(p, h, hair, rig);
			for (int k = 0; k + 1 < hair->n; k++) {
				const double a = area_of(hair, (const double(*)[2])p, rig->globe[s].radius / 12, k);
				double near = INFINITY;
				for (int q = 0; q < n; q++)
					near = fmin(near, hypot(0.5 * (p[k][0] + p[k + 1][0]) - rim[q][0], 0.5 * (p[k][1] + p[k + 1][1]) - rim[q][1]));
				area += a;
				sum += a * near;
			}
		}
	}
	return (struct hair_lid){ area / (0.87 * length), sum / area };  // no lashes at the ends of a lid
}

/* A film in which lashes reach further or less far, and hide more or less, than the average's do: these go most of the way. */
static void lashes_reach_as_far(void **state)
{
	struct filmed *m = *state;
	struct hairs h;
	struct hair_conf plain = m->conf;
	static const double reach[] = { 1.25, 0.8, 1, 1 }, area[] = { 1.25, 0.8, 1.6, 0.6 };
	plain.film = 0;
	hairs_grow(&h, &m->on.rig, 0, &plain);
	for (int kind = HAIR_UPPER; kind <= HAIR_LOWER; kind++) {
		int n = 0;
		const struct hair_lid was = look(&n, &h, &m->on.rig, kind);
		for (int k = 0; k < (int)(sizeof reach / sizeof *reach); k++) {
			struct hairs other;
			int many = 0;
			m->film.lid[kind] = (struct hair_lid){ area[k] * was.area, reach[k] * was.reach };
			hairs_grow(&other, &m->on.rig, 0, &m->conf);
			const struct hair_lid is = look(&many, &other, &m->on.rig, kind);
			print_message("lashes %d: reach %.2f mm; film %.2f, then %.2f; hide %.2f; film %.2f, then %.2f; %d hairs, then %d\n", kind, was.reach, reach[k] * was.reach, is.reach,
			              was.area, area[k] * was.area, is.area, n, many);
			if (k < 2)
				NEAR(log(is.reach / was.reach) / log(reach[k]), 0.8, 0.35);
			else
				NEAR(log((double)many / n) / log(area[k]), 0.58, 0.25);
			hairs_free(&other);
			m->film.lid[kind] = (struct hair_lid){ 0, 0 };
		}
	}
	hairs_free(&h);
}

/* What the film does not show is the average adult's. */
static void average_where_it_shows_none(void **state)
{
	struct filmed *m = *state;
	struct hairs a, b;
	struct hair_conf plain = m->conf;
	plain.film = 0;
	m->film.brow[0] = m->film.brow[1] = false;
	hairs_grow(&a, &m->on.rig, 0, &plain);
	hairs_grow(&b, &m->on.rig, 0, &m->conf);
	assert_int_equal(a.n, b.n);
	assert_int_equal(a.n_points, b.n_points);
	assert_memory_equal(a.local, b.local, (size_t)a.n_points * sizeof *a.local);
	m->film.brow[0] = true;
	memset(m->film.cover, 0, sizeof m->film.cover);  // seen, and none there
	hairs_free(&b);
	hairs_grow(&b, &m->on.rig, 0, &m->conf);
	int brow[2] = { 0, 0 };
	for (int i = 0; i < b.n; i++)
		brow[b.hair[i].side] += b.hair[i].kind == HAIR_BROW;
	assert_int_equal(brow[0], 0);
	assert_true(brow[1] > 150);
	hairs_free(&a);
	hairs_free(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(brows_hide_what_the_film_shows),
		cmocka_unit_test(lashes_reach_as_far),
		cmocka_unit_test(average_where_it_shows_none),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
