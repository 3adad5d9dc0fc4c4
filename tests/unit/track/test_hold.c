/* A head held by its eyes: openings read off planes of evidence whose corners follow from a formula, and a path of the head read off corners that are projected here, by a
 * pinhole of this test's own.
 */
#include "base/mem.h"
#include "math/rng.h"
#include "track/clip/hold.h"
#include "tests/lib/unit.h"

enum { WIDE = 64, HIGH = 48 };

static struct evidence blank(double x0, double y0, double scale)
{
	struct evidence e = { .width = WIDE, .height = HIGH, .x0 = x0, .y0 = y0, .scale = scale };
	e.plane[0] = mem_new(EVIDENCE_CLASSES * WIDE * HIGH, sizeof(float));
	for (int c = 1; c < EVIDENCE_CLASSES; c++)
		e.plane[c] = e.plane[0] + c * WIDE * HIGH;
	return e;
}

/* An opening bounded by two parabolas through both corners, `up` and `down` px high in its middle, with edges `soft` px wide; an iris in its middle. */
struct lens { double from[2], to[2], up, down, soft; };

static void draw(struct evidence *e, const struct lens *l)
{
	const double wide = hypot(l->to[0] - l->from[0], l->to[1] - l->from[1]), u[2] = { (l->to[0] - l->from[0]) / wide, (l->to[1] - l->from[1]) / wide };
	for (int i = 0; i < WIDE * HIGH; i++) {
		const double x = e->x0 + (i % WIDE + 0.5) * e->scale - l->from[0], y = e->y0 + (i / WIDE + 0.5) * e->scale - l->from[1];
		const double a = x * u[0] + y * u[1], v = y * u[0] - x * u[1], bow = 4 * a * (wide - a) / (wide * wide);
		const double inside = fmin(v + l->up * bow, l->down * bow - v), chance = 1 / (1 + exp(-inside / l->soft));
		const bool iris = hypot(a - 0.5 * wide, v) < 0.2 * wide;
		const float eye = (float)(a > 0 && a < wide ? chance : 0), was = e->plane[EVIDENCE_SCLERA][i] + e->plane[EVIDENCE_IRIS][i];
		if (eye > was) {
			e->plane[EVIDENCE_SCLERA][i] = iris ? 0 : eye;
			e->plane[EVIDENCE_IRIS][i] = iris ? eye : 0;
		}
		e->plane[EVIDENCE_SKIN][i] = 1 - e->plane[EVIDENCE_SCLERA][i] - e->plane[EVIDENCE_IRIS][i];
	}
}

static void corners_of_an_opening(void **state)
{
	(void)state;
	for (int k = 0; k < 5; k++) {
		// an iris of 9 px radius: its opening 44 px wide, 16 high, leaning; and a brow's shine above
		const double lean = 0.2 * (k - 2), c = cos(lean), s = sin(lean), mid[2] = { 100.3, 80.7 + k };
		const struct lens eye = { { mid[0] - 22 * c, mid[1] - 22 * s }, { mid[0] + 22 * c, mid[1] + 22 * s }, 9, 7, 0.2 };
		const struct lens shine = { { mid[0] - 8, mid[1] - 17 }, { mid[0] + 8, mid[1] - 17 }, 2, 2, 0.2 };
		struct evidence e = blank(100 - WIDE * 0.45, 82 - HIGH * 0.45, 0.9);
		struct eye_told told;
		draw(&e, &shine);
		draw(&e, &eye);
		assert_true(eye_told_of(&told, &e, (double[3]){ 100, 82, 9 }, (double[2]){ c, s }));
		// where the parabolas are closer than their edges are wide nothing shows: at most 1.5 px short
		NEAR(told.corner[0][0], eye.from[0], 1.5);
		NEAR(told.corner[0][1], eye.from[1], 1.2);
		NEAR(told.corner[1][0], eye.to[0], 1.5);
		NEAR(told.corner[1][1], eye.to[1], 1.2);
		NEAR(told.corner[0][0] + told.corner[1][0], 2 * mid[0], 0.9);
		NEAR(told.area, 2.0 / 3 * 44 * 16 / 81, 0.4);
		evidence_free(&e);
	}
}

