/* imf_read: OpenEXR files of any compression, by the C++ library: OpenEXRCore 3.1 does not decode DWAA and DWAB, in which
 * environment maps often come. */
#ifndef BRIDGE_IMF_READ_H
#define BRIDGE_IMF_READ_H
#ifdef __cplusplus
extern "C" {
#endif
#include "image/image.h"

/* Reads R, G, B of the first part's data window as float. image_free. Returns false, err set, when the file cannot be read or has
 * more than limit_px pixels. */
bool imf_read_rgb(struct image *out, const char *path, long limit_px, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
