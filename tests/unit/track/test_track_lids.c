/* How the stage `track` finishes margins, against closed forms: the eye's end by colours, skin beside a place, corners of the eye, lids in blinks. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "track/lid/fine.h"
#include "track/clip/beside.h"
#include "track/clip/blink_lower.h"
#include "track/clip/blink_upper.h"
#include "track/clip/corners.h"
#include "tests/lib/unit.h"

enum { W = 400, H = 260, FILM = 12, POINTS = 20 };
static const double px_mm = 10;

/* Where the eye ends in the painted film. */
static double end_of(double x)
{
	return 70 + (x - 200) * (x - 200) / 300;
}

static void paint(uint8_t *rgb, double iris_x, struct rng *rng)
{
	static const uint8_t skin[3] = { 176, 116, 92 }, white[3] = { 225, 215, 210 }, black[3] = { 20, 18, 16 }, amber[3] = { 180, 118, 90 }, green[3] = { 90, 110, 80 };
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double r = hypot(x + 0.5 - iris_x, y + 0.5 - 120) / 58;
			// round the pupil the iris has the very colour of skin
			const uint8_t *eye = r < 0.35 ? black : r < 0.75 ? amber : r < 1 ? green : white;
			double share = fmin(1, fmax(0, y + 1 - end_of(x + 0.5)));
			for (int c = 0; c < 3; c++) {
				double v = skin[c] + share * (eye[c] - skin[c]) + 8 * (rng_uniform(rng) - 0.5);
				rgb[3 * (y * W + x) + c] = (uint8_t)fmax(0, fmin(255, v));
			}
		}
}

/* A margin that is half a millimetre off where it crosses the iris. It is found, also where the iris is as the skin is. */
static void the_eye_ends(void **state)
{
	(void)state;
	struct rng rng = { 5 };
	uint8_t *rgb = mem_new((size_t)W * H * 3, 1);
	struct lid_picture picture = { rgb, 3 * W, W, H };
	struct lid_fine *look = mem_new(FILM, sizeof *look);
	struct lid_fine_frame *frame = mem_new(FILM, sizeof *frame);
	for (int f = 0; f < FILM; f++) {
		double margin[POINTS][2], iris = 140 + 10 * f;
		paint(rgb, iris, &rng);
		for (int i = 0; i < POINTS; i++) {
			double x = 40 + 320.0 * i / (POINTS - 1), off = 5 * exp(-pow((x - iris) / 40, 2));
			margin[i][0] = x;
			margin[i][1] = end_of(x) + off;
		}
		lid_fine_look(&look[f], 0, POINTS, (const double(*)[2])margin, px_mm, &picture);
		assert_true(look[f].known);
		frame[f] = (struct lid_fine_frame){ .look = &look[f], .iris = { iris, 120, 58 } };
	}
	lid_fine_settle(FILM, frame);
	double before = 0, after = 0;
	int n = 0;
	for (int f = 0; f < FILM; f++)
		for (int k = FINE_COLS / 6; k < FINE_COLS - FINE_COLS / 6; k++) {
			double p[2];
			for (int c = 0; c < 2; c++)
				p[c] = (double)look[f].p[k][c] + frame[f].end[k] * (double)look[f].out[k][c];
			before += pow((double)look[f].p[k][1] - end_of((double)look[f].p[k][0]), 2);
			after += pow(p[1] - end_of(p[0]), 2);
			n++;
		}
	print_message("the eye's end: %.2f px before, %.2f px after\n", sqrt(before / n), sqrt(after / n));
	assert_true(sqrt(before / n) > 2);
	// a third of a pixel: cells are that far apart
	assert_true(sqrt(after / n) < 0.4);
	free(rgb);
	free(look);
	free(frame);
}

enum { FRAMES = 60, SKIN = 40 };

/* A clip of a head that rests, 500 mm away; a row of skin so far (mm) below the corners of an eye. */
struct scene {
	struct track_result r;
	struct track_clip clip;
	struct track_points points;
};