static void no_opening(void **state)
{
	(void)state;
	struct evidence e = blank(0, 0, 1);
	struct eye_told told;
	for (int i = 0; i < WIDE * HIGH; i++)
		e.plane[EVIDENCE_SKIN][i] = 1;
	assert_false(eye_told_of(&told, &e, (double[3]){ 32, 24, 9 }, (double[2]){ 1, 0 }));
	draw(&e, &(struct lens){ { 28, 24 }, { 34, 24 }, 1, 1, 0.1 });
	assert_false(eye_told_of(&told, &e, (double[3]){ 32, 24, 9 }, (double[2]){ 1, 0 }));
	evidence_free(&e);
}

enum { FRAMES = 120 };
static const double FOCAL = 900, FAR = 700, FPS = 30;

/* The head's true motion: shift in mm, lean in radians, and how near. */
struct motion { double x, y, lean, z; };

static struct motion motion_at(int f)
{
	const double t = f / FPS;
	return (struct motion){ 14 * sin(2 * t), 9 * sin(3 * t) - 4 * t, 0.12 * sin(1.5 * t), FAR - 25 * t };
}

/* Corner c of an eye, px, of an average opening behind a pinhole: written here, not by the library. */
static void corner_at(double px[2], const struct motion *m, int eye, int c)
{
	const double side = eye == SIDE_LEFT ? 1 : -1, x = side * (c ? 45 : 17), y = c ? 0.5 : -0.5;
	const double u = x * cos(m->lean) + y * sin(m->lean), v = x * sin(m->lean) - y * cos(m->lean);
	px[0] = 256 + FOCAL * (u + m->x) / m->z;
	px[1] = 200 + FOCAL * (v + m->y) / m->z;
}

static struct track_subject average(void)
{
	struct track_subject s = { .assumed = true, .radius = 12 };
	for (int e = 0; e < SIDES; e++) {
		const double side = e == SIDE_LEFT ? 1 : -1;
		struct eye_opening *o = &s.opening[e];
		o->open = true;
		o->center[0] = s.center[e][0] = 31.5 * side;
		for (int c = 0; c < 2; c++) {
			o->canthus[c][0] = side * (c ? 46.5 : 16.5);
			o->canthus[c][1] = c ? 0 : -1;
		}
	}
	return s;
}

/* The middle between the eyes in a pose: px, lean, distance. */
static void middle_of(double out[4], const double pose[4][4])
{
	out[0] = 256 + FOCAL * pose[0][3] / pose[2][3];
	out[1] = 200 + FOCAL * pose[1][3] / pose[2][3];
	out[2] = atan2(pose[1][0], pose[0][0]);
	out[3] = pose[2][3];
}

