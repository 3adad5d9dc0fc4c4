#include "kept.h"

#include <stdlib.h>

#include "base/mem.h"

enum { EYES = 2, MOST_PX = 20000, SOMEWHERE = 997 };

bool kept_next(struct drawn *drawn, FILE *file)
{
	int32_t size[3];
	float eye[EYES][7];
	*drawn = (struct drawn){ 0 };
	if (fread(size, sizeof size, 1, file) != 1 || size[0] < 1 || size[1] < 1 || size[0] > MOST_PX || size[1] > MOST_PX || size[2] < 0 || size[2] > EYES
	    || fread(eye, sizeof *eye, (size_t)size[2], file) != (size_t)size[2])
		return false;
	const size_t px = (size_t)size[0] * (size_t)size[1];
	*drawn = (struct drawn){ .width = size[0], .height = size[1], .n_eyes = size[2], .rgb = mem_array(px * 3, 1), .label = mem_array(px, 1), .aspect = 1 };
	for (int k = 0; k < size[2]; k++) {
		struct drawn_eye *e = &drawn->eye[k];
		for (int i = 0; i < 5; i++)
			e->limbus[i] = eye[k][i];
		e->shown = eye[k][5];
		e->theta = eye[k][6];
	}
	if (fread(drawn->rgb, 3, px, file) == px && fread(drawn->label, 1, px, file) == px)
		return true;
	drawn_free(drawn);
	return false;
}

FILE *kept_open(const char *path, uint64_t first)
{
	FILE *file = fopen(path, "rb");
	struct drawn d;
	if (!file) {
		fprintf(stderr, "cannot read %s\n", path);
		exit(2);
	}
	for (uint64_t i = 0; i < first % SOMEWHERE && kept_next(&d, file); i++)
		drawn_free(&d);
	return file;
}

bool kept_next_eye(struct drawn *drawn, const struct drawn_eye **eye, FILE *file, float shown)
{
	for (int again = 0; again < 2;) {
		if (!kept_next(drawn, file)) {
			rewind(file);
			again++;
			continue;
		}
		const struct drawn_eye *e = *eye = &drawn->eye[drawn->n_eyes > 1 && drawn->eye[1].shown > drawn->eye[0].shown];
		if (drawn->n_eyes && e->shown > shown && e->limbus[0] > 0 && e->limbus[0] < (float)drawn->width && e->limbus[1] > 0 && e->limbus[1] < (float)drawn->height)
			return true;
		drawn_free(drawn);
	}
	return false;
}