static void scene_make(struct scene *s, double below)
{
	*s = (struct scene){ 0 };
	struct track_result *r = &s->r;
	r->n = FRAMES;
	r->n_points = s->points.n = SKIN;
	r->lost_at = mem_new(FRAMES, sizeof *r->lost_at);
	r->pose = mem_new(FRAMES, sizeof *r->pose);
	r->skin = mem_new((size_t)FRAMES * SKIN, sizeof *r->skin);
	r->confidence = mem_new((size_t)FRAMES * SKIN, sizeof *r->confidence);
	r->eyes.state = mem_new(FRAMES, sizeof *r->eyes.state);
	r->eyes.globe[0].seen = r->has_eyes = true;
	s->clip.camera = (struct camera){ .focal_px = 2000, .center_px = { 640, 360 } };
	s->points.head = mem_new(SKIN, sizeof *s->points.head);
	static const double pose[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, 500 }, { 0, 0, 0, 1 } };
	memcpy(s->clip.cam_from_head, pose, sizeof pose);
	for (int f = 0; f < FRAMES; f++) {
		memcpy(r->pose[f], pose, sizeof pose);
		r->eyes.state[f][0] = (struct eye_state){ .gaze = { 0.2 * sin(0.3 * f + 0.7), 0.1 * cos(0.4 * f) }, .openness = 1, .blink = BLINK_OPEN };
	}
	for (int i = 0; i < SKIN; i++) {
		s->points.head[i][0] = -16 + 32.0 * i / (SKIN - 1);
		s->points.head[i][1] = -below;
	}
}

static void scene_free(struct scene *s)
{
	free(s->r.lost_at);
	free(s->r.pose);
	free(s->r.skin);
	free(s->r.confidence);
	free(s->r.eyes.state);
	free(s->points.head);
}

/* All skin goes by a px for each radian of gaze to the side, and by `drop` px in frame 30. */
static void move_skin(struct scene *s, const double a[2], double drop)
{
	for (int f = 0; f < FRAMES; f++)
		for (int i = 0; i < SKIN; i++) {
			double px[2];
			assert_true(head_project(px, &s->clip.camera, s->r.pose[f], s->points.head[i]));
			s->r.confidence[f * SKIN + i] = 1;
			for (int k = 0; k < 2; k++)
				s->r.skin[f * SKIN + i][k] = (float)(px[k] + a[k] * s->r.eyes.state[f][0].gaze[0] + (k && f == 30 ? drop : 0));
		}
}

/* Skin that goes with the gaze has not moved where the eye looks straight on, wherever it looks in the reference frame; a place that no skin is near has
 * nobody's word. */
static void skin_beside_a_place(void **state)
{
	(void)state;
	struct scene s;
	scene_make(&s, 5);
	static const double places[3][3] = { { -14, -5, 0 }, { 0, 60, 0 }, { 14, -5, 0 } }, a[2] = { 20, -8 };
	move_skin(&s, a, 3);
	for (int e = 0; e < FRAMES; e++)
		s.r.confidence[e * SKIN] = 0;
	struct beside b = beside_new(3, places, &s.r, 0, &s.clip, &s.points);
	for (int f = 0; f < FRAMES; f++) {
		for (int k = 0; k < 2; k++) {
			// half a pixel: a gaze of 0.01 rad does not determine a slope, and the prior draws it towards none
			NEAR(beside_moved(&b, 0, f)[k], a[k] * s.r.eyes.state[f][0].gaze[0] + (k && f == 30 ? 3 : 0), 0.05);
			NEAR(beside_moved(&b, 1, f)[k], 0, 0);
		}
		NEAR(beside_weight(&b, 0, f), 1, 1e-12);
		NEAR(beside_weight(&b, 1, f), 0, 0);
	}
	beside_free(&b);
	scene_free(&s);
}

/* Frames in which the skin is not seen are filled in between those before and after. */
static void unseen_skin_goes_evenly(void **state)
{
	(void)state;
	struct scene s;
	scene_make(&s, 5);
	move_skin(&s, (const double[]){ 0, 0 }, 0);
	for (int f = 0; f < FRAMES; f++)
		for (int i = 0; i < SKIN; i++) {
			s.r.skin[f * SKIN + i][0] += f < 20 ? 0 : 6;
			s.r.confidence[f * SKIN + i] = f < 20 || f >= 26;
		}
	struct beside b = beside_new(2, (const double[][3]){ { -14, -5, 0 }, { 14, -5, 0 } }, &s.r, 0, &s.clip, &s.points);
	for (int f = 19; f <= 26; f++)
		NEAR(beside_moved(&b, 1, f)[0] - beside_moved(&b, 1, 19)[0], 6.0 * (f - 19) / 7, 1e-3);
	beside_free(&b);
	scene_free(&s);
}