/* Noise of half a px, blinks, and an eye that is missed now and then. */
static void the_path_of_a_head(void **state)
{
	(void)state;
	struct track_subject subject = average();
	struct track_clip clip = { .camera = { .focal_px = FOCAL, .center_px = { 256, 200 } }, .cam_from_head = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, FAR }, { 0, 0, 0, 1 } } };
	struct hold *hold = hold_new(&clip, &subject, 5);
	struct rng rng = { 5 };
	double (*poses)[4][4] = mem_new(FRAMES, sizeof *poses), guess[4][4], now[4], px[2];
	for (int f = -1; f < FRAMES; f++) {
		struct eye_told told[SIDES];
		const struct eye_told *known[SIDES];
		const struct motion m = f < 0 ? (struct motion){ .z = FAR } : motion_at(f);
		const bool blink = f >= 40 && f < 46;
		for (int e = 0; e < SIDES; e++) {
			told[e].area = blink ? 1 : 6;
			for (int c = 0; c < 2; c++) {
				corner_at(px, &m, e, c);
				for (int k = 0; k < 2; k++)
					told[e].corner[c][k] = px[k] + 0.5 * rng_normal(&rng);
			}
			known[e] = f % 17 == 3 && e == 1 ? 0 : &told[e];
		}
		hold_push(hold, known, 0, FOCAL * 5.85 / m.z, f < 0 ? 0 : 1 / FPS, f >= 0);
		// skin that was lost: far from where the eyes are
		hold_guess(guess, hold, (const double[4][4]){ { 1, 0, 0, 300 }, { 0, -1, 0, 0 }, { 0, 0, -1, FAR }, { 0, 0, 0, 1 } });
		middle_of(now, (const double(*)[4])guess);
		// on the way it lags by a frame or two, and stands still in a blink
		if (f > 5 && !(f >= 40 && f < 50))
			NEAR(hypot(now[0] - 256 - FOCAL * m.x / m.z, now[1] - 200 - FOCAL * m.y / m.z), 0, 3.5);
	}
	struct hold_known told;
	hold_settle(&told, poses, FRAMES, hold, false);
	double sum[4] = { 0 }, square[4] = { 0 };
	for (int f = 0; f < FRAMES; f++) {
		const struct motion m = motion_at(f);
		middle_of(now, (const double(*)[4])poses[f]);
		const double off[4] = { now[0] - 256 - FOCAL * m.x / m.z, now[1] - 200 - FOCAL * m.y / m.z, now[2] - m.lean, log(now[3] / m.z) };
		for (int k = 0; k < 4; k++) {
			sum[k] += off[k] / FRAMES;
			square[k] += off[k] * off[k] / FRAMES;
		}
	}
	// where corners lie about an eyeball is its own assumption, and shifts all frames alike
	for (int k = 0; k < 4; k++)
		square[k] -= sum[k] * sum[k];
	NEAR(sqrt(square[0]), 0, 0.5);
	NEAR(sqrt(square[1]), 0, 0.5);
	NEAR(sqrt(square[2]), 0, 0.008);
	NEAR(sqrt(square[3]), 0, 0.012);
	// half a px, less for two corners
	NEAR(told.place_mm, 0.35 * FAR / FOCAL, 0.2);
	// nothing told how it is turned
	for (int k = 0; k < TURNS; k++)
		assert_true(told.turn[k] > 0.2);
	hold_free(hold);
	free(poses);
}

/* A head that turns from side to side and nods, as its face tells, to 2 degrees and with more in some frames; its corners are those of an average opening, turned here. */
static void a_head_that_turns(void **state)
{
	(void)state;
	struct track_subject subject = average();
	struct track_clip clip = { .camera = { .focal_px = FOCAL, .center_px = { 256, 200 } }, .cam_from_head = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, FAR }, { 0, 0, 0, 1 } } };
	struct hold *hold = hold_new(&clip, &subject, 5);
	struct rng rng = { 9 };
	double (*poses)[4][4] = mem_new(FRAMES, sizeof *poses), square[TURNS] = { 0 }, place = 0;
	struct hold_known known;
	const double sigma[TURNS] = { 0.07, 0.06 };
	for (int f = 0; f < FRAMES; f++) {
		struct eye_told told[SIDES];
		const double aside = 0.4 * sin(2 * M_PI * f / FRAMES), nod = 0.2 * sin(4 * M_PI * f / FRAMES);
		for (int e = 0; e < SIDES; e++) {
			told[e].area = 6;
			for (int c = 0; c < 2; c++) {
				const double *at = subject.opening[e].canthus[c], y = at[1] * cos(nod), z = at[1] * sin(nod);
				const double u = at[0] * cos(aside) + z * sin(aside), away = FAR + at[0] * sin(aside) - z * cos(aside);
				told[e].corner[c][0] = 256 + FOCAL * (u + 20) / away;
				told[e].corner[c][1] = 200 - FOCAL * (y - 10) / away;
			}
		}
		// against the line of sight to 20 and 10 mm off the axis
		struct head_turn turn = { { aside + 20 / FAR + 0.035 * rng_normal(&rng), nod + 10 / FAR + 0.035 * rng_normal(&rng) }, { sigma[0], sigma[1] }, 0.05 };
		if (f % 20 == 7)
			turn.angle[TURN_ASIDE] += 1;
		hold_push(hold, (const struct eye_told *[SIDES]){ &told[0], &told[1] }, &turn, FOCAL * 5.85 / FAR, f ? 1 / FPS : 0, true);
	}
	hold_settle(&known, poses, FRAMES, hold, false);
	for (int f = 0; f < FRAMES; f++) {
		const double aside = 0.4 * sin(2 * M_PI * f / FRAMES), nod = 0.2 * sin(4 * M_PI * f / FRAMES);
		double fick[3];
		head_fick(fick, (const double(*)[4])poses[f]);
		// out of the face: (sin a cos n, -sin n, cos a cos n)
		square[0] += pow(fick[0] - atan2(sin(aside) * cos(nod), cos(aside) * cos(nod)), 2) / FRAMES;
		square[1] += pow(fick[1] - asin(-sin(nod)), 2) / FRAMES;
		place += (pow(poses[f][0][3] - 20, 2) + pow(poses[f][2][3] - FAR, 2) / 400) / FRAMES;
	}
	NEAR(sqrt(square[0]), 0, 0.025);
	NEAR(sqrt(square[1]), 0, 0.025);
	// its own assumption of where corners lie apart
	NEAR(sqrt(place), 0, 1.5);
	for (int k = 0; k < TURNS; k++)
		NEAR(known.turn[k], sigma[k], 1e-6);
	hold_free(hold);
	free(poses);
}

