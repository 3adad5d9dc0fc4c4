/* packed: numbers of a mesh as few bytes, for the page: what each byte differs by from that of an item before it, the first bytes of all items
 * together, then the second ones and so on, deflated (RFC 1950). Neighbours' high bytes are alike, so that they all but vanish.
 * Graphics.unpacked() (render/viewer/gl.js) decodes it.
 */
#ifndef DRAW_WEB_PACKED_H
#define DRAW_WEB_PACKED_H
#include <stddef.h>

#include <jansson.h>

/* {size, item, back, deflate} of size bytes.
 * item  bytes of an item, of which size is a multiple
 * back  bytes to the one each item is compared with: a multiple of item; the first ones stand as they are
 * json_decref. */
json_t *packed_json(const void *data, size_t size, size_t item, size_t back);

#endif
