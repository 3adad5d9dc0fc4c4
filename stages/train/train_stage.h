/* train_stage: trains the model from track's files and writes work/skin/model.json with its matrices, curves.svg and train.json, unless
 * they are up to date. */
#ifndef TRAIN_STAGE_H
#define TRAIN_STAGE_H
#include "base/stage.h"
#include "model/train/train.h"

/* expressions: expression.NAME of capture.conf. Returns false, err set, when the clip cannot be used. */
bool train_stage(struct stage *stage, const struct train_conf *conf, const struct opt_each_list *expressions,
                 struct err *err);

#endif
