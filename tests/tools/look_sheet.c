/* Pictures of one eye by several programs beside each other, for the eye: look_sheet EYE.json SHEET.png, then for each row the label, render's own picture,
 * three.js' and Cycles' (.npy or .exr, linear RGBA; - where there is none). Columns: ours; three.js; how far it is off, eight times; Cycles; the same of it. Grey: no
 * picture. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/npy/npy.h"
#include "bridge/cv_draw.h"
#include "image/colour.h"
#include "image/exr.h"
#include "image/picture.h"

enum { COLUMNS = 5, HEAD = 28, GAP = 4, TIMES = 8 };

static bool load(struct image *out, const char *path, struct err *err)
{
	static const char *const rgba[] = { "R", "G", "B", "A" };
	const size_t n = strlen(path);
	struct npy a;
	*out = (struct image){ 0 };
	if (!strcmp(path, "-"))
		return true;
	if (n > 4 && !strcmp(path + n - 4, ".exr"))
		return exr_read(out, path, 4, rgba, 1L << 24, 0, err);
	if (!npy_read(&a, path, NPY_LIMIT, err) || !npy_expect(&a, path, 3, (long[]){ -1, -1, 4 }, err))
		return false;
	*out = image_new((int)a.shape[1], (int)a.shape[0], 4);
	memcpy(out->px, a.data, (size_t)npy_count(&a) * sizeof(float));
	npy_free(&a);
	return true;
}

static double coded(const struct image *m, int x, int y, int c, double gain)
{
	return fmin(srgb_from_linear((float)(gain * (double)image_at(m, x, y)[c])), 1);
}

/* One cell at (left, top): a, or how far b is off of it; black: the same. */
static void put(uint8_t *sheet, int width, int left, int top, const struct image *a, const struct image *b, double gain)
{
	for (int y = 0; y < a->height; y++)
		for (int x = 0; x < a->width; x++)
			for (int c = 0; c < 3; c++) {
				const double v = b ? TIMES * fabs(coded(a, x, y, c, gain) - coded(b, x, y, c, gain)) : coded(a, x, y, c, gain);
				sheet[3 * ((size_t)(top + y) * (size_t)width + (size_t)(left + x)) + (size_t)c] = (uint8_t)lrint(255 * fmin(v, 1));
			}
}

int main(int argc, char **argv)
{
	static const char *const heads[COLUMNS] = { "render's own", "three.js", "difference x 8", "Cycles", "difference x 8" };
	struct err err = { 0 };
	const int rows = (argc - 3) / 4;
	json_t *says = argc >= 7 && argc == 3 + 4 * rows ? json_read(argv[1], 1 << 20, &err) : 0;
	const double gain = json_number_value(json_object_get(json_object_get(says, "reference"), "exposure"));
	uint8_t *sheet = 0;
	int width = 0, height = 0, side = 0;
	for (int r = 0; says && r < rows && !err_is(&err); r++) {
		char **arg = argv + 3 + 4 * r;
		struct image m[3] = { 0 };
		bool ok = load(&m[0], arg[1], &err) && load(&m[1], arg[2], &err) && load(&m[2], arg[3], &err);
		if (ok && !sheet) {
			side = m[0].width;
			width = COLUMNS * (side + GAP) - GAP;
			height = rows * (side + HEAD);
			sheet = malloc(3 * (size_t)width * (size_t)height);
			memset(sheet, 90, 3 * (size_t)width * (size_t)height);
		}
		const int top = r * (side + HEAD) + HEAD;
		for (int k = 0; ok && k < 3; k++) {
			if (m[k].px && (m[k].width != side || m[k].height != side))
				ok = err_set(&err, "%s: another size than the first picture's", arg[1 + k]);
			else if (m[k].px)
				put(sheet, width, (k ? 2 * k - 1 : 0) * (side + GAP), top, &m[k], 0, gain);
			if (ok && k && m[k].px)
				put(sheet, width, 2 * k * (side + GAP), top, &m[0], &m[k], gain);
		}
		const struct cv_picture picture = { .px = sheet, .width = width, .height = height, .channels = 3 };
		for (int c = 0; ok && c < COLUMNS; c++) {
			char text[100];
			snprintf(text, sizeof text, c ? "%s" : "%s, %s", heads[c], arg[0]);
			cv_draw_text(&picture, c * (side + GAP) + 6, top - 8, 12, text, (const uint8_t[3]){ 255, 255, 255 });
		}
		for (int k = 0; k < 3; k++)
			image_free(&m[k]);
	}
	if (says && !err_is(&err))
		picture_png_write(argv[2], sheet, width, height, 3, &err);
	if (!says || err_is(&err))
		fprintf(stderr, "look_sheet: %s\n", err_is(&err) ? err.msg : "EYE.json SHEET.png LABEL OURS THREE CYCLES ...");
	json_decref(says);
	free(sheet);
	return !says || err_is(&err);
}
