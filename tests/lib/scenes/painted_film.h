/* painted_film: two painted eyes (painted_eye.h) in a plane of skin that a head carries to and fro, at any frame rate: gaze, lids and head are closed forms
 * of time, in seconds. No code of lib/ but random numbers.
 * Head frame: x to the person's left, y up, z out of the face, mm. The camera looks along -z from PAINTED_FAR.
 */
#ifndef TESTS_PAINTED_FILM_H
#define TESTS_PAINTED_FILM_H
#include <stdbool.h>
#include <stdint.h>

enum { FILM_W = 820, FILM_H = 200, FILM_SACCADES = 4, FILM_BLINKS = 2 };
extern const double FILM_SECONDS, FILM_SKIN_Z, FILM_EYE_X;  // s; mm: the plane of skin; an eye's centre is at +-FILM_EYE_X, 0, 0

/* One turn of both eyes, or one fall and rise of the upper lids: closure is the share of the opening that shuts. */
struct film_event {
	double start, end, size, peak_speed;  // s; degrees and degrees/s, or closure and 0
};
extern const struct film_event film_blink[FILM_BLINKS];

/* The i-th saccade: duration by the main sequence, 21 ms + 2.2 ms a degree (Carpenter 1988), the way of minimum jerk. */
struct film_event film_saccade(int i);

struct film_state {
	double gaze[3];        // Fick, radians; the same for both eyes
	double closure;        // 0 open .. 1 shut
	double head[2];        // the head's way along x and y, mm
};
struct film_state film_at(double t);

/* Height of a lid at rest above (upper) or below the line between the corners, head frame: y of the margin at x mm; both the same beyond the corners. */
double film_rest_margin(double x, bool lower);

/* x of the corners of the left eye, mm: inner, outer. */
extern const double FILM_CANTHUS[2];

/* rgb[FILM_H][FILM_W][3] as it looks at time t. seed: of the noise. */
void film_draw(uint8_t *rgb, double t, uint64_t seed);

#endif
