/* Apertures of the lids and their standard deviations. Truth: margins drawn from closed forms with noise of a known size.
 */
#include "math/rng.h"
#include "math/stats.h"
#include "track/clip/apertures.h"
#include "tests/lib/unit.h"
#include "base/mem.h"

enum { FRAMES = 600, POINTS = 20, UNSEEN = 40, DIM = 450, WRONG = 300 };
static const double upper_noise = 0.4, lower_noise = 0.9, floor_mm = 0.05, px_per_mm = 8, open_px[LIDS] = { 60, 25 };

/* Where the head is in a frame, mm aside and down of where it was in the reference, 600 mm away. */
static void head_at(double at[2], long f)
{
	at[0] = 9 * sin(0.11 * (double)f);
	at[1] = 14 * cos(0.07 * (double)f);
}

/* An eye that opens and shuts slowly; margins are arcs between corners at y = 0 of the reference's picture, and go with the head. */
static double height(int lid, long f)
{
	return (lid == LID_UPPER ? -1 : 1) * open_px[lid] * (0.6 + 0.4 * cos(2 * M_PI * (double)f / FRAMES));
}

static struct track_result noisy(struct rng *rng)
{
	struct track_result r = { .n = FRAMES, .lid_points = POINTS, .has_eyes = true };
	r.eyes.frames = FRAMES;
	r.eyes.state = mem_new(FRAMES, sizeof *r.eyes.state);
	r.eyes.globe[SIDE_LEFT].seen = true;
	r.pose = mem_new(FRAMES, sizeof *r.pose);
	for (long f = 0; f < FRAMES; f++) {
		double at[2];
		head_at(at, f);
		for (int k = 0; k < 4; k++)
			r.pose[f][k][k] = 1;
		r.pose[f][0][3] = at[0];
		r.pose[f][1][3] = at[1];
		r.pose[f][2][3] = 600;
		for (int e = 0; e < SIDES; e++)
			for (int lid = 0; lid < LIDS; lid++) {
				struct eye_state *s = &r.eyes.state[f][e];
				const bool dim = f >= DIM;
				// half as clear, and twice as noisy
				const double off = (dim ? 2 : 1) * (lid == LID_UPPER ? upper_noise : lower_noise) * rng_normal(rng);
				s->lid_points = POINTS;
				s->lid_confidence[lid] = dim ? 0.4 : 0.8;
				for (int i = 0; i < POINTS; i++) {
					double u = 2.0 * i / (POINTS - 1) - 1, bow = 1 - u * u;
					s->lid[lid][i][0] = f == UNSEEN ? NAN : 500 + 100 * u + px_per_mm * at[0];
					s->lid[lid][i][1] = f == UNSEEN ? NAN : 300 + bow * height(lid, f) + (bow > 0 ? off : 0) + px_per_mm * at[1];
				}
			}
	}
	return r;
}

/* Truth within one and two of the standard deviations in the shares of a normal distribution; the floor is the common error of the margins. */
static void coverage(void **state)
{
	(void)state;
	struct rng rng = { 5 };
	struct track_clip clip = { .camera = { .focal_px = 600 * px_per_mm }, .cam_from_head = { { 1 }, { 0, 1 }, { 0, 0, 1, 600 }, { 0, 0, 0, 1 } } };
	struct track_subject subject = { .assumed = true };
	struct track_conf conf = { .lid_sigma_mm = 0 };
	struct track_result r = noisy(&rng);
	track_apertures(&r, &clip, &subject, &conf);
	for (int lid = 0; lid < LIDS; lid++)
		for (int part = 0; part < 2; part++) {
			double z[FRAMES] = { 0 };
			int n = 0, one = 0;
			for (long f = part * DIM; f < (part ? FRAMES : DIM); f++)
				if (f != UNSEEN) {
					const double sigma = sqrt(pow(r.aperture_sigma[f][SIDE_LEFT][lid], 2) - pow(r.meeting_sigma[SIDE_LEFT], 2)), want = (lid == LID_UPPER ? -1 : 1) * height(lid, f);
					z[n] = (r.g[f * 10 + 3 + lid] - want) / sigma;
					n++;
				}
			// where lids meet is common to all frames
			double copy[FRAMES], middle;
			memcpy(copy, z, sizeof copy);
			middle = stats_median(n, copy);
			for (int i = 0; i < n; i++)
				one += fabs(z[i] - middle) < 1;
			print_message("lid %d, part %d: %.0f %% within one standard deviation of %.2f px\n", lid, part, 100.0 * one / n,
			              r.aperture_sigma[part * DIM][SIDE_LEFT][lid]);
			// frames of both kinds make one estimate of the noise, a little more than the clear ones' own
			assert_true(one > 0.6 * n && one < 0.8 * n);
		}
	assert_true(isnan(r.aperture_sigma[UNSEEN][SIDE_LEFT][LID_UPPER]) && isnan(r.g[UNSEEN * 10 + 3]));
	assert_true(isnan(r.aperture_sigma[0][SIDE_RIGHT][LID_UPPER]));
	track_result_free(&r);
}

