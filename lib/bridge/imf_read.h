/* imf_read: OpenEXR files of any compression, through the C++ library: OpenEXRCore 3.1 does not decode DWAA and DWAB,
 * which strangers' environment maps often are. */
#ifndef BRIDGE_IMF_READ_H
#define BRIDGE_IMF_READ_H
#ifdef __cplusplus
extern "C" {
#endif
#include "image/image.h"

/* R, G, B of the first part's data window, as float. More than limit_px pixels are refused before they are read.
 * image_free. */
bool imf_read_rgb(struct image *out, const char *path, long limit_px, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
