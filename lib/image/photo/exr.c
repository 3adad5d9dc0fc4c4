#include <string.h>

#include "image/photo/impl.h"

enum { FLAG_DEEP = 0x800, FLAG_PARTS = 0x1000 };

/* The text at `at` with its zero byte; 0 when there is none within 256 bytes. */
static size_t text_length(struct bytes file, size_t at)
{
	size_t room = at < file.n ? file.n - at : 0;
	const uint8_t *zero = room ? memchr(file.p + at, 0, room < 256 ? room : 256) : 0;
	return zero ? (size_t)(zero - file.p) - at + 1 : 0;
}

static bool has_channel(struct bytes list, const char *name)
{
	for (size_t at = 0, n; (n = text_length(list, at)) > 1; at += n + 16)
		if (!strcmp((const char *)list.p + at, name))
			return true;
	return false;
}

static bool take_attribute(struct photo *photo, const char *name, struct bytes value, struct err *err)
{
	if (!strcmp(name, "dataWindow") && value.n == 16) {
		int64_t box[4];
		for (size_t i = 0; i < 4; i++)
			box[i] = (int32_t)bytes_le(value, 4 * i, 4);
		int64_t w = box[2] - box[0] + 1, h = box[3] - box[1] + 1;
		if (w < 1 || h < 1 || w > 1 << 30 || h > 1 << 30)
			return err_set(err, "EXR data window of %lld x %lld px: no photograph", (long long)w, (long long)h);
		photo->width = (int)w;
		photo->height = (int)h;
	}
	if (!strcmp(name, "channels")) {
		bool rgb = has_channel(value, "R") && has_channel(value, "G") && has_channel(value, "B");
		photo->grey = !rgb && has_channel(value, "Y");
		if (!rgb && !photo->grey)
			return err_set(err, "EXR without channels R, G, B or Y: no photograph");
		photo->bits = 16;
	}
	return true;
}

/* OpenEXR file layout: magic, version and flags, then attributes {name, type, size, value} up to an empty name. */
bool photo_parse_exr(struct photo *photo, struct bytes file, struct err *err)
{
	if (bytes_le(file, 4, 4) & (FLAG_DEEP | FLAG_PARTS))
		return err_set(err, "is a deep or multi-part EXR: save it as a flat one");
	size_t at = 8, name, type;
	while ((name = text_length(file, at)) > 1) {
		type = text_length(file, at + name);
		size_t size = bytes_le(file, at + name + type, 4), value = at + name + type + 4;
		if (!type || value > file.n || size > file.n - value)
			break;
		if (!take_attribute(photo, (const char *)file.p + at, (struct bytes){ file.p + value, size }, err))
			return false;
		at = value + size;
	}
	if (name != 1 || !photo->width || !photo->bits)
		return err_set(err, "is truncated: the EXR's header does not end; copy it again");
	return true;
}
