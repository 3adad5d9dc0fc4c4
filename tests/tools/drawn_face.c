/* drawn_face OUT.png SEED NUMBER: a drawn face of the training split that shows both eyes (tests/lib/unseen/faces.h). Standard output: a line
 * for each eye, "left" or "right", x, y and semi-axis of its limbus in px. */
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/picture.h"
#include "tests/lib/unseen/faces.h"

int main(int argc, char **argv)
{
	if (argc != 4) {
		fprintf(stderr, "usage: drawn_face OUT.png SEED NUMBER\n");
		return 2;
	}
	struct unseen u = faces_make(strtoull(argv[2], 0, 10), atoi(argv[3]), true, false);
	const size_t n = 3 * (size_t)u.photo.width * (size_t)u.photo.height;
	uint8_t *px = mem_array(n, 1);
	struct err err = { 0 };
	for (size_t i = 0; i < n; i++)
		px[i] = (uint8_t)(u.photo.rgb[i] >> 8);
	const bool ok = picture_png_write(argv[1], px, u.photo.width, u.photo.height, 3, &err);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	for (int s = 0; s < 2; s++)
		printf("%s %.2f %.2f %.2f\n", s == FACES_LEFT ? "left" : "right", u.eye[s].limbus.cx, u.eye[s].limbus.cy, u.eye[s].limbus.a);
	free(px);
	unseen_free(&u);
	return !ok;
}
