/* Both eyes together: gaze that parts as eyes do not is forgotten in the eye that was not followed. Truth: states written by hand.
 */
#include "base/mem.h"
#include "track/eye/events.h"
#include "track/eye/eye_track_impl.h"
#include "tests/lib/unit.h"

enum { FRAMES = 60, OFF = 20, BOTH_OFF = 30, HIGH = 40, CLOSE = 50 };
static const double DEGREE = M_PI / 180, most[2] = { 8, 3 }, poor = 0.6;

/* Eyes that converge by 4 degrees and look about together, told with confidences of 0.9 and 0.5. */
static struct eye_side looking(int side)
{
	struct eye_side eye = { .frames = FRAMES, .state = mem_new(FRAMES, sizeof(struct eye_state)) };
	for (long f = 0; f < FRAMES; f++) {
		struct eye_state *s = &eye.state[f];
		s->gaze[0] = DEGREE * (15 * sin(0.3 * (double)f) + (side ? 2 : -2));
		s->gaze[1] = DEGREE * 8 * cos(0.2 * (double)f);
		s->confidence = side ? 0.5 : 0.9;
	}
	return eye;
}

static void parted(void **state)
{
	(void)state;
	struct eye_side eye[2] = { looking(0), looking(1) };
	// ten degrees aside, the left eye hardly seen; then neither; four degrees up, the right one less sure for itself than the left; seven degrees converging, near
	eye[0].state[OFF].gaze[0] += 10 * DEGREE;
	eye[0].state[OFF].confidence = 0.3;
	eye[1].state[BOTH_OFF].gaze[0] += 12 * DEGREE;
	eye[0].state[BOTH_OFF].confidence = 0.4;
	eye[1].state[BOTH_OFF].confidence = 0.2;
	eye[1].state[HIGH].gaze[1] += 4 * DEGREE;
	eye[1].state[HIGH].confidence = 0.45;
	eye[1].state[CLOSE].gaze[0] += 7 * DEGREE;
	eye_pair_doubt(&eye[0], &eye[1], most, poor);
	for (long f = 0; f < FRAMES; f++)
		for (int e = 0; e < 2; e++) {
			const bool gone = f == BOTH_OFF || (f == OFF && e == 0) || (f == HIGH && e == 1);
			const struct eye_state *s = &eye[e].state[f];
			assert_true(isnan(s->gaze[0]) == gone && isnan(s->gaze[1]) == gone && (s->confidence == 0) == gone);
		}
	free(eye[0].state);
	free(eye[1].state);
}

/* Too few frames to know how the eyes mostly look: nothing is doubted. */
static void too_few(void **state)
{
	(void)state;
	struct eye_side eye[2] = { looking(0), looking(1) };
	eye[0].frames = eye[1].frames = 6;
	eye[0].state[3].gaze[0] += 30 * DEGREE;
	eye_pair_doubt(&eye[0], &eye[1], most, poor);
	assert_true(isfinite(eye[0].state[3].gaze[0]) && isfinite(eye[1].state[3].gaze[0]));
	free(eye[0].state);
	free(eye[1].state);
}

/* Average eyes held level: the less certain one takes the other's height, and is as certain as the mean by variance whose parts err alike. */
static void level(void **state)
{
	(void)state;
	struct eye_side eye[2] = { looking(0), looking(1) };
	const double sigma_mm[2] = { 0.6, 0.2 }, own = 0.5 * DEGREE, plane = sqrt(12 * 12 - 6 * 6);
	double rad[2];
	for (int e = 0; e < 2; e++) {
		eye[e].average = true;
		eye[e].globe = (struct gaze_globe){ .radius = 12, .limbus = 6 };
		eye[e].center_sigma[1] = sigma_mm[e];
		rad[e] = sigma_mm[e] / plane;
		for (long f = 0; f < FRAMES; f++) {
			eye[e].state[f].gaze[1] += e ? 0 : 1.5 * DEGREE;
			eye[e].state[f].sigma[1] = hypot(own, rad[e]);
		}
	}
	eye_pair_level(&eye[0], &eye[1]);
	const double joint = (rad[1] * rad[1] * rad[0] + rad[0] * rad[0] * rad[1]) / (rad[0] * rad[0] + rad[1] * rad[1]);
	for (long f = 0; f < FRAMES; f++) {
		// the remaining quarter of a degree of fused eyes
		assert_true(fabs(eye[0].state[f].gaze[1] - eye[1].state[f].gaze[1]) < 0.05 * DEGREE);
		for (int e = 0; e < 2; e++)
			NEAR(eye[e].state[f].sigma[1], hypot(own, joint), 1e-9);
	}
	assert_true(joint > rad[1] && joint < rad[0]);
	free(eye[0].state);
	free(eye[1].state);
}

/* Frames 20 to 39 are forgotten: there a blink of both eyes stands, one of the left alone goes, and so does a saccade that reaches into them; before them all stand. */
static void forgotten_frames(void **state)
{
	(void)state;
	const struct eye_event events[] = {
		{ EVENT_BLINK, 0, 5, 9, 7, 1, 0 }, { EVENT_SACCADE, 0, 10, 13, 11, 0.1, 2 }, { EVENT_SACCADE, 1, 18, 20, 19, 0.1, 2 },
		{ EVENT_BLINK, 0, 22, 26, 24, 1, 0 }, { EVENT_BLINK, 1, 23, 27, 25, 1, 0 }, { EVENT_BLINK, 0, 33, 36, 34, 1, 0 }, { EVENT_BLINK, 1, 38, 44, 41, 1, 0 },
	};
	static const bool stands[COUNT(events)] = { true, true, false, true, true, false, true };
	struct eye_clip clip = { .frames = FRAMES, .events = COUNT(events), .state = mem_new(FRAMES, sizeof *clip.state), .event = mem_new(COUNT(events), sizeof *clip.event) };
	bool forgotten[FRAMES];
	memcpy(clip.event, events, sizeof events);
	for (int f = 0; f < FRAMES; f++) {
		forgotten[f] = f >= 20 && f < 40;
		for (int e = 0; e < 2; e++)
			clip.state[f][e].confidence = 1;
	}
	clip.state[34][0].blink = clip.state[24][0].blink = BLINK_CLOSED;
	eye_clip_forget(&clip, forgotten);
	int n = 0;
	for (int i = 0; i < COUNT(events); i++)
		if (stands[i])
			assert_memory_equal(&clip.event[n++], &events[i], sizeof events[i]);
	assert_int_equal(clip.events, n);
	assert_true(clip.state[34][0].blink == BLINK_OPEN && clip.state[24][0].blink == BLINK_CLOSED);
	for (int f = 0; f < FRAMES; f++)
		for (int e = 0; e < 2; e++) {
			const struct eye_state *s = &clip.state[f][e];
			assert_true(forgotten[f] ? s->confidence == 0 && isnan(s->gaze[1]) && isnan(s->lid[1][0][1]) : s->confidence == 1 && s->gaze[1] == 0);
		}
	eye_clip_free(&clip);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(parted), cmocka_unit_test(too_few), cmocka_unit_test(level), cmocka_unit_test(forgotten_frames) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