/* What all frames have in common adds in quadrature; without noise it is all. */
static void common_error(void **state)
{
	(void)state;
	struct rng rng = { 5 };
	struct track_clip clip = { .camera = { .focal_px = 600 * px_per_mm }, .cam_from_head = { { 1 }, { 0, 1 }, { 0, 0, 1, 600 }, { 0, 0, 0, 1 } } };
	struct track_subject subject = { .assumed = true };
	struct track_result a = noisy(&rng), b = noisy(&(struct rng){ 5 });
	track_apertures(&a, &clip, &subject, &(struct track_conf){ .lid_sigma_mm = 0 });
	track_apertures(&b, &clip, &subject, &(struct track_conf){ .lid_sigma_mm = floor_mm });
	for (long f = 0; f < FRAMES; f += 7)
		NEAR(b.aperture_sigma[f][SIDE_LEFT][LID_UPPER], hypot(a.aperture_sigma[f][SIDE_LEFT][LID_UPPER], floor_mm * px_per_mm), 1e-9);
	track_result_free(&a);
	track_result_free(&b);
}

/* One frame in which both lids were found far off, as if shut, moves no other frame's apertures. */
static void one_wrong_frame(void **state)
{
	(void)state;
	struct track_clip clip = { .camera = { .focal_px = 600 * px_per_mm }, .cam_from_head = { { 1 }, { 0, 1 }, { 0, 0, 1, 600 }, { 0, 0, 0, 1 } } };
	struct track_subject subject = { .assumed = true };
	struct track_result a = noisy(&(struct rng){ 5 }), b = noisy(&(struct rng){ 5 });
	double head[2];
	head_at(head, WRONG);
	for (int lid = 0; lid < LIDS; lid++)
		for (int i = 0; i < POINTS; i++)
			b.eyes.state[WRONG][SIDE_LEFT].lid[lid][i][1] = 300 - 25 + 0.5 * lid + px_per_mm * head[1];
	track_apertures(&a, &clip, &subject, &(struct track_conf){ .lid_sigma_mm = 0 });
	track_apertures(&b, &clip, &subject, &(struct track_conf){ .lid_sigma_mm = 0 });
	for (long f = 0; f < FRAMES; f++)
		for (int lid = 0; lid < LIDS && f != WRONG && f != UNSEEN; lid++)
			NEAR(b.g[f * 10 + 3 + lid], a.g[f * 10 + 3 + lid], 0.2 * a.aperture_sigma[f][SIDE_LEFT][lid]);
	track_result_free(&a);
	track_result_free(&b);
}

/* Lids that meet on the lower one do so there where the clip shows it; where the eye never shuts it is the line between the corners, and the standard deviation says so. */
static void where_lids_meet(void **state)
{
	(void)state;
	struct track_clip clip = { .camera = { .focal_px = 600 * px_per_mm }, .cam_from_head = { { 1 }, { 0, 1 }, { 0, 0, 1, 600 }, { 0, 0, 0, 1 } } };
	struct track_subject subject = { .assumed = true };
	double known[2];
	for (int shuts = 0; shuts < 2; shuts++) {
		struct track_result r = noisy(&(struct rng){ 5 });
		for (long f = 0; f < FRAMES; f++)
			for (int i = 0; i < POINTS; i++) {
				const double u = 2.0 * i / (POINTS - 1) - 1, open = shuts && f % 100 < 10 ? 1 - 2 * fmin((double)(f % 100), (double)(10 - f % 100)) / 10 : 1;
				double head[2];
				head_at(head, f);
				for (int lid = 0; lid < LIDS; lid++)
					r.eyes.state[f][SIDE_LEFT].lid[lid][i][1] = 300 + (1 - u * u) * (open_px[1] - (lid == LID_UPPER) * open * 70) + px_per_mm * head[1];
			}
		track_apertures(&r, &clip, &subject, &(struct track_conf){ .lid_sigma_mm = 0 });
		known[shuts] = r.meeting_sigma[SIDE_LEFT];
		NEAR(r.g[50 * 10 + 4], shuts ? 0 : open_px[1], shuts ? 2 * known[shuts] + 0.5 : 0.5);
		assert_true(fabs(r.g[50 * 10 + 4]) < 3 * known[shuts]);
		NEAR(r.g[50 * 10 + 3] + r.g[50 * 10 + 4], 70, 1);
		track_result_free(&r);
	}
	assert_true(known[1] < 0.4 * known[0] && known[0] < 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(coverage), cmocka_unit_test(common_error), cmocka_unit_test(one_wrong_frame), cmocka_unit_test(where_lids_meet) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
