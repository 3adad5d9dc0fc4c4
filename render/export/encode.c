/* Maps as PNG: colours in sRGB, all else linear between two values that eye.json states. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/picture.h"
#include "render/export/export.h"

static bool is_colour(int map)
{
	return map == EXPORT_IRIS_ALBEDO || map == EXPORT_SCLERA_ALBEDO || map == EXPORT_CORNEA_COLOUR;
}

/* Lengths get their own range, normals -1..1, shares 0..1. */
static void range_of(double *low, double *high, const struct image *map, int which)
{
	bool length = which == EXPORT_IRIS_HEIGHT || which == EXPORT_IRIS_THICKNESS || which == EXPORT_CORNEA_DEPTH;
	*low = which == EXPORT_IRIS_NORMAL || which == EXPORT_SCLERA_NORMAL ? -1 : 0;
	*high = 1;
	if (!length)
		return;
	*low = *high = 0;
	for (long i = 0; i < (long)map->width * map->height; i++) {
		*low = fmin(*low, map->px[i]);
		*high = fmax(*high, map->px[i]);
	}
	*high = fmax(*high, *low + 1e-6);
}

static uint8_t byte_of(double x, double low, double high)
{
	return (uint8_t)lrint(255 * fmin(fmax((x - low) / (high - low), 0), 1));
}

static uint8_t *bytes_of(const struct image *map, double low, double high)
{
	size_t n = (size_t)map->width * (size_t)map->height * (size_t)map->channels;
	uint8_t *px = mem_array(n, 1);
	for (size_t i = 0; i < n; i++)
		px[i] = byte_of(map->px[i], low, high);
	return px;
}

static bool encode_map(struct export_work *w, int i, struct err *err)
{
	const struct image *map = &w->maps[i];
	range_of(&w->low[i], &w->high[i], map, i);
	uint8_t *px = is_colour(i) ? image_to_srgb8(map) : bytes_of(map, w->low[i], w->high[i]);
	bool ok = picture_png_encode(&w->png[i].data, &w->png[i].size, px, map->width, map->height, map->channels, err);
	free(px);
	return ok;
}

/* Three channels of a picture for glTF: of each a map, or none and a constant. Maps are of one size. */
static bool pack(struct export_png *out, const struct image *const map[3], const double scale[3], struct err *err)
{
	const struct image *any = map[0] ? map[0] : map[1];
	size_t n = (size_t)any->width * (size_t)any->height;
	uint8_t *px = mem_array(3 * n, 1);
	for (size_t i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			px[3 * i + (size_t)c] = byte_of(map[c] ? map[c]->px[i] : 1, 0, scale[c]);
	bool ok = picture_png_encode(&out->data, &out->size, px, any->width, any->height, 3, err);
	free(px);
	return ok;
}

static bool packed(struct export_work *w, struct err *err)
{
	const double rough[3] = { 1, 1, INFINITY }, volume[3] = { 1, w->high[EXPORT_CORNEA_DEPTH], INFINITY };
	const struct image *m = w->maps;
	return pack(&w->pictures[EXPORT_PIC_SCLERA_ROUGH], (const struct image *const[3]){ 0, &m[EXPORT_SCLERA_ROUGHNESS], 0 }, rough, err)
	       && pack(&w->pictures[EXPORT_PIC_CORNEA_ROUGH], (const struct image *const[3]){ 0, &m[EXPORT_CORNEA_ROUGHNESS], 0 }, rough, err)
	       && pack(&w->pictures[EXPORT_PIC_CORNEA_VOLUME], (const struct image *const[3]){ &m[EXPORT_CORNEA_CLEAR], &m[EXPORT_CORNEA_DEPTH], 0 }, volume, err);
}

bool export_encode(struct export_work *w, struct err *err)
{
	struct err late[EXPORT_MAPS] = { 0 };
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < EXPORT_MAPS; i++)
		encode_map(w, i, &late[i]);
	for (int i = 0; i < EXPORT_MAPS; i++)
		if (err_is(&late[i])) {
			*err = late[i];
			return false;
		}
	w->pictures[EXPORT_PIC_IRIS] = w->png[EXPORT_IRIS_ALBEDO];
	w->pictures[EXPORT_PIC_IRIS_NORMAL] = w->png[EXPORT_IRIS_NORMAL];
	w->pictures[EXPORT_PIC_SCLERA] = w->png[EXPORT_SCLERA_ALBEDO];
	w->pictures[EXPORT_PIC_CORNEA] = w->png[EXPORT_CORNEA_COLOUR];
	return packed(w, err);
}

void export_work_free(struct export_work *w)
{
	for (int i = EXPORT_PIC_SCLERA_ROUGH; i < EXPORT_PICTURES; i++)
		if (i != EXPORT_PIC_CORNEA)  // the others are those of png
			free(w->pictures[i].data);
	for (int i = 0; i < EXPORT_MAPS; i++) {
		image_free(&w->maps[i]);
		free(w->png[i].data);
	}
	for (int i = 0; i < EXPORT_PARTS; i++)
		export_part_free(&w->parts[i]);
	for (int i = 0; i < EXPORT_MARGIN_PARTS; i++)
		export_part_free(&w->margin[i]);
	for (int i = 0; i < EXPORT_VIEWS; i++)
		image_free(&w->reference[i]);
}
