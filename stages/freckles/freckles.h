/* freckles: the stage's files: the texture of one eye in, its freckles and clean texture out. The algorithm is in
 * lib/iris/freckle. */
#ifndef STAGES_FRECKLES_H
#define STAGES_FRECKLES_H
#include "anatomy/capture.h"
#include "iris/freckle/freckle.h"

/* Makes freckles.exr, freckles.json and clean.exr of one eye, unless they are up to date. False, err set, when a file cannot be
 * read or written. */
bool freckles_eye(struct stage *stage, const struct capture_eye *which, const struct eye *eye,
                  const struct freckle_conf *conf, struct err *err);

#endif
