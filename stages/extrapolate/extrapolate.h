/* extrapolate: the rigs of a capture's characters. */
#ifndef STAGES_EXTRAPOLATE_H
#define STAGES_EXTRAPOLATE_H
#include "base/stage.h"
#include "rig/make/make.h"

struct extrapolate_conf {
	struct rig_conf rig;
	double subject_unit, eye_radius;     // mm a unit; the subject's unit; NAN: not given
	struct opt_each_list eye_center;     // left, right: the subject's unit and axes
	int polar_px;                        // rows of the globe map's picture
	double limit_vertices;
};

/* Rigs targets/FILE, unless its rig stands already. Skips, with the reason, one that transfer has not registered. */
bool extrapolate_target(struct stage *stage, const char *file, const struct rig_motion *motion,
                        const struct extrapolate_conf *conf, struct err *err);


#endif
