#include "draw/web/picture.h"

#include <stdlib.h>

#include "draw/web/base64.h"
#include "image/picture.h"

enum { JPEG_QUALITY = 86 };

json_t *web_picture(const uint8_t *px, int width, int height)
{
	struct err err = { 0 };
	uint8_t *data;
	size_t size;
	if (!picture_jpeg_encode(&data, &size, px, width, height, 3, JPEG_QUALITY, &err))
		return 0;
	char *uri = base64_encode(data, size, "data:image/jpeg;base64,");
	json_t *picture = json_pack("{s:s,s:i,s:i}", "uri", uri, "width", width, "height", height);
	free(uri);
	free(data);
	return picture;
}
