#include "draw/web/packed.h"

#include <stdint.h>
#include <stdlib.h>

#include <zlib.h>

#include "base/mem.h"
#include "draw/web/base64.h"

/* Beyond it zlib takes twice the time for the last three hundredths. */
enum { LEVEL = 5 };

json_t *packed_json(const void *data, size_t size, size_t item, size_t back)
{
	const uint8_t *of = data;
	uLongf room = compressBound(size);
	uint8_t *flat = mem_array(size + 1, 1), *out = mem_array(room, 1), *to = flat;
	for (size_t k = 0; k < item; k++)
		for (size_t i = k; i < size; i += item)
			*to++ = (uint8_t)(of[i] - (i >= back ? of[i - back] : 0));
	compress2(out, &room, flat, size, LEVEL);  // cannot fail: room is the bound
	json_t *json = json_pack("{s:I,s:I,s:I,s:o}", "size", (json_int_t)size, "item", (json_int_t)item, "back", (json_int_t)back, "deflate", base64_json(out, room));
	free(flat);
	free(out);
	return json;
}
