/* heightfield: the stage's files: the clean texture of one eye in, its thickness out. The algorithm is in lib/iris/heightfield. */
#ifndef STAGES_HEIGHTFIELD_H
#define STAGES_HEIGHTFIELD_H
#include "anatomy/capture.h"
#include "anatomy/eye.h"
#include "iris/heightfield/heightfield.h"

struct heightfield_stage_conf {
	struct heightfield_conf field;
	double pupil_radius;  // mm, where none was found
};

/* Makes thickness.exr of one eye, unless it is up to date. False, err set, when a file cannot be read or written, or the iris
 * cannot be used. */
bool heightfield_stage(struct stage *stage, const struct capture_eye *eye, const struct eye *anatomy,
                       const struct heightfield_stage_conf *conf, struct err *err);

#endif
