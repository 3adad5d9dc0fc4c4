/* Points of skin against closed forms: a texture under known affine maps, brighter light, something before it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "tests/lib/score/skin_points.h"
#include "tests/lib/unit.h"

enum { W = 360, H = 260, SIDE = 10, N = SIDE * SIDE, WAVES = 12 };

struct texture {
	double kx[WAVES], ky[WAVES], phase[WAVES], size[WAVES];
};

/* Waves of 5 to 40 px: known at any place, so that a warped picture has no interpolation of its own. */
static struct texture texture_new(void)
{
	struct texture t;
	struct rng rng = { 11 };
	for (int i = 0; i < WAVES; i++) {
		double length = 5 * pow(8, rng_uniform(&rng)), angle = 2 * M_PI * rng_uniform(&rng);
		t.kx[i] = 2 * M_PI / length * cos(angle);
		t.ky[i] = 2 * M_PI / length * sin(angle);
		t.phase[i] = 2 * M_PI * rng_uniform(&rng);
		t.size[i] = 45 * sqrt(length / 40) / sqrt(WAVES / 4.0);
	}
	return t;
}

struct motion {
	double A[2][2], shift[2], gain;
};

static const double center[2] = { W / 2.0, H / 2.0 };

static void moved(double out[2], const struct motion *m, const double at[2])
{
	double d[2] = { at[0] - center[0], at[1] - center[1] };
	for (int r = 0; r < 2; r++)
		out[r] = center[r] + m->shift[r] + m->A[r][0] * d[0] + m->A[r][1] * d[1];
}

static void paint(uint8_t *px, const struct texture *t, const struct motion *m)
{
	double det = m->A[0][0] * m->A[1][1] - m->A[0][1] * m->A[1][0];
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double d[2] = { x + 0.5 - center[0] - m->shift[0], y + 0.5 - center[1] - m->shift[1] }, v = 120;
			double u[2] = { (m->A[1][1] * d[0] - m->A[0][1] * d[1]) / det, (m->A[0][0] * d[1] - m->A[1][0] * d[0]) / det };
			for (int i = 0; i < WAVES; i++)
				v += t->size[i] * cos(t->kx[i] * u[0] + t->ky[i] * u[1] + t->phase[i]);
			px[y * W + x] = (uint8_t)fmax(0, fmin(255, round(m->gain * v)));
		}
}

struct scene {
	struct texture texture;
	struct skin_points points;
	struct skin_track *track;
	uint8_t *px;
	struct skin_point_state state[N];
};

static struct scene *scene_new(void)
{
	struct scene *s = mem_new(1, sizeof *s);
	const struct motion rest = { { { 1, 0 }, { 0, 1 } }, { 0, 0 }, 1 };
	s->texture = texture_new();
	s->px = mem_new(W * H, 1);
	s->points = (struct skin_points){ .n = N, .at = mem_new(N, sizeof *s->points.at) };
	for (int i = 0; i < N; i++) {
		s->points.at[i][0] = 90 + 20.0 * (i % SIDE);
		s->points.at[i][1] = 60 + 15.0 * (i / SIDE);
	}
	skin_points_join(&s->points, 0, 0, 12);
	paint(s->px, &s->texture, &rest);
	s->track = skin_track_new(&s->points, s->px, W, W, H, 0, &skin_track_review);
	return s;
}

static void scene_free(struct scene *s)
{
	skin_track_free(s->track);
	skin_points_free(&s->points);
	free(s->px);
	free(s);
}

/* Worst distance of points that are seen from where they went. */
static double worst(const struct scene *s, const struct motion *m, int *seen)
{
	double most = 0;
	*seen = 0;
	for (int i = 0; i < N; i++) {
		double want[2];
		moved(want, m, s->points.at[i]);
		if (!(s->state[i].confidence > 0))
			continue;
		(*seen)++;
		most = fmax(most, hypot(s->state[i].at[0] - want[0], s->state[i].at[1] - want[1]));
	}
	return most;
}

static void follows_affine_maps(void **state)
{
	(void)state;
	struct scene *s = scene_new();
	struct motion m = { { { 1, 0 }, { 0, 1 } }, { 0, 0 }, 1 };
	for (int f = 1; f <= 12; f++) {
		double t = f / 12.0;
		int seen;
		m = (struct motion){ { { 1 + 0.12 * t, 0.1 * t }, { -0.08 * t, 1 - 0.1 * t } }, { 14 * sin(3 * t), -9 * t }, 1 - 0.3 * t };
		paint(s->px, &s->texture, &m);
		assert_true(skin_track_push(s->track, s->px, W, s->state) > 0.98);
		assert_false(skin_track_was_still(s->track));
		// bilinear reading of waves of 5 px errs by some hundredths of a pixel, and grey levels are whole numbers
		assert_true(worst(s, &m, &seen) < 0.15);
	}
	scene_free(s);
}

static void does_not_drift(void **state)
{
	(void)state;
	struct scene *s = scene_new();
	for (int f = 0; f < 60; f++) {
		const struct motion m = { { { 1, 0 }, { 0, 1 } }, { 6 * sin(0.3 * f), 4 * sin(0.2 * f) }, 1 };
		paint(s->px, &s->texture, &m);
		skin_track_push(s->track, s->px, W, s->state);
		int seen;
		if (f == 10 || f == 59)
			assert_true(worst(s, &m, &seen) < 0.1 && seen == N);
	}
	scene_free(s);
}

static void a_still_frame_stands_still(void **state)
{
	(void)state;
	struct scene *s = scene_new();
	const struct motion m = { { { 1, 0 }, { 0, 1 } }, { 1, 0 }, 1 };
	paint(s->px, &s->texture, &m);
	skin_track_push(s->track, s->px, W, s->state);
	assert_false(skin_track_was_still(s->track));
	skin_track_push(s->track, s->px, W, s->state);
	assert_true(skin_track_was_still(s->track));
	int seen;
	assert_true(worst(s, &m, &seen) < 0.1 && seen == N);
	scene_free(s);
}

/* A hand before a third of the skin: those points are not seen, the others are as exact as before, and when it has gone all are. */
static void what_is_covered_is_not_seen(void **state)
{
	(void)state;
	struct scene *s = scene_new();
	struct rng rng = { 5 };
	int seen;
	for (int f = 1; f <= 12; f++) {
		const struct motion m = { { { 1, 0 }, { 0, 1 } }, { 0.5 * f, 0 }, 1 };
		paint(s->px, &s->texture, &m);
		for (int i = 0; i < W * H; i++)
			if (f >= 4 && f <= 8 && i % W < 150)
				s->px[i] = (uint8_t)(100 + 50 * rng_uniform(&rng));
		skin_track_push(s->track, s->px, W, s->state);
		worst(s, &m, &seen);
		int hidden = 0, covered = 0;
		for (int i = 0; i < N; i++) {
			covered += s->points.at[i][0] + m.shift[0] < 140;
			hidden += s->points.at[i][0] + m.shift[0] < 140 && !(s->state[i].confidence > 0);
		}
		if (f >= 4 && f <= 8)
			assert_true(hidden >= 0.9 * covered);
		else
			assert_true(seen == N && worst(s, &m, &seen) < 0.15);
	}
	scene_free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(follows_affine_maps),
		cmocka_unit_test(does_not_drift),
		cmocka_unit_test(a_still_frame_stands_still),
		cmocka_unit_test(what_is_covered_is_not_seen),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