/* Eyes that are found in all of a picture are taken where they may be this head's: their place, lean and distance; and not where they cannot. */
static void found_again(void **state)
{
	(void)state;
	struct track_subject subject = average();
	struct track_clip clip = { .camera = { .focal_px = FOCAL, .center_px = { 256, 200 } }, .cam_from_head = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, FAR }, { 0, 0, 0, 1 } } };
	// middle, px; half the eyes' distance, px; lean
	const struct { double at[2], half, lean; bool is; } found[] = { { { 400, 120 }, 43, 0.15, true }, { { 256, 200 }, 90, 0, false }, { { 256, 200 }, 40, 0.9, false } };
	for (int i = 0; i < (int)(sizeof found / sizeof *found); i++) {
		struct hold *hold = hold_new(&clip, &subject, 5);
		struct eye_told told[SIDES];
		double now[4], guess[4][4];
		for (int f = -1; f < 5; f++) {
			for (int e = 0; e < SIDES; e++) {
				told[e].area = 6;
				for (int c = 0; c < 2; c++)
					corner_at(told[e].corner[c], &(struct motion){ .z = FAR }, e, c);
			}
			hold_push(hold, (const struct eye_told *[SIDES]){ &told[0], &told[1] }, 0, FOCAL * 5.85 / FAR, f < 0 ? 0 : 1 / FPS, f >= 0);
		}
		const double x = found[i].half * cos(found[i].lean), y = found[i].half * sin(found[i].lean);
		hold_found(hold, (const double[SIDES][2]){ { found[i].at[0] + x, found[i].at[1] + y }, { found[i].at[0] - x, found[i].at[1] - y } });
		hold_guess(guess, hold, (const double[4][4]){ { 1, 0, 0, 300 }, { 0, -1, 0, 0 }, { 0, 0, -1, FAR }, { 0, 0, 0, 1 } });
		middle_of(now, (const double(*)[4])guess);
		NEAR(now[0], found[i].is ? found[i].at[0] : 256, 2.5);
		NEAR(now[1], found[i].is ? found[i].at[1] : 200, 2.5);
		NEAR(now[2], found[i].is ? found[i].lean : 0, 0.02);
		NEAR(now[3], found[i].is ? FAR * FOCAL * 31.5 / FAR / found[i].half : FAR, 40);  // where corners lie about an eyeball is its own assumption
		hold_free(hold);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(corners_of_an_opening),
		cmocka_unit_test(no_opening),
		cmocka_unit_test(the_path_of_a_head),
		cmocka_unit_test(a_head_that_turns),
		cmocka_unit_test(found_again),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
