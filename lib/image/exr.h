/* exr: half or float maps in and out, through OpenEXRCore. Written beside and renamed. */
#ifndef IMAGE_EXR_H
#define IMAGE_EXR_H
#include "image/image.h"

/* What an EXR file of ours carries beside its pixels. */
struct exr_info {
	double extent_mm;     // half-width of an iris map; attribute extentMm; 0 = none
	const char *made_by;  // JSON text, attribute madeBy; null = none
};

enum exr_type { EXR_HALF, EXR_FLOAT };

/* channels: one name for each channel of the image, in its order, e.g. { "R", "G", "B" }, { "Y" }.
 * Scan lines, losslessly compressed: PIZ for half, ZIP for float; "Z" is float in either. The bytes do not depend on the threads. */
bool exr_write(const char *path, const struct image *image, const char *const channels[], enum exr_type type,
               const struct exr_info *info, struct err *err);

/* Reads the named channels, in that order, as float; a channel that the file lacks is an error naming it.
 * limit_px: more pixels than that are refused before they are read. info may be null; info->made_by is not read. */
bool exr_read(struct image *image, const char *path, int n, const char *const channels[], long limit_px,
              struct exr_info *info, struct err *err);

/* The names of the file's channels, comma-separated; free(). */
bool exr_channels(char **names, const char *path, struct err *err);

#endif
