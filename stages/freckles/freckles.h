/* One eye's freckles. */
#ifndef STAGES_FRECKLES_H
#define STAGES_FRECKLES_H
#include "anatomy/capture.h"
#include "iris/freckle/freckle.h"

bool freckles_eye(struct stage *stage, const struct capture_eye *which, const struct eye *eye,
                  const struct freckle_conf *conf, struct err *err);

#endif
