#ifndef STAGES_HEIGHTFIELD_H
#define STAGES_HEIGHTFIELD_H
#include "anatomy/capture.h"
#include "anatomy/eye.h"
#include "iris/heightfield/heightfield.h"

struct heightfield_stage_conf {
	struct heightfield_conf field;
	double pupil_radius;  // mm, where none was found
};

/* One eye of the folder: reads its texture, writes its thickness, unless that stands already. */
bool heightfield_stage(struct stage *stage, const struct capture_eye *eye, const struct eye *anatomy,
                       const struct heightfield_stage_conf *conf, struct err *err);

#endif
