/* colmap_defaults: extraction, exhaustive matching and mapping as a user of COLMAP alone would have them, timed. */
#ifndef TESTS_COLMAP_DEFAULTS_H
#define TESTS_COLMAP_DEFAULTS_H
#include "optics/camera_rig.h"
#include "tests/lib/spent.h"

/* images: the folder of photographs, all of one camera. dir: database, model, log and the times are kept there; where a run
 * has ended they are read and nothing is run. rig: the first model's cameras in its own frame, named as the photographs
 * without their endings; camera_rig_free. */
bool colmap_defaults(struct camera_rig *rig, struct spent *spent, const char *dir, const char *images, struct err *err);

#endif
