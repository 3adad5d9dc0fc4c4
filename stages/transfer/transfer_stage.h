#ifndef STAGES_TRANSFER_STAGE_H
#define STAGES_TRANSFER_STAGE_H
#include "base/stage.h"
#include "register/transfer.h"

struct transfer_stage_conf {
	struct transfer_conf transfer;
	double limit_vertices;
	double subject_unit;                                  // mm; NAN: guessed
	struct opt_each_list target_unit;
	struct opt_each_list subject_landmark, target_landmarks;
};

/* Registers every target of the folder; one that cannot be is said, and left out. */
bool transfer_stage(struct stage *stage, const struct transfer_stage_conf *conf, struct err *err);

#endif
