/* Hair cards: they turn as wholes with the skin that they stand on. Truth: a rotation, and a plane that is rolled onto a cylinder, in closed form. */
#include "math/vec.h"
#include "rig/deform/cards.h"
#include "rig/deform/carry.h"
#include "rig/deform/room.h"
#include "tests/lib/unit.h"

enum { SIDE = 41, GRID = SIDE * SIDE, CARD = 8, STRIP = 34, FILM = 8, MOST = GRID + 3 * CARD + STRIP + FILM };
static const float cell = 1;            // mm
static const double rolled = 30;        // radius of the cylinder, mm

/* A patch of skin before an eye, in the plane z = 0, and what stands on it; first row of each. */
struct scene {
	struct rig rig;
	int card, still, far, strip, film;
	bool moves[MOST];
};

static int add_vertex(struct rig *rig, float x, float y, float z)
{
	rig->rest[rig->n][0] = x;
	rig->rest[rig->n][1] = y;
	rig->rest[rig->n][2] = z;
	return rig->n++;
}

static void add_quad(struct rig *rig, int a, int b, int c, int d)
{
	memcpy(rig->faces[rig->n_faces++], (int32_t[]){ a, b, c }, sizeof *rig->faces);
	memcpy(rig->faces[rig->n_faces++], (int32_t[]){ c, b, d }, sizeof *rig->faces);
}

/* A band of two rows' width, from root to tip: at x, leaning towards +x, 1 mm wide along y. */
static int add_card(struct rig *rig, float x, float y)
{
	const int first = rig->n;
	for (int k = 0; k < CARD / 2; k++)
		for (int side = 0; side < 2; side++)
			add_vertex(rig, x + 0.5f * (float)k, y + (float)side, 0.05f + 2 * (float)k);
	for (int k = 0; k + 1 < CARD / 2; k++)
		add_quad(rig, first + 2 * k, first + 2 * k + 1, first + 2 * k + 2, first + 2 * k + 3);
	return first;
}

static void make(struct scene *s)
{
	struct rig *rig = &s->rig;
	*s = (struct scene){ 0 };
	rig->rest = calloc(MOST, sizeof *rig->rest);
	rig->faces = calloc(3 * MOST, sizeof *rig->faces);
	rig->part = calloc(MOST, 1);
	rig->side = calloc(MOST, 1);
	for (int i = 0; i < 2; i++)
		rig->globe[i] = (struct rig_globe){ .center = { 0, 0, -13 }, .radius = 12 };
	for (int i = 0; i < GRID; i++)
		add_vertex(rig, cell * (float)(i % SIDE - SIDE / 2), cell * (float)(i / SIDE - SIDE / 2), 0);
	for (int i = 0; i < GRID; i++)
		if (i % SIDE + 1 < SIDE && i / SIDE + 1 < SIDE)
			add_quad(rig, i, i + 1, i + SIDE, i + SIDE + 1);
	s->card = add_card(rig, 5, 3);
	s->still = add_card(rig, -5, 3);
	s->far = add_card(rig, 0, 3);
	for (int i = s->far; i < rig->n; i++)
		rig->rest[i][2] += 3;  // it hangs in the air
	s->strip = rig->n;  // as lashes in one piece: 16 mm along x
	for (int k = 0; k < STRIP / 2; k++) {
		add_vertex(rig, (float)(k - STRIP / 4), -6, 0.05f);
		add_vertex(rig, (float)(k - STRIP / 4), -6, 6);
		if (k)
			add_quad(rig, rig->n - 4, rig->n - 2, rig->n - 3, rig->n - 1);
	}
	s->film = rig->n;  // as tears: it lies on the skin
	for (int k = 0; k < FILM / 2; k++) {
		add_vertex(rig, (float)k, -12, 0.1f);
		add_vertex(rig, (float)k, -11.5f, 0.4f);
		if (k)
			add_quad(rig, rig->n - 4, rig->n - 2, rig->n - 3, rig->n - 1);
	}
	assert_int_equal(rig->n, MOST);
	for (int i = 0; i < MOST; i++)
		s->moves[i] = i < s->still || i >= s->still + CARD;
	for (int i = s->strip; i < s->film; i++)
		rig->part[i] = RIG_NEAR_EYE;
}

static void unmake(struct scene *s)
{
	free(s->rig.rest);
	free(s->rig.faces);
	free(s->rig.part);
	free(s->rig.side);
}

