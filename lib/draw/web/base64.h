/* base64: bytes as text (RFC 4648, section 4). */
#ifndef DRAW_WEB_BASE64_H
#define DRAW_WEB_BASE64_H
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

/* `head`, then the bytes in base 64, padded with "=". free(). */
char *base64_encode(const void *data, size_t size, const char *head);

/* The same as a JSON string, without a head. json_decref. */
json_t *base64_json(const void *data, size_t size);

#endif