/* Skin that is seen in a few frames alone, in the first of them as another patch: that one is not carried into all frames before. */
static void few_frames_of_skin(void **state)
{
	(void)state;
	struct scene s;
	scene_make(&s, 5);
	move_skin(&s, (const double[]){ 0, 0 }, 0);
	for (int f = 0; f < FRAMES; f++)
		for (int i = 0; i < SKIN; i++) {
			s.r.skin[f * SKIN + i][1] += f == 25 ? 40 : 0;
			s.r.confidence[f * SKIN + i] = f >= 25 && f < 35;
		}
	s.clip.reference = 30;
	struct beside b = beside_new(2, (const double[][3]){ { -14, -5, 0 }, { 14, -5, 0 } }, &s.r, 0, &s.clip, &s.points);
	for (int f = 0; f < FRAMES; f++)
		for (int e = 0; e < 2; e++)
			NEAR(beside_moved(&b, e, f)[1], 0, 0.1);
	beside_free(&b);
	scene_free(&s);
}

/* An opening 30 mm wide on a plane, counter-clockwise. */
static struct eye_opening lens(void)
{
	struct eye_opening o = { .open = true };
	for (int i = 0; i < OPENING_POINTS; i++) {
		double t = 2 * M_PI * (i + 0.5) / OPENING_POINTS;
		o.edge[i][0] = 15 * cos(t);
		o.edge[i][1] = (sin(t) > 0 ? 6 : 4) * sin(t);
	}
	o.canthus[0][0] = -15;
	o.canthus[1][0] = 15;
	return o;
}

static double off_lens(const struct eye_opening *o, const double p[2], const struct scene *s)
{
	struct line line = { 0 };
	double px[2], q[2];
	for (int i = 0; i <= OPENING_POINTS; i++) {
		head_project(px, &s->clip.camera, s->clip.cam_from_head, o->edge[i % OPENING_POINTS]);
		line_add(&line, px);
	}
	line_nearest(q, &line, p);
	return hypot(q[0] - p[0], q[1] - p[1]);
}

/* Margins as they are on the mesh between the corners, and nonsense beyond: the mesh sets the ends right, and they go where the skin beside them does. */
static void corners_are_the_meshs(void **state)
{
	(void)state;
	struct scene s;
	struct track_subject subject = { 0 };
	scene_make(&s, 0);
	move_skin(&s, (const double[]){ 0, 0 }, 4);
	subject.margin[0] = lens();
	for (int f = 0; f < FRAMES; f++) {
		struct eye_state *e = &s.r.eyes.state[f][0];
		e->lid_points = 20;
		for (int k = 0; k < LIDS; k++)
			for (int i = 0; i < 20; i++) {
				double x = -15 + 30.0 * i / 19, y = (k ? -4 : 6) * sqrt(fmax(0, 1 - x * x / 225));
				head_project(e->lid[k][i], &s.clip.camera, s.clip.cam_from_head, (const double[]){ x, y, 0 });
				e->lid[k][i][1] += (f == 30 ? 4 : 0) + (i < 1 || i > 18 ? 9 : 0);
			}
	}
	track_corners(&s.r, &s.clip, &subject, &s.points);
	for (int f = 0; f < FRAMES; f++)
		for (int k = 0; k < LIDS; k++)
			for (int i = 0; i < 20; i++) {
				double p[2] = { s.r.eyes.state[f][0].lid[k][i][0], s.r.eyes.state[f][0].lid[k][i][1] - (f == 30 ? 4 : 0) };
				// chords of control points 6 px apart on an end of 5 px radius
				assert_true(off_lens(&subject.margin[0], p, &s) < 1.2);
			}
	scene_free(&s);
}

