/* Outlines of openings in drawn evidence, and margins drawn to outlines. Truth: closed forms.
 */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/unit.h"
#include "track/clip/to_outlines.h"

enum { WIDE = 128, HIGH = 80, POINTS = 20, FRAMES = 120 };
static const double radius = 40, scale = 2, half = 110, up = 40, low = 22;  // px: iris; a pixel of the planes; half the opening's width, its heights

/* An opening about (200, 150), leaning: its axes, and the height of a margin at the share u of the half width. */
static const double middle[2] = { 200, 150 };
static void axes(double across[2], double down[2], int side, double lean)
{
	const double way = side == SIDE_LEFT ? 1 : -1;
	across[0] = way * cos(lean);
	across[1] = way * sin(lean);
	down[0] = -sin(lean);
	down[1] = cos(lean);
}

static double height(int lid, double u)
{
	return (lid == LID_UPPER ? -up : low) * (1 - u * u);
}

/* Evidence of it: eye within, with a soft edge. open: share of its height. */
static struct evidence draw_opening(const double across[2], const double down[2], double open)
{
	struct evidence e = { .width = WIDE, .height = HIGH, .x0 = middle[0] - 0.5 * WIDE * scale, .y0 = middle[1] - 0.5 * HIGH * scale, .scale = scale };
	const long n = WIDE * HIGH;
	float *planes = mem_new(EVIDENCE_CLASSES * (size_t)n, sizeof *planes);
	for (int c = 0; c < EVIDENCE_CLASSES; c++)
		e.plane[c] = planes + c * n;
	for (long i = 0; i < n; i++) {
		const double x = e.x0 + ((double)(i % WIDE) + 0.5) * scale - middle[0], y = e.y0 + ((double)(i / WIDE) + 0.5) * scale - middle[1];
		const double u = (x * across[0] + y * across[1]) / half, v = x * down[0] + y * down[1];
		const double inside = fabs(u) < 1 ? fmin(v - open * height(LID_UPPER, u), open * height(LID_LOWER, u) - v) : -9;
		e.plane[EVIDENCE_SCLERA][i] = (float)fmin(1, fmax(0, 0.5 + inside / (4 * scale)));
		e.plane[EVIDENCE_SKIN][i] = 1 - e.plane[EVIDENCE_SCLERA][i];
	}
	return e;
}

/* Its margins lie where they were drawn, to a fifth of a plane's pixel, from inner to outer corner, of either eye and however it leans. */
static void found(void **state)
{
	(void)state;
	for (int k = 0; k < 4; k++) {
		double across[2], down[2], place[3] = { middle[0], middle[1], radius };
		struct eye_outline o;
		axes(across, down, k % 2, k / 2 ? 0.3 : 0);
		struct evidence e = draw_opening(across, down, 1);
		assert_true(eye_outline_of(&o, &e, place, across, down, 2));
		for (int lid = 0; lid < LIDS; lid++) {
			double before = -1;
			for (int i = 2; i < OUTLINE_COLUMNS - 2; i++) {
				const double d[2] = { (double)o.p[lid][i][0] - middle[0], (double)o.p[lid][i][1] - middle[1] };
				const double u = (d[0] * across[0] + d[1] * across[1]) / half, v = d[0] * down[0] + d[1] * down[1];
				NEAR(v, height(lid, u), 0.2 * scale);
				assert_true(u > before);
				before = u;
			}
		}
		// from a place within, out to the margin
		const double from[2] = { middle[0] + (height(LID_UPPER, 0) + 7) * down[0], middle[1] + (height(LID_UPPER, 0) + 7) * down[1] }, out[2] = { -down[0], -down[1] };
		NEAR(eye_outline_apart(&o, LID_UPPER, from, out, 20), 7, 0.2 * scale);
		assert_true(isnan(eye_outline_apart(&o, LID_UPPER, from, out, 5)));
		evidence_free(&e);
		e = draw_opening(across, down, 0.1);
		assert_true(!eye_outline_of(&o, &e, place, across, down, 2));
		evidence_free(&e);
	}
}

static double time_of(long f)
{
	return (double)f / 60;
}

/* Half shut in the middle of the clip. */
static double open_at(long f)
{
	return f >= 55 && f < 65 ? 0.5 : 1;
}

