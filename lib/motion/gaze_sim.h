/* gaze_sim: eyes that follow a target: saccades, smooth pursuit, vestibulo-ocular reflex, vergence, in steps of one millisecond. A kinematic
 * model, not one of the muscles.
 * Directions: degrees, horizontal (towards the person's left) and vertical (up), as Fick angles: of the target in the
 * world (the head's axes while it looks straight ahead), of the eyes in the head. Distances mm, time seconds.
 *
 * A target that jumps is followed by a saccade after a latency; one that moves, by pursuit and catch-up saccades, which
 * aim where it will be (Blohm et al. 2006), and are left out where pursuit alone will meet it between 40 and 180 ms from
 * now (de Brouwer et al. 2002). When the head turns, the eyes turn back.
 */
#ifndef MOTION_GAZE_SIM_H
#define MOTION_GAZE_SIM_H
#include <stdbool.h>

#include "math/rng.h"
#include "motion/saccade.h"

struct gaze_conf {
	struct saccade_conf saccade;
	double latency[2];          // s: mean and sigma before a saccade to a target that jumped
	double catch_up[2];         // the same before corrective and catch-up saccades
	double gain[2];             // of saccades: mean and sigma of amplitude over error
	double threshold;           // degrees of error that call for a saccade
	double crossing[2];         // s: no saccade while pursuit will cross the target within these
	double crossing_lead;       // s before a saccade until which it can be called off
	double pursuit_gain, pursuit_delay, pursuit_tau, pursuit_limit;  // tau s, limit degrees/s
	double vor_gain;
	double vergence_delay, vergence_tau;  // s
	double drift, drift_tau;    // degrees, s: of fixation
	double range;               // degrees: eyes do not turn further
	double ipd;                 // mm between the eyes' centres
};

/* Target and head at a time: filled in by the caller. */
struct gaze_input {
	double target[2];           // world
	double distance;            // of the target from between the eyes; INFINITY: far
	double head[2];             // horizontal, vertical turn of the head
};
typedef void gaze_source(void *ctx, double t, struct gaze_input *input);

struct gaze_output {
	double eye[2][3];           // left, right: horizontal, vertical, torsion by Listing's law
	double cyclopean[2];        // in the head, without vergence
	bool in_saccade;
};

struct gaze_saccade {           // s, degrees, s, degrees/s
	double start, amplitude, duration, peak;
};

struct gaze_sim;
/* Copies conf; source is called with ctx for every millisecond. gaze_sim_free, which accepts null. */
struct gaze_sim *gaze_sim_new(const struct gaze_conf *conf, gaze_source *source, void *ctx, uint64_t seed);
void gaze_sim_free(struct gaze_sim *sim);

/* Advances to time t (s, not before the last one). out: the eyes at t. */
void gaze_sim_at(struct gaze_sim *sim, double t, struct gaze_output *out);

/* The saccades so far, in order; owned by sim. */
const struct gaze_saccade *gaze_sim_saccades(const struct gaze_sim *sim, int *n);

/* Angles of both eyes (vergence, then Listing's law) for a cyclopean direction in the head and a distance along it (mm;
 * INFINITY: far). */
void gaze_eyes(double eye[2][3], const double direction[2], double distance, double ipd);

/* Fick torsion (degrees) of an eye at those angles by Listing's law: the axis of its rotation from straight ahead lies in the
 * frontal plane. */
double listing_torsion(double horizontal, double vertical);

#endif
