/* animate_stage: from script/ to work/skin/animation.csv and its picture. */
#ifndef ANIMATE_STAGE_H
#define ANIMATE_STAGE_H
#include "base/stage.h"
#include "motion/animate.h"
#include "motion/scene.h"

bool animate_stage(struct stage *stage, const struct animate_conf *conf, const struct scene_conf *scene, struct err *err);

#endif
