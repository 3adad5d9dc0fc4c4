/* wrinkle_sheet: wrinkle lines for people to look at. */
#ifndef STAGES_TRACK_WRINKLE_SHEET_H
#define STAGES_TRACK_WRINKLE_SHEET_H
#include "track/wrinkle/wrinkle.h"

/* Writes a PNG with a row for each of n expressions: its neutral frame, its peak with the lines drawn, and its bump map lit
 * from the upper left. */
bool wrinkle_sheet(const char *path, const struct wrinkles *w, const struct wrinkle_ground *ground, int n,
                   const struct wrinkle_frame neutral[], const struct wrinkle_frame peak[], struct err *err);

#endif
