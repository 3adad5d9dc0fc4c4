/* wrinkles: the files that wrinkle lines of expressions are written to. */
#ifndef STAGES_TRACK_WRINKLES_H
#define STAGES_TRACK_WRINKLES_H
#include "track/clip/folds.h"

enum { WRINKLE_FILES = 3 };
extern const char *const wrinkle_files[WRINKLE_FILES];  // relative to the capture; made where wrinkles_wanted

/* There are expressions, and a mesh to find their skin on. */
bool wrinkles_wanted(const struct track_conf *conf, bool has_mesh);

/* Finds the lines in result->folds and writes their files; where there are none to find, says why and removes the files.
 * in: the n inputs for stage_made. Returns false, err set, when a file cannot be written. */
bool wrinkles_finish(struct stage *stage, const struct track_result *result, const struct track_clip *clip,
                     const struct track_subject *subject, const struct track_points *points, const struct track_conf *conf, int n,
                     const char *const in[], struct err *err);

#endif
