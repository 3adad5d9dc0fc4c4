/* run: the stage from video/ to work/skin/. */
#ifndef STAGES_TRACK_RUN_H
#define STAGES_TRACK_RUN_H
#include "track/clip/conf.h"

struct stage;

/* Does nothing where all files are fresh. Returns false, err set, when the clip cannot be followed or a file cannot be written. */
bool track_stage(struct stage *stage, const struct track_conf *conf, struct err *err);

#endif
