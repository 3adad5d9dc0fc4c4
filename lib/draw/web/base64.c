#include "draw/web/base64.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

char *base64_encode(const void *bytes, size_t size, const char *head)
{
	const uint8_t *data = bytes;
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	char *out = mem_array(strlen(head) + (size + 2) / 3 * 4 + 1, 1), *at = out + strlen(head);
	strcpy(out, head);
	for (size_t i = 0; i < size; i += 3) {
		size_t n = size - i;
		unsigned v = (unsigned)data[i] << 16 | (n > 1 ? data[i + 1] : 0u) << 8 | (n > 2 ? data[i + 2] : 0u);
		*at++ = digits[v >> 18];
		*at++ = digits[v >> 12 & 63];
		*at++ = n > 1 ? digits[v >> 6 & 63] : '=';
		*at++ = n > 2 ? digits[v & 63] : '=';
	}
	*at = 0;
	return out;
}

json_t *base64_json(const void *data, size_t size)
{
	char *text = base64_encode(data, size, "");
	json_t *out = json_string(text);
	free(text);
	return out;
}
