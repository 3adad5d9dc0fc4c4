/* saccade: main sequence and time course of one saccade.
 * Duration grows linearly with amplitude (Bahill, Clark and Stark 1975; Carpenter 1988); peak velocity is a constant times
 * the mean velocity (Evinger et al. 1984; Becker 1989), which makes it saturate as measured. The velocity is a skewed bell,
 * t^a (1 - t)^b: human trajectories are neither bang-bang nor of minimum jerk (Harwood, Mezey and Harris 1999), and decelerate
 * the longer the larger they are (van Opstal and van Gisbergen 1987).
 * Angles degrees, time seconds.
 */
#ifndef MOTION_SACCADE_H
#define MOTION_SACCADE_H

struct saccade_conf {
	double duration_s, duration_per_deg;  // duration = duration_s + duration_per_deg * amplitude
	double peak_ratio;                    // peak over mean velocity
	double skew_short, skew_long;         // where the peak lies, share of the duration: of 1 degree, of 40 degrees
};

enum { SACCADE_TABLE = 128 };

struct saccade {
	double amplitude, duration, peak;     // degrees, s, degrees/s
	double course[SACCADE_TABLE + 1];     // share of the way after i / SACCADE_TABLE of the duration
};

/* saccade: overwritten. amplitude: degrees, >= 0. */
void saccade_make(struct saccade *saccade, double amplitude, const struct saccade_conf *conf);

/* Share of the way after t seconds: 0 before, 1 after. */
double saccade_at(const struct saccade *saccade, double t);

/* Share of the way along the path of minimum jerk (Flash and Hogan 1985), s = 10 t^3 - 15 t^4 + 6 t^5; t: share of the time,
 * clamped to 0..1. */
double minimum_jerk(double t);

#endif
