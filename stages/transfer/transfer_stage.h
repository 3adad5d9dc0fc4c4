/* transfer_stage: reads the subject and the targets of a capture, registers each target, and writes the results. */
#ifndef STAGES_TRANSFER_STAGE_H
#define STAGES_TRANSFER_STAGE_H
#include "base/stage.h"
#include "register/transfer_check.h"

struct transfer_stage_conf {
	struct transfer_conf transfer;
	struct transfer_check_conf check;
	double limit_vertices, import_seconds, import_mib;
	double subject_unit;                                  // mm in one unit of the subject's mesh; NAN: guessed
	double eye_radius;                                    // subject.eye_radius: read by others
	struct opt_each_list eye_center;                      // subject.eye_center.SIDE
	struct opt_each_list target_unit;                     // target.NAME.unit_mm
	struct opt_each_list subject_landmark, target_landmarks;  // subject.landmark.NAME, target.NAME.landmarks
};

/* Registers every target of the folder whose results are not up to date. One that cannot be registered is reported and left out.
 * Returns false, err set, when the subject cannot be read or no target can be registered. */
bool transfer_stage(struct stage *stage, const struct transfer_stage_conf *conf, struct err *err);

#endif
