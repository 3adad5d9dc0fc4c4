/* exr: maps of half or float values as OpenEXR files, through OpenEXRCore. */
#ifndef IMAGE_EXR_H
#define IMAGE_EXR_H
#include "image/image.h"

/* What an EXR file of ours carries beside its pixels. */
struct exr_info {
	double extent_mm;     // half-width of an iris map; attribute extentMm; 0 = none
	const char *made_by;  // JSON text, attribute madeBy; null = none
};

enum exr_type { EXR_HALF, EXR_FLOAT };

/* Writes an image beside `path`, then renames it.
 * channels  one name for each channel of the image, in its order, e.g. { "R", "G", "B" }, { "Y" }
 * type      of all channels but "Z", which is always float
 * info      may be null
 * Scan lines, losslessly compressed: PIZ for half, ZIP for float. The bytes do not depend on the number of threads.
 * False, err set, when the file cannot be written. */
bool exr_write(const char *path, const struct image *image, const char *const channels[], enum exr_type type,
               const struct exr_info *info, struct err *err);

/* Reads n named channels of a flat scan-line file, in the order asked for, as float.
 * image     overwritten; image_free; empty on failure
 * limit_px  a file of more pixels is refused before they are read
 * info      may be null; extent_mm is filled, made_by is not read
 * False, err set ("path: rule"), for a channel that the file lacks, a size beyond the limit, tiles, depth, damage. */
bool exr_read(struct image *image, const char *path, int n, const char *const channels[], long limit_px,
              struct exr_info *info, struct err *err);

#endif
