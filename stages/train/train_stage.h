/* train_stage: from track's files to work/skin/model.json and its matrices, curves.svg, train.json. */
#ifndef TRAIN_STAGE_H
#define TRAIN_STAGE_H
#include "base/stage.h"
#include "model/train/train.h"

bool train_stage(struct stage *stage, const struct train_conf *conf, const struct opt_each_list *expressions,
                 struct err *err);

#endif
