#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/photo/impl.h"

void photo_space_take(struct photo_space *space, struct bytes icc)
{
	if (!icc.n || icc.n > PHOTO_ICC_MOST)
		return;
	free(space->icc);
	space->icc = mem_array(icc.n, 1);
	memcpy(space->icc, icc.p, icc.n);
	space->size = icc.n;
}

/* ICC.1, annex B.4: segments APP2 "ICC_PROFILE\0", number, count, each with a part of the profile, in any order. */
void photo_space_jpeg(struct photo_space *space, struct bytes file)
{
	enum { HEAD = 14, PARTS = 256 };
	struct bytes part[PARTS] = { 0 };
	int count = 0;
	size_t whole = 0;
	for (size_t at = 2; at + 4 <= file.n && file.p[at] == 0xff;) {
		int marker = file.p[at + 1];
		size_t length = bytes_be(file, at + 2, 2);
		if (marker == 0xff) {
			at++;
			continue;
		}
		if (marker == 0xda || marker == 0xd9 || length < 2 || length > file.n - at - 2)
			break;
		if (marker == 0xe2 && length >= 2 + HEAD && !memcmp(file.p + at + 4, "ICC_PROFILE", 12)) {
			int number = file.p[at + 4 + 12];
			count = file.p[at + 4 + 13];
			part[number] = (struct bytes){ file.p + at + 4 + HEAD, length - 2 - HEAD };
		}
		at += 2 + length;
	}
	for (int i = 1; i <= count; i++)
		whole += part[i].n;
	if (!whole || whole > PHOTO_ICC_MOST)
		return;
	free(space->icc);
	space->icc = mem_array(whole, 1);
	space->size = 0;
	for (int i = 1; i <= count; i++) {
		if (part[i].n)
			memcpy(space->icc + space->size, part[i].p, part[i].n);
		space->size += part[i].n;
	}
}
