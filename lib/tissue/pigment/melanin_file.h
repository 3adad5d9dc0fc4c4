/* melanin_file: the map of melanin in pigment.json. */
#ifndef TISSUE_PIGMENT_MELANIN_FILE_H
#define TISSUE_PIGMENT_MELANIN_FILE_H
#include <jansson.h>

#include "tissue/pigment/melanin.h"

/* {extent_mm, n, ln, sigma, rings: [{share, ln, sigma}]}. json_decref. */
json_t *melanin_json(const struct melanin_map *map, const struct pigment_fit *fit);

/* Reads that from IRIS/pigment.json; map->n is 0 where the file has none. Returns false, err set, when it is damaged. */
bool melanin_load(struct melanin_map *map, const char *path, struct err *err);

#endif
