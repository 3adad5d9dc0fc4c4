/* The head's pose by eyeballs and lids of a clip whose eyes look up or down nearly always: lids follow them, and must not be taken for those of the mesh, whose eyes look
 * straight on. Truth: margins from closed forms. */
#include "base/mem.h"
#include "math/vec.h"
#include "track/clip/refine.h"
#include "tests/lib/unit.h"

enum { FRAMES = 60, POINTS = 20 };
static const double DEGREE = M_PI / 180, apart = 31, lids_at = 13, rise[LIDS] = { 0.25, 0.1 }, high[LIDS] = { 6, -4 };  // mm; mm a degree

struct film {
	struct track_clip clip;
	struct track_subject subject;
	struct track_result result;
	struct track_conf conf;
};

/* A margin of the left eye or the right one, looking so high; x and height as shares of the opening. */
static void margin(double head[3], int side, int lid, double u, double up_deg)
{
	head[0] = (side ? -1 : 1) * (apart + 15 * u);
	head[1] = (1 - u * u) * (high[lid] + rise[lid] * up_deg);
	head[2] = lids_at - 3 * u * u;
}

static void draw_mesh(struct track_subject *s)
{
	for (int e = 0; e < SIDES; e++) {
		struct eye_opening *o = &s->opening[e];
		o->open = true;
		for (int i = 0; i < OPENING_POINTS; i++) {
			const int half = OPENING_POINTS / 2, lid = i < half ? LID_UPPER : LID_LOWER;
			margin(o->edge[i], e, lid, i < half ? 1 - 2.0 * i / half : 2.0 * (i - half) / half - 1, 0);
		}
		o->center[0] = s->center[e][0] = e ? -apart : apart;
		o->center[2] = lids_at;
		s->center_sigma[e] = 0.15;
	}
}

static const double facing[4][4] = { { 1, 0, 0, 5 }, { 0, -1, 0, 8 }, { 0, 0, -1, 600 }, { 0, 0, 0, 1 } };

/* Eyes that look `usual` degrees up in the median, 5 either way, seen by a camera 600 mm away, 5 px a mm; all was measured under a pose that is turned up by so much. */
static void shoot(struct film *f, double usual, double start_deg)
{
	*f = (struct film){ .conf = { .eyes.lid_points = POINTS, .head = { .turn_sigma = 2, .yaw_sigma = 6 }, .mesh_straight = 3, .trust[TRUST_STRAIGHT] = { 8, 25 } } };
	const double d[6] = { -start_deg * DEGREE }, middle[3] = { 5, 8, 600 };
	struct track_result *r = &f->result;
	double start[4][4];
	head_moved(start, facing, d, middle);
	draw_mesh(&f->subject);
	f->clip.camera = (struct camera){ .focal_px = 3000, .center_px = { 640, 360 } };
	f->clip.eye_seen[0] = f->clip.eye_seen[1] = true;
	memcpy(f->clip.cam_from_head, start, sizeof start);
	r->n = FRAMES;
	r->has_eyes = true;
	r->lost_at = mem_new(FRAMES, sizeof *r->lost_at);
	r->misfit = mem_new(FRAMES, sizeof *r->misfit);
	r->pose = mem_new(FRAMES, sizeof *r->pose);
	r->eyes.state = mem_new(FRAMES, sizeof *r->eyes.state);
	for (int e = 0; e < SIDES; e++) {
		r->eyes.globe[e] = (struct eye_globe){ .seen = true, .frames = FRAMES, .center_sigma = { 0.1, 0.1, 0.4 } };
		memcpy(r->eyes.globe[e].center_in_head, f->subject.center[e], sizeof f->subject.center[e]);
	}
	for (long t = 0; t < FRAMES; t++) {
		const double up = usual + 5 * sin(0.7 * (double)t);
		memcpy(r->pose[t], start, sizeof start);
		r->misfit[t] = 1;
		for (int e = 0; e < SIDES; e++) {
			struct eye_state *s = &r->eyes.state[t][e];
			s->gaze[0] = 6 * DEGREE * cos(0.31 * (double)t);
			s->gaze[1] = (up - start_deg) * DEGREE;
			s->openness = 1;
			s->lid_points = POINTS;
			for (int i = 0; i < LIDS * POINTS; i++) {
				double head[3];
				margin(head, e, i / POINTS, 2.0 * (i % POINTS) / (POINTS - 1) - 1, up);
				head_project(s->lid[i / POINTS][i % POINTS], &f->clip.camera, facing, head);
			}
		}
	}
}

static double turned_deg(const struct film *f)
{
	const double none[3] = { 0 };
	double d[6];
	head_motion(d, (const double(*)[4])f->clip.cam_from_head, facing, none);
	return vec_norm(d) / DEGREE;
}

/* By how far the pose is off, and what it says of that. */
static double refined(double *sigma_deg, double usual, double start, double mesh_straight, bool doubted)
{
	struct film f;
	shoot(&f, usual, start);
	f.conf.mesh_straight = mesh_straight;
	reference_refine(&f.clip, doubted, &f.result, &f.subject, &f.conf);
	assert_true(f.clip.pose_refined);
	const double off = turned_deg(&f);
	*sigma_deg = f.clip.turn_sigma[0] / DEGREE;
	track_result_free(&f.result);
	return off;
}

static void lids_follow_the_eyes(void **state)
{
	(void)state;
	static const double starts[] = { 0, 2, -2 };
	double sigma, other;
	for (int i = 0; i < 2 * COUNT(starts); i++)
		for (int up = -8; up <= 8; up += 4) {
			const double start = starts[i / 2], off = refined(&sigma, up, start, 3, i % 2), assumed = refined(&other, up, start, 0, i % 2);
			print_message("usual gaze %d, start %g: off by %.2f +- %.2f degrees, lids taken for the mesh's %.2f +- %.2f\n", up, start, off, sigma, assumed, other);
			assert_true(off < 2 * sigma && sigma < 2);
			assert_true(start ? off < 1.5 : off < 0.5);
			assert_true(abs(up) < 8 || start * up > 0 || off < 0.5 * assumed);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(lids_follow_the_eyes) };
	return cmocka_run_group_tests(tests, 0, 0);
}
