#ifndef STAGES_RELIEF_STAGE_H
#define STAGES_RELIEF_STAGE_H
#include "anatomy/capture.h"
#include "anatomy/eye.h"
#include "tissue/relief/infer.h"
#include "tissue/relief/opts.h"

struct relief_stage_conf {
	struct relief_conf relief;
	struct infer_conf infer;
	bool shading;               // the relief that explains the shading; no: the filtered coarse field
	double range[2];            // of thickness, mm
	double root_beyond_limbus;  // mm
	double pupil_radius;        // mm, where none was found
};

/* One eye of the folder: reads its maps and pigment, writes its relief, unless that is fresh. */
bool relief_stage(struct stage *stage, const struct capture_eye *eye, const struct eye *anatomy,
                  const struct relief_stage_conf *conf, struct err *err);

#endif