/* Skin from x, cards from nonsense. */
static void carry(float (*x)[3], const struct scene *s)
{
	struct deform_cards cards = deform_cards_of(&s->rig, s->moves);
	struct deform_rooms *rooms = deform_rooms_new(s->rig.n);
	assert_int_equal(cards.n, CARD + STRIP);
	for (int i = GRID; i < s->rig.n; i++)
		for (int c = 0; c < 3; c++)
			x[i][c] = 100;
	deform_carry(x, &cards, &s->rig, rooms);
	deform_rooms_free(rooms);
	deform_cards_free(&cards);
}

static void what_does_not_stand_stays(void **state)
{
	struct scene s;
	(void)state;
	make(&s);
	float (*x)[3] = calloc(MOST, sizeof *x);
	memcpy(x, s.rig.rest, MOST * sizeof *x);
	carry(x, &s);
	for (int i = GRID; i < s.rig.n; i++) {
		const bool carried = (i >= s.card && i < s.card + CARD) || (i >= s.strip && i < s.film);
		for (int c = 0; c < 3; c++)
			NEAR(x[i][c], carried ? s.rig.rest[i][c] : 100, 1e-5);  // single precision; at rest all is as it was
	}
	free(x);
	unmake(&s);
}

static void skin_that_turns_turns_them(void **state)
{
	static const double turn[3][3] = { { 0.36, 0.48, -0.8 }, { -0.8, 0.6, 0 }, { 0.48, 0.64, 0.6 } }, by[3] = { 5, -7, 3 };
	struct scene s;
	(void)state;
	make(&s);
	float (*x)[3] = calloc(MOST, sizeof *x), (*want)[3] = calloc(MOST, sizeof *want);
	for (int i = 0; i < MOST; i++)
		for (int c = 0; c < 3; c++)
			want[i][c] = (float)(turn[c][0] * s.rig.rest[i][0] + turn[c][1] * s.rig.rest[i][1] + turn[c][2] * s.rig.rest[i][2] + by[c]);
	memcpy(x, want, MOST * sizeof *x);
	carry(x, &s);
	for (int i = s.card; i < s.film; i++)
		for (int c = 0; c < 3 && (i < s.still || i >= s.strip); c++)
			NEAR(x[i][c], want[i][c], 2e-5);
	free(x);
	free(want);
	unmake(&s);
}

/* Where the skin's place u, and what is d beside it and z above, comes to as the plane is rolled. */
static void roll(double out[3], double u, double d, double y, double z)
{
	const double a = u / rolled;
	out[0] = (rolled + z) * sin(a) + d * cos(a);
	out[1] = y;
	out[2] = (rolled + z) * cos(a) - d * sin(a) - rolled;
}

static void rolled_skin_turns_each_by_its_own(void **state)
{
	struct scene s;
	double worst[2] = { 0 };
	(void)state;
	make(&s);
	float (*x)[3] = calloc(MOST, sizeof *x);
	for (int i = 0; i < GRID; i++) {
		double at[3];
		roll(at, s.rig.rest[i][0], 0, s.rig.rest[i][1], 0);
		for (int c = 0; c < 3; c++)
			x[i][c] = (float)at[c];
	}
	carry(x, &s);
	for (int i = s.card; i < s.film; i++) {
		const bool strip = i >= s.strip;
		const float *r = s.rig.rest[i];
		double want[3], d[3];
		if (i >= s.still && !strip)
			continue;
		roll(want, strip ? (double)r[0] : 5, strip ? 0 : (double)r[0] - 5, r[1], r[2]);
		for (int c = 0; c < 3; c++)
			d[c] = (double)x[i][c] - want[c];
		worst[strip] = fmax(worst[strip], vec_norm(d));
	}
	print_message("a card on rolled skin: %.4f mm off, lashes of one piece %.4f\n", worst[0], worst[1]);
	assert_true(worst[0] < 0.005);  // the patch is as much on either side
	assert_true(worst[1] < 0.1);  // neighbouring roots lead a tip, too: 6 mm off they turn by 0.2 mm, and an end has them on one side
	free(x);
	unmake(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(what_does_not_stand_stays), cmocka_unit_test(skin_that_turns_turns_them), cmocka_unit_test(rolled_skin_turns_each_by_its_own) };
	return cmocka_run_group_tests(tests, 0, 0);
}
