/* Frames of a head that moves in which its skin stirs: brows raised by a millimetre in some frames. Truth: points of a plane under known poses. */
#include "base/mem.h"
#include "math/rng.h"
#include "track/clip/moves.h"
#include "tests/lib/unit.h"

enum { SIDE = 14, POINTS = SIDE * SIDE, FRAMES = 11, FIRST = 6, EVERY = 2 };

static const double raised_mm = 1, noise_px = 0.5;

static bool raised(int frame)
{
	return frame >= FIRST && frame < FIRST + 3;
}

/* A face round two eyes, 600 mm away and nearer, turning; 5 px a mm. */
static void shoot(struct track_clip *clip, struct track_subject *s)
{
	struct rng rng = { 3 };
	struct track_moves *m = &clip->moves;
	*s = (struct track_subject){ .radius = 12, .center = { { 31, 0, -12 }, { -31, 0, -12 } } };
	*clip = (struct track_clip){ .camera = { .focal_px = 3000, .center_px = { 640, 360 } } };
	*m = (struct track_moves){ .n = POINTS, .frames = FRAMES, .every = EVERY, .first_frame = 1, .n_known = FRAMES };
	m->head = mem_new(POINTS, sizeof *m->head);
	m->px = mem_new(POINTS * FRAMES, sizeof *m->px);
	m->seen = mem_new(POINTS * FRAMES, sizeof *m->seen);
	m->known = mem_new(FRAMES, sizeof *m->known);
	for (int i = 0; i < POINTS; i++) {
		m->head[i][0] = 9 * (i % SIDE - 0.5 * (SIDE - 1));
		m->head[i][1] = 5 * (i / SIDE - 0.5 * (SIDE - 1));
	}
	for (int f = 0; f < FRAMES; f++) {
		const double facing[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, 600 - 15 * f }, { 0, 0, 0, 1 } }, d[6] = { 0.02 * f, 0.05 * (f - 5), 0.01 * f, 2 * f }, at[3] = { 0, 0, 600 };
		m->known[f].frame = 1 + EVERY * f;
		head_moved(m->known[f].cam_from_head, facing, d, at);
		for (int i = 0; i < POINTS; i++) {
			double head[3] = { m->head[i][0], m->head[i][1], m->head[i][2] }, px[2];
			head[1] += raised(f) && head[1] > 0 ? raised_mm : 0;
			head_project(px, &clip->camera, (const double(*)[4])m->known[f].cam_from_head, head);
			for (int c = 0; c < 2; c++)
				m->px[f * POINTS + i][c] = (float)(px[c] + noise_px * rng_normal(&rng));
			m->seen[f * POINTS + i] = 1;
		}
	}
}

static void brows_stir(void **state)
{
	(void)state;
	struct track_clip clip;
	struct track_subject s;
	const struct track_conf conf = { .reach_mm = 35 };
	double off[FRAMES];
	shoot(&clip, &s);
	// in the last frame hardly anything is in sight
	for (int i = 5; i < POINTS; i++)
		clip.moves.seen[(FRAMES - 1) * POINTS + i] = 0;
	track_moves_stirred(off, &clip.moves, &clip, &s, &conf);
	for (int f = 0; f < FRAMES - 1; f++) {
		print_message("frame %d: %.2f mm\n", f, off[f]);
		// of half a pixel's noise each way three quarters lie within 0.17 mm
		assert_true(raised(f) ? off[f] > 0.8 && off[f] < 1.4 : off[f] < 0.3);
	}
	assert_true(isnan(off[FRAMES - 1]));
	track_moves_free(&clip.moves);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(brows_stir) };
	return cmocka_run_group_tests(tests, 0, 0);
}
