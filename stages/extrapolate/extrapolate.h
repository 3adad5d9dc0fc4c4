/* extrapolate: reads a registered character, makes its rig (lib/rig/make/make.h) and writes it. */
#ifndef STAGES_EXTRAPOLATE_H
#define STAGES_EXTRAPOLATE_H
#include "base/stage.h"
#include "rig/make/make.h"

struct extrapolate_conf {
	struct rig_conf rig;
	double subject_unit, eye_radius;     // mm in one unit of the subject's mesh; in that unit; NAN: not given
	struct opt_each_list eye_center;     // left, right: in the subject's unit and axes
	int polar_px;                        // rows of the globe map's picture
	double limit_vertices;
};

/* Makes the rig of each character in targets/ unless it is up to date; leaves out, with the reason, one that transfer has not registered
 * and one that cannot be rigged.
 * motion  of the person's skin model
 * Returns false, err set, when a file cannot be read or written, or characters were registered and none can be rigged. */
bool extrapolate_targets(struct stage *stage, const struct file_list *targets, const struct rig_motion *motion,
                         const struct extrapolate_conf *conf, struct err *err);

#endif
