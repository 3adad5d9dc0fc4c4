/* options: animate's rows of the option table. */
#ifndef OPTIONS_H
#define OPTIONS_H
#include "stages/animate/animate_stage.h"

#define SACCADE_OPTS(g) \
	OPT_REAL("saccade_duration_ms", &saccade_ms[0], 1, 200, "ms", "main sequence: duration of the smallest saccade"), \
	OPT_REAL("saccade_duration_ms_per_deg", &saccade_ms[1], 0, 20, "ms/degree", "and what each degree adds"), \
	OPT_REAL("saccade_peak_ratio", &(g)->saccade.peak_ratio, 1.1, 3, "", "peak over mean velocity"), \
	OPT_REALS("saccade_skew", skew, 2, 0.1, 0.9, "", "where in its duration a saccade of 1 and of 40 degrees is fastest"), \
	OPT_REALS("saccade_latency_s", (g)->latency, 2, 0, 2, "s", "before a saccade: mean, sigma"), \
	OPT_REALS("catch_up_latency_s", (g)->catch_up, 2, 0, 2, "s", "before corrections and catch-up saccades: mean, sigma"), \
	OPT_REALS("saccade_gain", (g)->gain, 2, 0, 2, "", "amplitude over error: mean, sigma"), \
	OPT_REAL("saccade_threshold_deg", &(g)->threshold, 0.05, 20, "degrees", "error that calls for a saccade"), \
	OPT_REALS("crossing_s", (g)->crossing, 2, 0, 2, "s", "pursuit crosses the target within: no saccade"), \
	OPT_REAL("crossing_lead_s", &(g)->crossing_lead, 0, 1, "s", "so long before a saccade it can be called off")

#define PURSUIT_OPTS(g) \
	OPT_REAL("pursuit_gain", &(g)->pursuit_gain, 0, 1.5, "", "velocity of eye over target"), \
	OPT_REAL("pursuit_delay_s", &(g)->pursuit_delay, 0, 0.5, "s", "from motion seen to eye moved"), \
	OPT_REAL("pursuit_tau_s", &(g)->pursuit_tau, 0.005, 2, "s", "rise of the eye's velocity"), \
	OPT_REAL("pursuit_limit_deg_s", &(g)->pursuit_limit, 1, 500, "degrees/s", "fastest pursuit"), \
	OPT_REAL("vor_gain", &(g)->vor_gain, 0, 1.5, "", "velocity of eye over head"), \
	OPT_REAL("vergence_delay_s", &(g)->vergence_delay, 0, 0.5, "s", "from a new distance to the eyes' turn"), \
	OPT_REAL("vergence_tau_s", &(g)->vergence_tau, 0.005, 5, "s", "time constant of vergence"), \
	OPT_REAL("drift_deg", &(g)->drift, 0, 5, "degrees", "drift of fixation, sigma"), \
	OPT_REAL("drift_tau_s", &(g)->drift_tau, 0.01, 60, "s", "its time constant"), \
	OPT_REAL("range_deg", &(g)->range, 5, 89, "degrees", "eyes turn no further"), \
	OPT_REAL("ipd_mm", &(g)->ipd, 10, 200, "mm", "between the eyes' centres")

#define BLINK_OPTS(c) \
	OPT_BOOL("blinks", &(c)->blinks, "spontaneous blinks"), \
	OPT_REALS("blink_hz", (c)->blink.frequency, 2, 0, 10, "Hz", "frequency: mean, sigma before truncation"), \
	OPT_REALS("blink_hz_range", (c)->blink.frequency_range, 2, 0.001, 10, "Hz", "truncated to"), \
	OPT_REALS("blink_deg", (c)->blink.amplitude, 2, 0, 90, "degrees", "amplitude: mean, sigma"), \
	OPT_REAL("blink_full_deg", &(c)->blink.full, 5, 90, "degrees", "amplitude that shuts an open eye"), \
	OPT_REAL("blink_down_ms", &blink_ms[0], 1, 1000, "ms", "closing phase of the smallest blink"), \
	OPT_REAL("blink_down_ms_per_deg", &blink_ms[1], 0, 50, "ms/degree", "and what each degree adds"), \
	OPT_REAL("blink_up_over_down", &(c)->blink.up_over_down, 0.2, 10, "", "duration of the opening phase over the closing"), \
	OPT_REAL("blink_hold_ms", &blink_ms[2], 0, 5000, "ms", "shut"), \
	OPT_REAL("blink_eye_deg", &(c)->blink.eye_deg, 0, 20, "degrees", "eyes turn nasalward and down in a blink"), \
	OPT_REAL("gaze_blink_deg", &(c)->gaze_blink, 0, 180, "degrees", "larger saccades come with a blink; 0: never")

#define SCENE_OPTS(c, s) \
	OPT_REAL("scene_deg", &(c)->scene_deg, 1, 150, "degrees", "width of the scene or screen as it is seen"), \
	OPT_REALS("screen_px", (c)->screen, 2, 1, 100000, "px", "size of the screen that x_px, y_px are on"), \
	OPT_REAL("scene_mm", &(c)->scene_distance, 50, 1e7, "mm", "distance of the scene"), \
	OPT_REALS("dwell_s", (s)->dwell, 2, 0, 10, "s", "fixation in a scene: mean, sigma"), \
	OPT_REAL("inhibit_radius", &(s)->inhibit, 0.001, 1, "", "of return: share of the shorter side"), \
	OPT_REAL("inhibit_s", &(s)->inhibit_s, 0.01, 1000, "s", "and how long it lasts")

#endif
