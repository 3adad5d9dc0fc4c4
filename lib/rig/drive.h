/* drive: what moves a character over time: the controls g~ (model.h) of every frame, from gaze.csv (what a video showed) or
 * animation.csv (what a script asks for).
 */
#ifndef RIG_DRIVE_H
#define RIG_DRIVE_H
#include "model/model.h"
#include "rig/rig.h"

struct drive {
	int n, n_inputs;
	double *time;      // [n] s, growing
	double *controls;  // [n][n_inputs]; no NAN
	long filled;       // fields that were empty, filled in from the frames round them
};

/* Columns time_s and g1_deg .. g8_deg; apertures as a4 a5 a9 a10 (0 closed .. 1 open) or, without these, as g4_px g5_px
 * g9_px g10_px of the model's own video; action units by their name or au1 .. . What was not measured (a blink hides the
 * pupil) is carried over in time; what never was is as at rest. drive_free. */
bool drive_load(struct drive *drive, const struct skin_model *model, const char *path, struct err *err);

void drive_free(struct drive *drive);

static inline double *drive_at(const struct drive *drive, int frame)
{
	return drive->controls + (long)frame * drive->n_inputs;
}

/* Controls for both eyes looking at horizontal, vertical (degrees), opened by `aperture` times what they are at that
 * gaze (eq. 3.11); controls[n_inputs], action units 0. */
void drive_look(double *controls, const struct rig *rig, double horizontal, double vertical, double aperture);

#endif