/* Margins of both eyes that are found where they are, and outlines that lie `beyond` of the iris' radius outside of them: of half shut eyes -beyond. */
static struct track_result clip_of(double beyond, double lean)
{
	struct track_result r = { .n = FRAMES, .lid_points = POINTS, .has_eyes = true };
	r.eyes.frames = FRAMES;
	r.eyes.state = mem_new(FRAMES, sizeof *r.eyes.state);
	r.time = mem_new(FRAMES, sizeof *r.time);
	r.lost_at = mem_new(FRAMES, sizeof *r.lost_at);
	r.outline = mem_new(FRAMES * SIDES, sizeof *r.outline);
	for (long f = 0; f < FRAMES; f++) {
		r.time[f] = time_of(f);
		for (int e = 0; e < SIDES; e++) {
			struct eye_state *s = &r.eyes.state[f][e];
			double across[2], down[2];
			axes(across, down, e, lean);
			r.eyes.globe[e].seen = true;
			s->lid_points = POINTS;
			for (int k = 0; k < LIDS * POINTS; k++) {
				const int lid = k / POINTS, i = k % POINTS;
				const double u = 2.0 * i / (POINTS - 1) - 1, v = open_at(f) * height(lid, u);
				for (int c = 0; c < 2; c++)
					s->lid[lid][i][c] = middle[c] + half * u * across[c] + v * down[c];
			}
			if (f % (open_at(f) < 1 ? 2 : 6))
				continue;
			struct track_outline *o = &r.outline[r.outlines++];
			*o = (struct track_outline){ .frame = f, .side = e, .at = { .radius = (float)radius } };
			for (int k = 0; k < LIDS * OUTLINE_COLUMNS; k++) {
				const int lid = k / OUTLINE_COLUMNS, i = k % OUTLINE_COLUMNS;
				const double u = 1.96 * (i + 0.5) / OUTLINE_COLUMNS - 0.98, rise = (lid == LID_UPPER ? -1 : 1) * (open_at(f) < 1 ? -beyond : beyond) * radius;
				for (int c = 0; c < 2; c++)
					o->at.p[lid][i][c] = (float)(middle[c] + half * u * across[c] + (open_at(f) * height(lid, u) + rise) * down[c]);
			}
		}
	}
	return r;
}

static void clip_free(struct track_result *r)
{
	free(r->eyes.state);
	free(r->time);
	free(r->lost_at);
	free(r->outline);
}

static struct track_conf settings(void)
{
	struct track_conf c = { .canthi = { .outline_sigma = 0.03 }, .outlines = { .steady_s = 0.25, .alike = 0.3, .most = 0.6, .found_sigma = 0.03 } };
	return c;
}

/* How far the middle of a margin has gone out of the opening, of the iris' radius. */
static double gone(const struct track_result *r, long f, int side, int lid, double lean)
{
	double across[2], down[2], sum = 0;
	axes(across, down, side, lean);
	for (int i = POINTS / 2 - 1; i <= POINTS / 2; i++) {
		const double u = 2.0 * i / (POINTS - 1) - 1, *p = r->eyes.state[f][side].lid[lid][i];
		sum += 0.5 * ((p[0] - middle[0]) * down[0] + (p[1] - middle[1]) * down[1] - open_at(f) * height(lid, u)) * (lid == LID_UPPER ? -1 : 1);
	}
	return sum / radius;
}

/* Margins as uncertain as the evidence go half of the way, of half shut eyes as those are told; with lids_beyond added; surer ones less; what is told too far off is no margin. */
static void drawn(void **state)
{
	(void)state;
	for (int k = 0; k < 2; k++) {
		const double lean = k ? 0.25 : 0;
		struct track_conf conf = settings();
		struct track_result r = clip_of(0.05, lean);
		track_outlines(&r, &conf);
		for (int e = 0; e < SIDES; e++)
			for (int lid = 0; lid < LIDS; lid++) {
				NEAR(gone(&r, 20, e, lid, lean), 0.025, 0.003);
				NEAR(gone(&r, 60, e, lid, lean), -0.025, 0.004);
			}
		clip_free(&r);
		r = clip_of(0.05, lean);
		conf.canthi.outline_beyond = 0.05;
		conf.outlines.found_sigma = 0.01;
		track_outlines(&r, &conf);
		for (int q = 0; q < SIDES * LIDS; q++)
			NEAR(gone(&r, 20, q / LIDS, q % LIDS, lean), 0.1 * 0.1, 0.003);
		clip_free(&r);
		r = clip_of(0.05, lean);
		conf.outlines.most = 0.01;
		track_outlines(&r, &conf);
		NEAR(gone(&r, 20, SIDE_LEFT, LID_UPPER, lean), 0, 1e-12);
		clip_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(found), cmocka_unit_test(drawn) };
	return cmocka_run_group_tests(tests, 0, 0);
}
