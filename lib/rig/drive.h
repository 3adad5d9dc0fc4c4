/* drive: the controls g~ (model/model.h) that move a character, frame by frame, from gaze.csv (tracked in a video) or animation.csv
 * (from a script).
 */
#ifndef RIG_DRIVE_H
#define RIG_DRIVE_H
#include "model/model.h"
#include "rig/rig.h"

struct drive {
	int n, n_inputs;
	double *time;      // [n] s, growing
	double *controls;  // [n][n_inputs]; no NAN
	long filled;       // empty fields, which were interpolated
};

/* Reads a CSV file with the columns time_s and g1_deg .. g8_deg; apertures as a4 a5 a9 a10 (0 closed .. 1 open) or, without these, as
 * g4_px g5_px g9_px g10_px of the model's own video; action units by their name or au1 .. . Empty fields (a blink hides the pupil) are
 * interpolated over time; an input that is never given is as at rest: lids of which no aperture is given go with expressions (model/express.h) from there.
 * drive  overwritten; drive_free
 * Returns false, err set, when the file cannot be read or its time does not rise from row to row. */
bool drive_load(struct drive *drive, const struct skin_model *model, const char *path, struct err *err);

void drive_free(struct drive *drive);

/* Controls [n_inputs] of a frame. */
static inline double *drive_at(const struct drive *drive, int frame)
{
	return drive->controls + (long)frame * drive->n_inputs;
}

/* Controls [n_inputs], out, for both eyes looking at horizontal, vertical (degrees), with `aperture` times the usual aperture at that
 * gaze (eq. 3.11); action units 0. */
void drive_look(double *controls, const struct rig *rig, double horizontal, double vertical, double aperture);

/* Sets expression k (0: the model's first) of controls that drive_look has made with that aperture, and the lids that go with it (model/express.h). */
void drive_express(double *controls, const struct rig *rig, int k, double strength, double aperture);

/* How far one eye of controls (0 left, 1 right) is open, of what is usual at its gaze with its expressions: 0 shut .. 1. */
double drive_opened(const struct rig *rig, const double *controls, int eye);

#endif