/* A lower margin found amid lashes is put where the head has taken that of the open eye. */
static void blinks_hold_lower_lids(void **state)
{
	(void)state;
	enum { PLACES = 5 };
	struct scene s;
	scene_make(&s, 5);
	double carried[FRAMES][PLACES][2];
	for (int f = 0; f < FRAMES; f++) {
		struct eye_state *e = &s.r.eyes.state[f][0];
		bool shut = (f >= 20 && f < 30) || f >= 55;
		e->blink = shut ? BLINK_CLOSED : BLINK_OPEN;
		e->lid_points = 20;
		for (int i = 0; i < 20; i++) {
			e->lid[LID_UPPER][i][1] = 50 + f;
			e->lid[LID_LOWER][i][0] = 10 * i + 0.5 * f;
			e->lid[LID_LOWER][i][1] = shut ? 300 : 100 + i + (f >= 30 ? 2 : 0);
		}
		for (int i = 0; i < PLACES; i++) {
			carried[f][i][0] = 50 * i + 0.5 * f;
			carried[f][i][1] = 100;
		}
	}
	blink_lower_carry(&s.r, 0, PLACES, (const double(*)[2])carried[0]);
	for (int f = 0; f < FRAMES; f++)
		for (int i = 0; i < 20; i++) {
			double share = f < 20 ? 0 : f < 30 ? (f - 19) / 11.0 : 1;
			NEAR(s.r.eyes.state[f][0].lid[LID_LOWER][i][0], 10 * i + 0.5 * f, 1e-9);
			NEAR(s.r.eyes.state[f][0].lid[LID_LOWER][i][1], 100 + i + 2 * share, 1e-9);
			NEAR(s.r.eyes.state[f][0].lid[LID_UPPER][i][1], 50 + f, 0);
		}
	scene_free(&s);
}

/* An upper margin that falls as a share of the way from its open arc to the lower one: where lashes drag what is found down, and the corner with it, it is put
 * where the rest of it is. The head takes all along. */
static void blinks_fall_evenly(void **state)
{
	(void)state;
	enum { PLACES = 2, WIDE = 400, UP = 60, LOW = 25 };
	struct scene s;
	scene_make(&s, 5);
	double carried[FRAMES][PLACES][2], corner[FRAMES][2][2];
	for (int f = 0; f < FRAMES; f++) {
		struct eye_state *e = &s.r.eyes.state[f][0];
		bool shut = f >= 20 && f < 30;
		double closure = shut ? 1 - fabs(f - 24.5) / 5 : 0, x0 = 100 + 0.5 * f, y0 = 200;
		e->blink = shut ? BLINK_CLOSING : BLINK_OPEN;
		e->lid_points = 20;
		for (int i = 0; i < 20; i++) {
			double u = i / 19.0, bow = 4 * u * (1 - u), dragged = shut && u > 0.7 ? 30 : 0;
			for (int k = 0; k < LIDS; k++)
				e->lid[k][i][0] = x0 + WIDE * u;
			e->lid[LID_UPPER][i][1] = y0 + bow * ((1 - closure) * -UP + closure * LOW) + dragged;
			e->lid[LID_LOWER][i][1] = y0 + bow * LOW;
		}
		for (int c = 0; c < 2; c++) {
			carried[f][c][0] = x0 + c * WIDE;
			carried[f][c][1] = y0 + 3;
			corner[f][c][0] = x0 + c * WIDE + (shut && c ? 45 : 0);
			corner[f][c][1] = y0 + (shut && c ? 45 : 0);
		}
	}
	blink_upper_carry(&s.r, 0, corner, PLACES, (const double(*)[2])carried[0], 4);
	for (int f = 0; f < FRAMES; f++) {
		const struct eye_state *e = &s.r.eyes.state[f][0];
		bool shut = f >= 20 && f < 30;
		double closure = shut ? 1 - fabs(f - 24.5) / 5 : 0, x0 = 100 + 0.5 * f;
		for (int c = 0; c < 2; c++) {
			NEAR(corner[f][c][0], x0 + c * WIDE, 1e-9);
			NEAR(corner[f][c][1], 200, 1e-9);
		}
		for (int i = 0; i < 20; i++) {
			double u = (e->lid[LID_UPPER][i][0] - x0) / WIDE, want = 200 + 4 * u * (1 - u) * ((1 - closure) * -UP + closure * LOW);
			// chords between control points of an arc; what drags leaves 30 px / (1 + 7.5^4)
			NEAR(e->lid[LID_UPPER][i][1], want, 0.3);
		}
	}
	scene_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_eye_ends), cmocka_unit_test(skin_beside_a_place), cmocka_unit_test(unseen_skin_goes_evenly),
		cmocka_unit_test(few_frames_of_skin),
		cmocka_unit_test(corners_are_the_meshs), cmocka_unit_test(blinks_hold_lower_lids), cmocka_unit_test(blinks_fall_evenly),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
