/* blink: onset, amplitude and time course of blinks.
 * Spontaneous blinks as in the skin paper's table 3.1, truncated: a frequency below the least has no meaning. Both phases
 * follow the path of minimum jerk (Flash and Hogan 1985), whose ratio of peak to mean speed, 1.875, is that of lids
 * (Evinger et al. 1984); the durations grow linearly with the amplitude (Evinger et al. 1991; Guitton et al. 1991).
 * Time seconds, amplitudes degrees of lid rotation.
 */
#ifndef MOTION_BLINK_H
#define MOTION_BLINK_H
#include "math/rng.h"

struct blink_conf {
	double frequency[2], frequency_range[2];  // Hz: mean and sigma before truncation; least and greatest
	double amplitude[2];                      // mean, sigma; truncated at 0
	double full;                              // the amplitude that shuts an open eye
	double down_s, down_per_deg;              // closing phase
	double up_over_down;                      // duration of the opening phase over that of the closing one
	double hold_s;                            // shut
	double eye_deg;                           // rotation nasalward and downward meanwhile (Riggs et al. 1987)
};

struct blink {
	double start, down, hold, up;  // s: onset and the phases' durations
	double amplitude, closure;     // degrees; share of the opening that is shut at the deepest
};

/* A blink that starts at `start` (s); amplitude degrees. */
struct blink blink_make(double start, double amplitude, const struct blink_conf *conf);

/* Draws the seconds to the next spontaneous blink; its amplitude, degrees. */
double blink_interval(struct rng *rng, const struct blink_conf *conf);
double blink_amplitude(struct rng *rng, const struct blink_conf *conf);

/* Closure of the lids at time t (s, at or after the onset): 0 open .. blink->closure. */
double blink_closure(const struct blink *blink, double t);

/* Rotation of the eye meanwhile, 0..1 of eye_deg; it ends before the lids' motion does (Riggs et al. 1987). */
double blink_eye(const struct blink *blink, double t);

/* Time (s) at which the lids are open again. */
double blink_end(const struct blink *blink);

#endif
