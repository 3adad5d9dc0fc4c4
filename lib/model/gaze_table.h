/* gaze_table: the columns of gaze.csv, animation.csv and recorded gaze that hold a model's inputs and controls (model.h). */
#ifndef MODEL_GAZE_TABLE_H
#define MODEL_GAZE_TABLE_H
#include "base/csv.h"

/* The inputs of two eyes, in their order: "g1_deg" … "g10_px". */
extern const char *const gaze_columns[10];

/* Whether what stands in them can be: angles within half a turn, apertures and controls that a picture can have, strengths and
 * confidences near 0 to 1. A field may be empty, a column missing. Returns false, err set: path, line, column, number, range. */
bool gaze_table_check(const struct csv_table *table, const char *path, struct err *err);

#endif
