#include "image/photo/webp.h"

#include <string.h>

#include "image/webp.h"

/* The chunk of that name; n = 0 where there is none. False where a chunk ends behind the file. */
static bool find_chunk(struct bytes *chunk, struct bytes file, const char name[4])
{
	*chunk = (struct bytes){ file.p, 0 };
	size_t end = (size_t)bytes_le(file, 4, 4) + 8;
	if (end > file.n)
		return false;
	for (size_t at = 12; at + 8 <= end;) {
		size_t length = bytes_le(file, at + 4, 4);
		if (length > end - at - 8)
			return false;
		if (!memcmp(file.p + at, name, 4) && !chunk->n)
			*chunk = (struct bytes){ file.p + at + 8, length };
		at += 8 + length + (length & 1);
	}
	return true;
}

bool photo_parse_webp(struct photo *photo, struct bytes file, struct err *err)
{
	struct bytes exif;
	struct webp_head head;
	if (webp_missing())
		return err_set(err, "is WebP, which cannot be read here: %s (Debian's package: libwebp7)", webp_missing());
	if (!find_chunk(&exif, file, "EXIF"))
		return err_set(err, "is truncated: a chunk of the WebP ends behind the file; copy it again");
	if (!webp_head(&head, file.p, file.n))
		return err_set(err, "is damaged: no WebP picture in it");
	if (head.moves)
		return err_set(err, "is an animation: photographs go into photos/, videos into video/");
	photo->width = head.width;
	photo->height = head.height;
	photo->bits = 8;
	// Some programs put the six bytes of a JPEG's segment before the block.
	bool jpeg = exif.n > 6 && !memcmp(exif.p, "Exif\0", 6);
	photo_exif_block(photo, jpeg ? bytes_from(exif, 6) : exif);
	return true;
}

bool photo_decode_webp(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err)
{
	const struct webp_head head = { .width = photo->width, .height = photo->height };
	size_t n = (size_t)photo->width * (size_t)photo->height * 3;
	bool ok = webp_decode(photo_narrow(rgb, n), 3, &head, file.p, file.n);
	if (ok)
		photo_widen_in_place(rgb, n);
	struct bytes icc;
	if (ok && find_chunk(&icc, file, "ICCP"))
		photo_space_take(space, icc);
	return ok || err_set(err, "is damaged (WebP): copy it again");
}
