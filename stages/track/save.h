/* save: the files of work/skin/ that hold what was measured in a clip (lib/README.md lists their columns and shapes). */
#ifndef STAGES_TRACK_SAVE_H
#define STAGES_TRACK_SAVE_H
#include "track/clip/points.h"
#include "track/clip/result.h"

/* Files of the stage, relative to the capture. */
enum { TRACK_FILES = 10 };
extern const char *const track_files[TRACK_FILES];

/* Writes all of track_files but the contact sheet, which must be there, and marks them all made from the n inputs `in`.
 * Returns false, err set, when one cannot be written. */
bool track_save(struct stage *stage, const struct track_result *result, const struct track_clip *clip,
                const struct track_points *points, int n, const char *const in[], struct err *err);

#endif
